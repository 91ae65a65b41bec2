// Writes the section "Speed" of docs/evidence.md from the records of the benchmarks: node tools/comparison.mjs RECORDS LOAD [--write]. LOAD is the load
// average before the start. tools/comparison.sh calls it; tests/documents/ compares the section with docs/comparison.json. To change only the words, edit
// them here and run: node tools/comparison.mjs docs/comparison.json --write.
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const rounded = (key, value) => (typeof value === "number" ? Number(value.toPrecision(3)) : value);
const number = (value) => (value >= 100 ? value.toFixed(0) : String(Number(value.toPrecision(2))));
const micro = (unit) => unit.replace(/^us/, "µs");
const percent = (share) => `${number(100 * share)} %`;
const row = (cells) => `| ${cells.join(" | ")} |`;
const table = (head, rows) => [row(head), row(head.map(() => "---")), ...rows.map(row)].join("\n");

/// One object from the lines of all programs, with the host of the last one.
/// @param sources  "COMMIT HASH" of what was measured.
export function collected(lines, load, date, sources) {
  const records = lines.trim().split("\n").map((line) => JSON.parse(line));
  const host = records.findLast((record) => record.version);
  const [commit, sha256] = sources.split(" ");
  return { ...host, date, load, sources: { commit, sha256 }, records: records.filter((record) => !record.version) };
}

function compared({ times, opponent, task, ours, theirs, unit, threads, note, missing }) {
  if (missing) return ["not installed", opponent, task, "", "", "", `package ${missing}`];
  const [low, median, high] = times.map(number);
  return [`${median} (${low} to ${high})`, opponent, task, number(ours), `${number(theirs)} ${micro(unit)}`, threads, note];
}

export function speed({ version, cpu, cores, compiler, flags, date, load, sources, records }) {
  const comparisons = records.filter(({ opponent }) => opponent).sort((a, b) => (a.times?.[1] ?? 0) - (b.times?.[1] ?? 0));
  const peaks = records.filter(({ share }) => share !== undefined).sort((a, b) => a.share - b.share);
  const times = records.filter(({ what }) => what);
  const { peak, peak_gflops, compiled_gflops } = peaks[0];
  return `## Speed

Do not edit this section. \`tools/comparison.sh --write\` measures and writes it; without \`--write\` it only prints.
A test compares the section with [comparison.json](comparison.json). \`tools/setup.sh comparison\` installs the other
programs.

Measured on ${date} with paracal ${version}${sources ? ` (commit ${sources.commit})` : ""} on an ${cpu} with ${cores} logical cores (load ${load} before the start).
Compiler: ${compiler}, \`${flags.replace(/: +/, ": ")}\` without \`-march\`, so paracal uses no vector instructions beyond SSE2.
The other programs are Debian's unless the table states otherwise. The processor in brackets after OpenBLAS is the one
that its code is optimised for: SkylakeX has AVX-512, Haswell has AVX2.

### Beside other programs

The ratio is the time of the other program divided by the time of paracal. Below 1 the other program is faster. The
least favourable row is first. In each round both programs do the same task, one after the other. The ratio is the
median over the rounds, with the middle half of the rounds in brackets.

${table(["ratio", "other program", "task", "paracal", "other", "threads, both", "difference"], comparisons.map(compared))}

### Beside the limits of the processor

The peak is the speed of one core that only multiplies and adds in registers. It is ${number(peak_gflops)} GFLOP/s with ${peak}, the
widest instructions of this processor, and ${number(compiled_gflops)} GFLOP/s with the instructions for which paracal is compiled.
Additions, multiplications, divisions and square roots count as operations; sines and arctangents do not.

${table(["function, one thread", "time", "GFLOP/s", `percentage of the ${peak} peak`, "percentage of the peak as compiled"], peaks.map((one) => [one.task, `${number(one.ours)} ${micro(one.unit)}`, number(one.gflops), percent(one.share), percent(one.share_compiled)]))}

### Times without comparison

${table(["task, one thread", "median"], times.map(({ what, value, unit }) => [what, `${number(value)} ${unit}`]))}

Times of batches: [scale](scale.md).
`;
}

/// The document with its section replaced by this one.
export const withSpeed = (document, measured) => document.replace(/^## Speed\n[^]*?(?=^## |(?![^]))/m, () => speed(measured));

function main(path, load) {
  const text = readFileSync(path, "utf8");
  const measured = path.endsWith(".json") ? JSON.parse(text) : JSON.parse(JSON.stringify(collected(text, Number(load), new Date().toISOString().slice(0, 10), process.env.PARACAL_SOURCES), rounded));
  console.log(speed(measured));
  if (process.argv.at(-1) !== "--write") return;
  const { records, ...host } = measured;
  const lines = records.map((record) => `    ${JSON.stringify(record)}`).join(",\n");
  writeFileSync("docs/comparison.json", `${JSON.stringify(host, null, 2).slice(0, -2)},\n  "records": [\n${lines}\n  ]\n}\n`);
  writeFileSync("docs/evidence.md", withSpeed(readFileSync("docs/evidence.md", "utf8"), measured));
}
if (import.meta.url === pathToFileURL(process.argv[1] ?? "").href) main(...process.argv.slice(2));
