// Prepares the input of doxygen in build/site.in: documents and headers with unchanged line numbers, so that its warnings refer to them.
import { copyFileSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { basename, dirname, extname, join, posix } from "node:path";
import { fileURLToPath } from "node:url";
import { deadLinks, headings, isCode } from "../../tests/documents/markdown.mjs";
import { equation, katexFolder } from "./equation.mjs";

const root = fileURLToPath(new URL("../..", import.meta.url));
const work = join(root, "build/site.in");
const read = (path) => readFileSync(join(root, path), "utf8");
function lay(path, content) {
  mkdirSync(dirname(join(work, path)), { recursive: true });
  writeFileSync(join(work, path), content);
}
function refuse(faults) {
  if (faults.length === 0) return;
  console.error(faults.join("\n"));
  process.exit(1);
}

// The pages of each group of readers, in order, with their names. A folder becomes one page with its programs.
const guides = {
  "": { "Start": "README.md", "Samples": "samples/README.md" },
  "Designer": { "Tolerances": "docs/tolerance.md", "Tolerance reference": "docs/tolerance-reference.md", "Batches": "docs/scale.md" },
  "Metrologist": {
    "Calibration": "docs/calibration.md", "Calibration reference": "docs/calibration-reference.md", "Judgement": "docs/judgement.md",
    "Reports": "docs/report.md",
  },
  "Controls engineer": {
    "Controllers": "docs/controllers.md", "Controller code": "docs/controllers-reference.md", "Part programs": "docs/part-programs.md",
    "Codes of part programs": "docs/part-programs-reference.md", "Hexapods": "docs/hexapods.md",
  },
  "Printer owner": { "Printers": "docs/printers.md", "Printer tests": "docs/printers-reference.md", "Live page": "docs/live-page.md" },
  "Researcher": {
    "The library": "docs/library.md", "Examples": "examples", "Python": "docs/python.md", "Examples in Python": "python/examples",
    "Evidence": "docs/evidence.md", "Slips of the paper": "docs/paper-slips.md", "Data: the paper": "data/huang2016/README.md",
    "Data: hexapods": "data/hexapod/README.md", "Data: robots": "data/robots/README.md", "Data: printers": "data/klipper-delta/README.md",
    "Data: regressions": "data/nist-strd/README.md",
  },
  "Reference": { "Conventions": "docs/conventions.md", "Input files": "docs/files.md", "JSON keys": "docs/json-keys.md", "References": "docs/references.md" },
  "Project": { "Changelog": "CHANGELOG.md", "Design": "docs/design.md", "Dependencies": "docs/dependencies.md", "Contributing": "CONTRIBUTING.md" },
};
const names = new Map(Object.values(guides).flatMap((group) => Object.entries(group).map(([name, path]) => [path, name])));
const idOf = (path) => (path === "README.md" ? "index" : path.replace(/(\/README)?\.md$/, "").replaceAll("/", "-").toLowerCase());

// Headers, except those for user-defined scalars, and their modules.
const headers = readdirSync(join(root, "include/paracal"), { recursive: true }).filter((path) => path.endsWith(".hpp") && !path.endsWith("_impl.hpp")).sort();
const roomOf = (header) => (header.includes("/") ? dirname(header) : "general");
const groupOf = (header) => `${roomOf(header)}-${basename(header, ".hpp")}`;
const pageOf = (group) => `group__${group.replaceAll("_", "__")}.html`;
const rooms = new Map([...read("docs/design.md").matchAll(/^\| `(\w+)\/` \| (.*) \|[^|]*\|$/gm)].map(([, room, holds]) => [room, holds]));
for (const room of rooms.keys()) if (!headers.some((header) => roomOf(header) === room)) rooms.delete(room);
rooms.set("general", "shared by all modules: errors, words, units, the version, and the header that includes the whole library");

// TEXT with what is not in backticks changed; doxygen takes an apostrophe for the end of one backtick, not of two.
const outsideOfCode = (text, change = (part) => part) => text.split(/(`[^`]+`)/).map((part, k) => (k % 2 ? `\`${part}\`` : change(part))).join("");

