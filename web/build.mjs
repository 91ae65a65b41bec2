// Makes the page of reports: node build.mjs OUTPUT NOTICES. Style and program go into template.html, so that the page is one
// file that needs no network; its policy names the program's hash, so that nothing else can run in it. The licences of what
// is in the program stand in the page and in the file NOTICES.
import { mkdirSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { bundled, filled, hashOf, notices, withinHtml, withinScript } from "./bundle.mjs";

const [style, bundle] = await Promise.all([bundled("src/style.css"), bundled("src/main.ts")]);
const program = withinScript(bundle.text);
const licences = notices(bundle.inputs);
const page = filled("src/template.html", {
  PARACAL_REPORT_STYLE: style.text,
  PARACAL_REPORT_NOTICES: withinHtml(licences),
  PARACAL_REPORT_PROGRAM: program,
  PARACAL_REPORT_HASH: hashOf(program),
});

const [output, noticesFile] = process.argv.slice(2);
mkdirSync(dirname(output), { recursive: true });
writeFileSync(output, page);
writeFileSync(noticesFile, licences);
