// What the pages of web/ are made with: bundles of TypeScript and CSS, the licences of what is in them, and a template with places.
import { createHash } from "node:crypto";
import { readdirSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const here = (name) => fileURLToPath(new URL(name, import.meta.url));
const esbuild = await import("esbuild").catch(() => {
  console.error("web/node_modules: expected the packages of package-lock.json, got none; tools/setup.sh installs them");
  process.exit(1);
});

export async function bundled(entry) {
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
export function notices(inputs) {
  const names = inputs.map((one) => one.match(/^node_modules\/((?:@[^/]+\/)?[^/]+)/)?.[1]).filter(Boolean);
  const titles = new Map();
  for (const { title, text } of withDependencies(names).map(licence)) titles.set(text, [...(titles.get(text) ?? []), title]);
  return [...titles].map(([text, of]) => `${of.join("\n")}\n\n${text}\n`).join(`\n${"-".repeat(60)}\n\n`);
}

/// As the policy of a page names a program that may run in it.
export const hashOf = (program) => `'sha256-${createHash("sha256").update(program).digest("base64")}'`;

export const withinScript = (program) => program.replaceAll("</script", "<\\/script");
export const withinHtml = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");

/// The template with each place filled once.
export function filled(template, places) {
  let page = readFileSync(here(template), "utf8");
  for (const [place, text] of Object.entries(places)) page = page.replace(place, () => text);
  return page;
}
