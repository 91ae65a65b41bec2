// What the documents say of each other and of others' work, and the version wherever it stands.
import assert from "node:assert/strict";
import { mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { speed, withSpeed } from "../../tools/comparison.mjs";
import { deadLinks, headings } from "./markdown.mjs";

const root = fileURLToPath(new URL("../..", import.meta.url));
const read = (path) => readFileSync(join(root, path), "utf8");
const documents = [".", "docs", "samples", ...readdirSync(join(root, "data")).map((folder) => `data/${folder}`)].flatMap((folder) =>
  readdirSync(join(root, folder)).filter((file) => file.endsWith(".md")).map((file) => join(folder, file)),
);

test("every link leads somewhere", () => {
  assert.ok(documents.includes("README.md") && documents.includes("docs/files.md") && documents.includes("data/huang2016/README.md"));
  assert.deepEqual(deadLinks(root, documents), []);
});

test("links that lead nowhere are told with file and line", (t) => {
  const folder = mkdtempSync(join(tmpdir(), "links"));
  t.after(() => rmSync(folder, { recursive: true }));
  mkdirSync(join(folder, "docs"));
  writeFileSync(join(folder, "README.md"), "# One\n\nSee [one](docs/one.md#a-b), [it](docs/one.md#a), ![drawn](no.svg)\nand [here](#one), [not\nhere](#two), [a](https://a.b/#c).\n");
  writeFileSync(join(folder, "docs/one.md"), "# A `b`\n\n    [code](gone.md)\n\n`[code](gone.md)`\n~~~\n# A\n~~~\n[up](../README.md), [gone](two.md#x)\n");
  assert.deepEqual(deadLinks(folder, ["README.md", "docs/one.md"]), [
    "README.md:3: docs/one.md#a: no such anchor",
    "README.md:3: no.svg: no such file",
    "README.md:5: #two: no such anchor",
    "docs/one.md:9: two.md#x: no such file",
  ]);
});

test("headings have the anchors of a git host", () => {
  assert.deepEqual(headings("# What is `a_b`, in mm?\n## Twice\n## Twice\n").map(({ slug }) => slug), ["what-is-a_b-in-mm", "twice", "twice-1"]);
});

const filesBelow = (folder) =>
  readdirSync(join(root, folder), { withFileTypes: true }).flatMap((entry) => {
    const path = join(folder, entry.name);
    return entry.isDirectory() ? filesBelow(path) : /\.(?:[ch]pp|ts|m?js|py|sh|txt|cmake|json|h|st|comp)$/.test(path) ? [path] : [];
  });

test("recipes and design name what exists", () => {
  const folders = ["apps", "cmake", "include", "live", "python", "schema", "src", "tests", "tools", "web/src"];
  const words = new Set(folders.flatMap(filesBelow).flatMap((path) => `${path} ${read(path)}`.match(/\w+/g)));
  for (const document of ["CONTRIBUTING.md", "docs/design.md"]) {
    const names = [...read(document).matchAll(/`([A-Za-z_][\w:]{3,})(?:\(\))?`/g)].map(([, name]) => name.split("::").at(-1));
    assert.ok(names.length > 30);
    assert.deepEqual(names.filter((name) => !words.has(name)), [], document);
  }
});

const found = (path, pattern) => read(path).match(pattern)?.[1];
const version = found("CMakeLists.txt", /^project\(paracal VERSION (\S+) /m);

test("the speed in evidence.md was measured with this version, and nobody edited it", () => {
  const measured = JSON.parse(read("docs/comparison.json"));
  const evidence = read("docs/evidence.md");
  assert.equal(measured.version, version, "docs/comparison.json is of another version: run tools/comparison.sh --write");
  assert.equal(withSpeed(evidence, measured), evidence, "docs/evidence.md, \"Speed\", was edited: run tools/comparison.sh --write");
  // The test sees a figure that was changed, a sentence that was added, and another order.
  const section = speed(measured);
  const [first, second] = section.match(/^\| [\d.n].*$/gm);
  for (const edited of [section.replace(/\d(?= ms per fit)/, (digit) => (Number(digit) + 1) % 10), `${section}\n1000 times as fast.\n`, section.replace(`${first}\n${second}`, `${second}\n${first}`)]) {
    assert.notEqual(edited, section);
    const document = evidence.replace(section, () => edited);
    assert.notEqual(withSpeed(document, measured), document);
  }
});

test("the least flattering comparison stands first", () => {
  const ratios = speed(JSON.parse(read("docs/comparison.json"))).match(/^\| [\d.]+(?= \([\d.]+ to )/gm).map((cell) => Number(cell.slice(2)));
  assert.ok(ratios.length > 10 && ratios[0] < 1);
  assert.deepEqual(ratios, ratios.toSorted((a, b) => a - b));
});

test("the version is the same wherever it stands", () => {
  assert.match(version, /^\d+\.\d+\.\d+$/);
  const [, released, date] = read("CHANGELOG.md").match(/^## \[(\d\S*)\] - (\S+)$/m);
  assert.equal(found("CITATION.cff", /^version: (.*)$/m), version, "CITATION.cff");
  assert.equal(released, version, "the newest in CHANGELOG.md");
  assert.equal(found("CITATION.cff", /^date-released: (.*)$/m), date, "CITATION.cff and CHANGELOG.md");
  assert.equal(found("tests/package/consumer/CMakeLists.txt", /find_package\(paracal (\S+)/), version.replace(/\.\d+$/, ""), "whoever asks for this minor version");
  if (process.env.PARACAL_PACKAGES) assert.match(readFileSync(process.env.PARACAL_PACKAGES, "utf8"), new RegExp(`^set\\(CPACK_PACKAGE_VERSION "${version}"\\)$`, "m"));
});

test("every reference says who, what, when and for what", () => {
  const entries = read("docs/references.md").split("\n\n").slice(2).map((entry) => entry.replace(/\s+/g, " ").trim());
  assert.ok(entries.length > 30);
  for (const entry of entries) {
    const [, key, said] = entry.match(/^\*\*\[([\w-]+)\]\*\* (.*)$/);
    assert.match(said, /^[A-Z][^*"]*[,:]/, `${key}: who`);
    assert.match(said, /"[^"]+,"|\*[^*]+\*/, `${key}: what`);
    assert.match(said, /\b(1[89]|20)\d\d\b|undated/, `${key}: when`);
    assert.match(said, / Used for: .*\.$/, `${key}: for what`);
  }
});
