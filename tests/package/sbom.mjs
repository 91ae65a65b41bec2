// Compares the SBOM of a release with its files: node sbom.mjs FOLDER WHEEL < names of the libraries that the wheel carries, one a line
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";

const [folder, wheel] = process.argv.slice(2);
const sbom = JSON.parse(readFileSync(join(folder, "paracal.spdx.json"), "utf8"));
const packages = new Map(sbom.packages.map((entry) => [entry.SPDXID, entry]));
assert.equal(packages.size, sbom.packages.length, "an identifier appears twice");
for (const { spdxElementId, relatedSpdxElement } of sbom.relationships) {
  for (const id of [spdxElementId, relatedSpdxElement]) assert.ok(id === "SPDXRef-DOCUMENT" || packages.has(id), id);
}

const files = readdirSync(folder).filter((name) => !/^SHA256SUMS$|\.spdx\.json$/.test(name)).sort();
const listed = sbom.packages.filter((entry) => entry.packageFileName);
assert.deepEqual(listed.map(({ name }) => name).sort(), files);
for (const { name, checksums } of listed) assert.equal(checksums[0].checksumValue, createHash("sha256").update(readFileSync(join(folder, name))).digest("hex"), name);

const names = { csv: "libcsv", fmt: "{fmt}", md: "libmd", nlopt: "NLopt", tbb: "oneTBB", tomlplusplus: "toml++" };
const its = listed.find(({ name }) => name === wheel).SPDXID;
const contained = sbom.relationships.filter((entry) => entry.spdxElementId === its && entry.relationshipType === "CONTAINS").map((entry) => packages.get(entry.relatedSpdxElement).name);
const carried = readFileSync(0, "utf8").trim().split("\n");
assert.ok(carried.length >= 6, `${carried}`);
for (const name of carried) assert.ok(contained.includes(names[name]), `${wheel} carries ${name}, and its SBOM lists only ${contained}`);
console.log(`SBOM: ${listed.length} files, ${sbom.packages.length - listed.length} packages of others`);
