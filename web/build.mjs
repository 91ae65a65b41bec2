// Makes the page of reports: node build.mjs OUTPUT NOTICES. Style and program go into template.html, so that the page is one
// file that needs no network; its policy names the program's hash, so that nothing else can run in it. The licences of what
// is in the program stand in the page and in the file NOTICES.
import { createHash } from "node:crypto";
import { mkdirSync, readdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { fileURLToPath } from "node:url";

const here = (name) => fileURLToPath(new URL(name, import.meta.url));
const esbuild = await import("esbuild").catch(() => {
  console.error("web/node_modules: expected the packages of package-lock.json, got none; tools/setup.sh installs them");
  process.exit(1);
});

async function bundled(entry) {
  const result = await esbuild.build({
    entryPoints: [here(entry)],
    bundle: true,
    minify: true,
    write: false,
    format: "iife",
    target: "es2020",
    charset: "utf8",
    legalComments: "none",
    logLevel: "warning",
    metafile: true,
    absWorkingDir: here("."),
  });
  return { text: result.outputFiles[0].text.trim(), inputs: Object.keys(result.metafile.inputs) };
}

const manifest = (name) => JSON.parse(readFileSync(here(`node_modules/${name}/package.json`), "utf8"));

/** The licence of a package of node_modules, as it came. */
function licence(name) {
  const file = readdirSync(here(`node_modules/${name}`)).find((one) => /^licen[cs]e/i.test(one));
  if (!file) throw new Error(`node_modules/${name}: expected a file with its licence, got none`);
  const { version, license } = manifest(name);
  return { title: `${name} ${version} (${license})`, text: readFileSync(here(`node_modules/${name}/${file}`), "utf8").trim() };
}

/** Packages and all they depend on: what they need may come inside of them. */
function withDependencies(names) {
  const all = new Set();
  const add = (name) => {
    if (all.has(name)) return;
    all.add(name);
    Object.keys(manifest(name).dependencies ?? {}).forEach(add);
  };
  names.forEach(add);
  return [...all].sort();
}

/** Packages with the same licence text share it. */
function notices(inputs) {
  const names = inputs.map((one) => one.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1]).filter(Boolean);
  const titles = new Map();
  for (const { title, text } of withDependencies(names).map(licence)) titles.set(text, [...(titles.get(text) ?? []), title]);
  return [...titles].map(([text, of]) => `${of.join("\n")}\n\n${text}\n`).join(`\n${"-".repeat(60)}\n\n`);
}

const [style, bundle] = await Promise.all([bundled("src/style.css"), bundled("src/main.ts")]);
const program = bundle.text.replaceAll("</script", "<\\/script");
const licences = notices(bundle.inputs);
const places = {
  PARACAL_REPORT_STYLE: style.text,
  PARACAL_REPORT_NOTICES: licences.replaceAll("&", "&amp;").replaceAll("<", "&lt;"),
  PARACAL_REPORT_PROGRAM: program,
  PARACAL_REPORT_HASH: `'sha256-${createHash("sha256").update(program).digest("base64")}'`,
};
let page = readFileSync(here("src/template.html"), "utf8");
for (const [place, text] of Object.entries(places)) page = page.replace(place, () => text);

const [output, noticesFile] = process.argv.slice(2);
mkdirSync(dirname(output), { recursive: true });
writeFileSync(output, page);
writeFileSync(noticesFile, licences);
