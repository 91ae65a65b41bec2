// Compares two records of tools/record_commands.sh: node tools/compare_records.mjs ONE OTHER [RELATIVE]
// Words must be the same, numbers to 1e-12 of themselves unless told otherwise; dates, builds and hashes of files may differ. What the
// second has besides (another key, another line) is named, too. Exit code 1 where anything differs.
import { readdirSync, readFileSync, statSync } from "node:fs";
import { join } from "node:path";

const [one, other, relative = "1e-12"] = process.argv.slice(2);
if (!other) {
  console.error("expected: node tools/compare_records.mjs ONE OTHER [RELATIVE]");
  process.exit(2);
}
const tolerance = Number(relative);
const kNumber = /[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?/g;

const filesOf = (folder) => readdirSync(folder, { recursive: true }).filter((name) => statSync(join(folder, name)).isFile()).sort();

/// Without what says when and by which build it was made.
const timeless = (text) =>
  text
    .replace(/\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ/g, "DATE")
    .replace(/"build": *"[^"]*"/g, '"build": "BUILD"')
    .replace(/\([0-9a-f]{12}(-dirty)?,/, "(COMMIT,")
    .replace(/\b[0-9a-f]{40,64}\b/g, "HASH");

const words = (text) => text.replace(kNumber, "#");
const numbers = (text) => (text.match(kNumber) ?? []).map(Number);

/// Of two lines: the largest relative difference of their numbers, or that they say something else.
function difference(a, b) {
  if (a === b) return 0;
  if (words(a) !== words(b)) return Infinity;
  const theirs = numbers(b);
  return Math.max(0, ...numbers(a).map((value, k) => (value === theirs[k] ? 0 : Math.abs(value - theirs[k]) / Math.max(Math.abs(value), Math.abs(theirs[k])))));
}

function compare(name) {
  const [was, is] = [one, other].map((folder) => timeless(readFileSync(join(folder, name), "utf8")).split("\n"));
  for (let k = 0; k < Math.max(was.length, is.length); ++k) {
    const [a, b] = [was[k] ?? "", is[k] ?? ""];
    const off = difference(a, b);
    if (off > tolerance) return `${name}:${k + 1}: ${off === Infinity ? "other words" : `off by ${off.toExponential(1)}`}\n  - ${a.slice(0, 160)}\n  + ${b.slice(0, 160)}`;
  }
  return null;
}

const [before, after] = [one, other].map(filesOf);
const found = [
  ...before.filter((name) => !after.includes(name)).map((name) => `${name}: only in ${one}`),
  ...after.filter((name) => !before.includes(name)).map((name) => `${name}: only in ${other}`),
  ...before.filter((name) => after.includes(name)).map(compare).filter(Boolean),
];
for (const text of found) console.log(text);
console.log(`${before.length} files, ${found.length} differ by more than ${relative}`);
process.exit(found.length > 0 ? 1 : 0);
