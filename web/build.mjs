// Makes the page of reports: node build.mjs FOLDER writes report.html. Style and program go into template.html, so that the page is one
// file that needs no network; its policy names the program's hash, so that nothing else can run in it. The licences of what
// is in the program stand in the page and in licences_of_the_page.txt. The same sources and package-lock.json make the same bytes.
import { mkdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
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

const folder = process.argv[2];
mkdirSync(folder, { recursive: true });
writeFileSync(join(folder, "report.html"), page);
writeFileSync(join(folder, "licences_of_the_page.txt"), licences);
