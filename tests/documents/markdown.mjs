// What a git host makes of Markdown documents: which lines are code, the anchors of headings, links, and which of these lead nowhere.
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";

/** A flag a line: in a fence, or set apart by four blanks. */
export function isCode(text) {
  let fence = "", apart = true;  // apart: behind an empty line or code that is set apart
  return text.split("\n").map((line) => {
    const [mark = ""] = line.match(/^ *(`{3,}|~{3,})/) ?? [];
    if (fence || mark) {
      const inside = fence;
      if (!fence) fence = mark.trim();
      else if (mark.trim().startsWith(fence)) fence = "";
      return Boolean(inside || mark);
    }
    const code = apart && /^ {4}/.test(line);
    apart = code || line.trim() === "";
    return code;
  });
}

/** Headings with their lines and anchors. */
export function headings(text) {
  const code = isCode(text), met = new Map();
  return text.split("\n").flatMap((line, k) => {
    const [, words] = (!code[k] && line.match(/^#{1,6} +(.*?) *#*$/)) || [];
    if (words === undefined) return [];
    const slug = words.replace(/!?\[([^\]]*)\]\([^)]*\)/g, "$1").toLowerCase().replace(/[^\p{L}\p{M}\p{N}\p{Pc}\- ]/gu, "").replaceAll(" ", "-");
    const times = met.get(slug) ?? 0;
    met.set(slug, times + 1);
    return [{ line: k + 1, words, slug: times ? `${slug}-${times}` : slug }];
  });
}

/** Links and pictures outside of code, with the lines where they end. */
export function links(text) {
  const code = isCode(text);
  const prose = text
    .split("\n")
    .map((line, k) => (code[k] ? "" : line))
    .join("\n")
    .replace(/`[^`]+`/g, (span) => span.replace(/[^\n]/g, " "));
  return [...prose.matchAll(/\]\(([^)\s]*)\)/g)].map(({ 1: target, index }) => ({ line: prose.slice(0, index).split("\n").length, target }));
}

/** Links of DOCUMENTS, paths below ROOT, that lead nowhere: "FILE:LINE: TARGET: why". Addresses of other machines are not asked for. */
export function deadLinks(root, documents) {
  const anchors = new Map();
  const has = (path, anchor) => {
    if (!anchors.has(path)) anchors.set(path, new Set(headings(readFileSync(path, "utf8")).map(({ slug }) => slug)));
    return anchors.get(path).has(anchor);
  };
  return documents.flatMap((document) =>
    links(readFileSync(join(root, document), "utf8")).flatMap(({ line, target }) => {
      if (/^(https?|mailto):/.test(target)) return [];
      const [path, anchor] = target.split("#");
      const to = path ? join(root, dirname(document), path) : join(root, document);
      const fault = !existsSync(to) ? "no such file" : anchor !== undefined && !(to.endsWith(".md") && has(to, anchor)) && "no such anchor";
      return fault ? [`${document}:${line}: ${target}: ${fault}`] : [];
    }),
  );
}