const keys = new Set([...read("docs/references.md").matchAll(/^\*\*\[([\w-]+)\]\*\*/gm)].map(([, key]) => key));
const cited = (text) => text.replace(/\[([\w-]+)(?=[,\]](?!\())/g, (all, key) => (keys.has(key) ? `[<a href="docs-references.html#${key}">${key}</a>` : all));

const resolved = (target, from) => posix.normalize(posix.join(posix.dirname(from), target)).replace(/\/$/, "");

// Where a link of a document leads in the site. What is no page is copied, as text unless browsers show it.
function address(target, from) {
  if (/^[a-z]+:/.test(target)) return target;
  const [path, anchor] = target.split("#");
  const to = path ? resolved(path, from) : from, header = to.replace(/^include\/paracal\//, "");
  if (names.has(to)) return `${idOf(to)}.html${anchor ? `#${idOf(to)}-${anchor}` : ""}`;
  if (headers.includes(header)) return pageOf(groupOf(header));
  const shown = `files/${to}${/\.(svg|png|jpg|txt)$/.test(to) ? "" : ".txt"}`;
  mkdirSync(dirname(join(work, "html", shown)), { recursive: true });
  copyFileSync(join(root, to), join(work, "html", shown));
  return shown;
}

function documentPage(path) {
  const text = read(path), id = idOf(path), code = isCode(text);
  const labels = new Map(headings(text).map(({ line, slug }, k) => [line - 1, k ? `${id}-${slug}` : id.replace(/^index$/, "mainpage")]));
  const link = (_, words, target) => {
    const page = /^[\w/-]+\.md$/.test(words) && names.get(resolved(target.split("#")[0], path));  // a file's name: that of its page
    return `<a href="${address(target, path)}">${page || words}</a>`;
  };
  const prose = (part) =>
    outsideOfCode(cited(part))
      .replace(/!\[([^\]]*)\]\(([^)]*)\)/g, (_, alt, target) => `<img src="${address(target, path)}" alt="${alt}"/>`)
      .replace(/\[((?:[^\][]|\[[^\]]*\])+)\]\(([^)\s]*)\)/g, link)
      .replace(/<(https?:[^>]*)>/g, '<a href="$1">$1</a>')
      .replace(/^\*\*\[<a [^>]*>(.*?)<\/a>\]\*\*/gm, '<a id="$1"></a><b>$1</b>');
  const parts = [];  // lines of code and of prose, by turns
  text.split("\n").forEach((line, k) => {
    if (k === 0 || code[k] !== code[k - 1]) parts.push({ isCode: code[k], lines: [] });
    parts.at(-1).lines.push(labels.has(k) ? `${line} {#${labels.get(k)}}` : line);
  });
  return parts.map(({ isCode, lines }) => (isCode ? lines.join("\n") : prose(lines.join("\n")))).join("\n");
}

function programsPage(folder) {
  const files = readdirSync(join(root, folder)).filter((file) => /\.(cpp|py)$/.test(file));
  const programs = files.map((file) => `## ${file} {#${idOf(folder)}-${file.replace(/\W/g, "-")}}\n\n~~~{${extname(file)}}\n${read(`${folder}/${file}`)}~~~`);
  return [`# ${names.get(folder)} {#${idOf(folder)}}`, "The tests run these programs as printed.", ...programs].join("\n\n");
}

