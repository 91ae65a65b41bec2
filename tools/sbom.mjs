// Writes the SBOM of a release as SPDX 2.3: node sbom.mjs FOLDER OUTPUT. It lists each file of FOLDER with its checksum, and the software of others that the file
// carries (CONTAINS) or loads from the system (DYNAMIC_LINK). The names, packages and licences are those of cmake/notices.cmake and of the page's notices.
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const [folder, output] = process.argv.slice(2);
const read = (path) => readFileSync(fileURLToPath(new URL(`../${path}`, import.meta.url)), "utf8");
const run = (...command) => execFileSync(command[0], command.slice(1), { encoding: "utf8" }).trim();
const idOf = (...parts) => `SPDXRef-${parts.join("-").replace(/[^A-Za-z0-9.-]/g, "-")}`;

// Software of others, by who needs it. `shared`: a library that the system loads, unless a file carries it.
const shared = new Set(["oneTBB", "NLopt", "{fmt}", "toml++", "libcsv", "libmd", "zlib"]);
const debian = (name, source, licence) => ({
  name, licence, version: run("dpkg-query", "-W", "-f=${Version}", source), purl: (version) => `pkg:deb/debian/${source}@${encodeURIComponent(version)}`,
});
const libraries = [...read("cmake/notices.cmake").matchAll(/^ {2}"([^"|]+)\|([^"|]+)\|([^"|]+)"/gm)].map(([, ...entry]) => debian(...entry));
libraries.push(debian("Boost", "libboost-dev", "BSL-1.0"));
const binding = debian("pybind11", "pybind11-dev", "BSD-3-Clause");
const equations = debian("KaTeX", "libjs-katex", "MIT AND OFL-1.1");
const page = [...read("web/built/licences_of_the_page.txt").matchAll(/^(\S+) ([\d.]+) \((.+)\)$/gm)].map(([, name, version, licence]) => ({
  name, version, licence, purl: () => `pkg:npm/${name.replace("@", "%40")}@${version}`,
}));

const mine = (of) => of.filter(({ name }) => !shared.has(name)), theirs = (of) => of.filter(({ name }) => shared.has(name));
const named = (of, ...names) => of.filter(({ name }) => names.includes(name));
const without = (of, ...names) => of.filter(({ name }) => !names.includes(name));
// What a file carries and what it loads, by the form of its name.
const rules = [
  [/^paracal_.*\.deb$/, [...mine(libraries), ...page, equations], theirs(libraries)],
  [/^paracal-mpi_.*\.deb$/, [...mine(libraries), ...page], theirs(libraries)],
  [/^python3-paracal_.*\.deb$/, [...without(mine(libraries), "CLI11"), binding], without(theirs(libraries), "zlib")],
  [/^libparacal-dev_.*\.deb$/, without(mine(libraries), "CLI11"), without(theirs(libraries), "zlib")],
  [/\.whl$/, [...without(libraries, "zlib"), ...page, binding], named(libraries, "zlib")],
  [/^paracal-live\.html$/, [...without(libraries, "oneTBB"), ...page], []],
  [/^paracal-site\.tar\.gz$/, [equations], []],
  [/^CHANGELOG\.md$/, [], []],
];

const version = read("CMakeLists.txt").match(/^project\(paracal VERSION (\S+)/m)[1];
const packages = new Map(), relationships = [];
function add(id, entry) {
  packages.set(id, { SPDXID: id, downloadLocation: "NOASSERTION", filesAnalyzed: false, copyrightText: "NOASSERTION", licenseConcluded: "NOASSERTION", ...entry });
  return id;
}
function addOther({ name, version: its, licence, purl }) {
  return add(idOf(name, its), {
    name, versionInfo: its, licenseDeclared: licence,
    externalRefs: [{ referenceCategory: "PACKAGE-MANAGER", referenceType: "purl", referenceLocator: purl(its) }],
  });
}
for (const file of readdirSync(folder).sort()) {
  if (/^SHA256SUMS$|\.spdx\.json$/.test(file)) continue;
  const rule = rules.find(([form]) => form.test(file));
  if (!rule) throw new Error(`sbom: expected a rule for ${file} in tools/sbom.mjs, got none`);
  const checksumValue = createHash("sha256").update(readFileSync(join(folder, file))).digest("hex");
  const id = add(idOf(file), { name: file, packageFileName: file, versionInfo: version, licenseDeclared: "Apache-2.0", checksums: [{ algorithm: "SHA256", checksumValue }] });
  relationships.push({ spdxElementId: "SPDXRef-DOCUMENT", relationshipType: "DESCRIBES", relatedSpdxElement: id });
  for (const [relationshipType, others] of [["CONTAINS", rule[1]], ["DYNAMIC_LINK", rule[2]]]) {
    for (const other of others) relationships.push({ spdxElementId: id, relationshipType, relatedSpdxElement: addOther(other) });
  }
}

const commit = run("git", "rev-parse", "HEAD");
writeFileSync(output, `${JSON.stringify({
  spdxVersion: "SPDX-2.3", dataLicense: "CC0-1.0", SPDXID: "SPDXRef-DOCUMENT", name: `paracal ${version}`, documentNamespace: `urn:paracal:${version}:${commit}`,
  creationInfo: { created: new Date(1000 * run("git", "log", "-1", "--format=%ct")).toISOString().replace(/\.\d+Z$/, "Z"), creators: ["Tool: paracal tools/sbom.mjs"] },
  packages: [...packages.values()], relationships,
}, null, 1)}\n`);
