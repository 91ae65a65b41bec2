// Makes the page of reports: node build.mjs OUTPUT. Style and program go into template.html, so that the page is one file
// that needs no network; its policy names the program's hash, so that nothing else can run in it.
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
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
  });
  return result.outputFiles[0].text.trim();
}

const [style, bundle] = await Promise.all([bundled("src/style.css"), bundled("src/main.ts")]);
const program = bundle.replaceAll("</script", "<\\/script");
const places = {
  PARACAL_REPORT_STYLE: style,
  PARACAL_REPORT_PROGRAM: program,
  PARACAL_REPORT_HASH: `'sha256-${createHash("sha256").update(program).digest("base64")}'`,
};
let page = readFileSync(here("src/template.html"), "utf8");
for (const [place, text] of Object.entries(places)) page = page.replace(place, () => text);

const output = process.argv[2];
mkdirSync(dirname(output), { recursive: true });
writeFileSync(output, page);