// The types and functions of a header, by name.
function heldBy(text) {
  const outer = text.replace(/^namespace \w*detail \{[^]*?^\}/gm, "");
  const type = /(?:struct|class|enum class) (?:\[\[nodiscard\]\] )?(\w+)(?=[^;]*\{)/, call = /(?!namespace|using|template|static_assert)\w[\w:<>,&* ]*? [*&]?(\w+\()/;
  return new Set([...outer.matchAll(new RegExp(`^(?:${type.source}|${call.source})`, "gm"))].map(([, ofType, ofCall]) => ofType ?? `${ofCall})`));
}

// Comments as doxygen's Markdown wants them. All that stands in the namespaces of a header is on one page, in its order.
function headerPage(header) {
  const group = groupOf(header), text = read(`include/paracal/${header}`);
  const withEquations = text.replace(/\\f\[(.*?)\\f\]/gs, (all, said, at) => {
    try {
      return `@htmlonly[block] ${equation(said.replace(/\n *\/\/\//g, "\n"))} @endhtmlonly${"\n///".repeat(all.split("\n").length - 1)}`;
    } catch (error) {
      return refuse([`include/paracal/${header}:${text.slice(0, at).split("\n").length}: ${error.message}`]);
    }
  });
  const prose = (part) => cited(part.replace(/<(?=[\w/])/g, "&lt;").replace(/\\(?=\w)/g, "\\\\"));
  let before = "", wasComment = false;
  const lines = withEquations.split("\n").map((line) => {
    const [, start, said = ""] = line.match(/^(.*?\/\/\/<?)(.*)$/) ?? [];
    const isApart = before.trim() === "" && /^ {3,}\S/.test(said);  // a table, an equation that is not set
    const begins = start && (!wasComment || /\S *\/\/\/<$/.test(start));
    before = isApart ? "" : said;
    wasComment = Boolean(start);
    if (said.includes("@htmlonly")) return line;
    const brief = begins && !/^ *@/.test(said) ? " @brief" : "";  // all of the first paragraph
    if (start) return start + brief + (isApart ? `    ${said}` : outsideOfCode(said, prose));
    return line.replace(/^namespace paracal[\w:]* \{$/, `$& /** @addtogroup ${group} */ /**@{*/`).replace(/^\}  \/\/ namespace paracal/, "/**@}*/ $&");
  });
  const about = `@defgroup ${group} ${header}\n@ingroup ${roomOf(header)}\n@brief ${[...heldBy(text)].join(", ")} `;
  return lines.join("\n").replace("#pragma once", `/** ${about}*/`);
}

function navigation() {
  const reference = Object.fromEntries([...rooms.keys()].map((room) => [room, pageOf(room)]));
  const lists = Object.entries({ ...guides, "C++": { ...reference, "All types": "annotated.html" } }).map(([reader, pages]) => {
    const items = Object.entries(pages).map(([name, path]) => `<li><a href="${path.endsWith(".html") ? path : `${idOf(path)}.html`}">${name}</a></li>`);
    return `${reader && `<h2>${reader}</h2>`}<ul>${items.join("")}</ul>`;
  });
  return lists.join("\n");
}

const documents = [...names.keys()].filter((path) => path.endsWith(".md"));
refuse(deadLinks(root, documents));
refuse(readdirSync(join(root, "docs")).filter((file) => file.endsWith(".md") && !names.has(`docs/${file}`)).map((file) => `docs/${file}: expected an entry in the guides of docs/site/prepare.mjs, got none`));

rmSync(work, { recursive: true, force: true });
for (const path of names.keys()) lay(`pages/${path.replace(/(\.md)?$/, ".md")}`, documents.includes(path) ? documentPage(path) : programsPage(path));
for (const header of headers) lay(`include/paracal/${header}`, headerPage(header));
lay("pages/rooms.dox", [...rooms].map(([room, holds]) => `/** @defgroup ${room} ${room}\n${outsideOfCode(holds[0].toUpperCase() + holds.slice(1))} */`).join("\n"));
const [, version] = read("CMakeLists.txt").match(/project\(paracal VERSION ([\d.]+)/);
lay("header.html", read("docs/site/header.html").replace("VERSION", version).replace("NAVIGATION", navigation()));
for (const file of ["Doxyfile", "layout.xml", "footer.html", "style.css"]) lay(file, read(`docs/site/${file}`));
lay("html/search.js", read("docs/site/search.js"));
const fonts = readdirSync(join(katexFolder, "fonts")).filter((file) => file.endsWith(".woff2")).map((file) => `fonts/${file}`);
for (const file of ["katex.min.css", ...fonts]) lay(`html/katex/${file}`, readFileSync(join(katexFolder, file)));
