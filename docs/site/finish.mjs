// Copies the pages that doxygen has written to build/site: those that the first page links to, directly or not. A dead link is an error.
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const made = fileURLToPath(new URL("../../build/site.in/html", import.meta.url));
const site = fileURLToPath(new URL("../../build/site", import.meta.url));

// Removes links to what layout.xml omits, puts the anchors of fields into the lists that explain them, and marks the current page in the navigation.
function finished(page, html) {
  const room = html.match(/<div class="ingroups"><a class="el" href="([^"]*)"/)?.[1];
  const ids = new Set([...html.matchAll(/ id="([^"]*)"/g)].map(([, id]) => id));
  const anchored = (row, id) => {
    if (ids.has(id)) return row;
    ids.add(id);
    return `<tr id="${id}">`;
  };
  const declared = /<div class="memproto">\s*<table class="memname">\s*<tr>\s*<td class="memname">(?:struct|class) [\w:]+<\/td>\s*<\/tr>\s*<\/table>\s*<\/div>/g;
  return html
    .replace(/<tr class="memitem:([^"]*)">/g, anchored)
    .replace(/<tr class="memdesc:group__[^"]*"><td class="mdescLeft">&#160;<\/td><td class="mdescRight">/g, '<tr><td></td><td class="holds">')
    .replace(/ *<a href="[^"]*">More\.\.\.<\/a>(<br \/>)?/g, "")
    .replace(/<a name="details" id="details"><\/a><h2 class="groupheader">Detailed Description<\/h2>\n/, "")
    .replace(/(<div class="contents">\n)<p >.*?<\/p>\n/, room ? "$1" : "$&")  // what a header holds: its overview says it, too
    .replace(declared, "")  // what stands in the heading above
    .replace(/<h2 class="groupheader">Class Documentation/g, '<h2 class="groupheader">Types')
    .replace(/>Class List</, ">All types<")
    .replace(/<a href="file:[^"]*">(.*?)<\/a>/g, "$1")  // FILE:LINE is no address
    .replace(`<li><a href="${room ?? page}"`, '$& aria-current="page"');
}

const characters = { "&#160;": " ", "&nbsp;": " ", "&lt;": "<", "&gt;": ">", "&quot;": '"', "&amp;": "&", "&#9670;": "" };
const plain = (html) => html.replace(/<math.*?<\/math>|<[^>]*>/gs, " ").replace(/&[#\w]+;/g, (one) => characters[one] ?? one).replace(/\s+/g, " ").trim();

// What search.js looks through: the sections of a page, each with the page's title, its own heading, its address and its text.
function sections(page, html) {
  const title = plain(html.match(/<div class="title">(.*?)<\/div>/s)?.[1] ?? "");
  const [lead, ...parts] = html.slice(html.indexOf('<div class="contents">')).split(/(?=<h\d[^>]*><a class="anchor" id=)|(?=<h2 class="memtitle">)/);
  const within = parts.map((part) => {
    const [head, heading] = part.match(/^<h\d[^>]*>(.*?)<\/h\d>/s);
    const [, anchor] = head.match(/id="([^"]*)"/) ?? head.match(/href="#([^"]*)"/);
    return [title, plain(heading), `${page}#${anchor}`, plain(part.slice(head.length))];
  });
  return [[title, title, page, plain(lead)], ...within];
}

const files = new Map(), dead = [], searched = [];
function load(file) {
  if (!files.has(file)) {
    const content = existsSync(join(made, file)) ? readFileSync(join(made, file)) : null;
    const html = content && file.endsWith(".html") ? finished(file, content.toString()) : "";
    files.set(file, { content: html || content, html, anchors: new Set([...html.matchAll(/ (?:id|name)="([^"]*)"/g)].map(([, id]) => id)) });
  }
  return files.get(file);
}
load("index.html");
let links = 0;
for (const [file, { html }] of files) {  // and those that this loads
  for (const { 1: target, index } of html.matchAll(/ (?:href|src)="(?!https?:|mailto:)([^"]*)"/g)) {
    const [path, anchor] = decodeURI(target).split("#");
    const there = load(path || file);
    const fault = there.content === null ? "no such file" : anchor && !there.anchors.has(anchor) && "no such anchor";
    if (fault) dead.push(`build/site.in/html/${file}:${html.slice(0, index).split("\n").length}: ${target}: ${fault}`);
    ++links;
  }
  if (html && !/^(namespace|annotated)/.test(file)) searched.push(...sections(file, html));
}
if (dead.length > 0) {
  console.error(dead.join("\n"));
  process.exit(1);
}

rmSync(site, { recursive: true, force: true });
for (const [file, { content }] of files) {
  mkdirSync(dirname(join(site, file)), { recursive: true });
  writeFileSync(join(site, file), content);
}
cpSync(join(made, "katex"), join(site, "katex"), { recursive: true });  // the fonts, too
writeFileSync(join(site, "search-data.js"), `const sections = ${JSON.stringify(searched)};\n`);
console.log(`site: ${[...files.keys()].filter((file) => file.endsWith(".html")).length} pages, ${links} links checked: build/site/index.html`);
