// Makes the live page: node build_live.mjs BUILD OUTPUT, of what emscripten has built in the folder BUILD. The program goes into the page packed
// (gzip, base64), its loader with the worker that runs it, and the samples; the policy names the page's own text and that of the
// reports that it shows, and lets nothing be fetched.
import { readFileSync, writeFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { bundled, filled, hashOf, notices, withinHtml, withinScript } from "./bundle.mjs";

const [build, output] = process.argv.slice(2);
const root = new URL("../", import.meta.url);
const built = (name) => readFileSync(`${build}/${name}`);
const file = (name) => [name.split("/").at(-1), readFileSync(new URL(name, root), "utf8")];

/// By the keys of strings.sample (web/src/live/strings.ts): files, and the robot where they do not say it.
const samples = {
  printer: { robot: "", files: ["samples/printer.cfg"] },
  published: { robot: "", files: ["data/huang2016/distances.csv", "data/huang2016/poses.csv"] },
  points: { robot: "", files: ["samples/measured.csv", "samples/tolerances.toml"] },
  tolerances: { robot: "huang2016", files: ["samples/drawing.toml"] },
};
const carried = Object.entries(samples).map(([name, { robot, files }]) => [name, { robot, files: Object.fromEntries(files.map(file)) }]);

/// Of what the program is made of besides what `paracal --licenses` names, which is in the program.
const withWebAssembly = ["emscripten", "librange-v3-dev", "libfast-float-dev"];
const copyright = (name) => `${name}\n\n${readFileSync(`/usr/share/doc/${name}/copyright`, "utf8")}`;

const [style, page, worker] = await Promise.all(["src/live/live.css", "src/live/main.ts", "src/live/worker.ts"].map(bundled));
const program = withinScript(page.text);
const licences = ["The program itself: paracal --licenses, in the line of the command.", ...withWebAssembly.map(copyright), readFileSync(new URL("built/licences_of_the_page.txt", import.meta.url), "utf8"), notices(page.inputs)];
const reportHash = /script-src ('sha256-[^']+')/.exec(readFileSync(new URL("built/report.html", import.meta.url), "utf8"))[1];
const text = filled("src/live/template.html", {
  PARACAL_STYLE: style.text,
  PARACAL_NOTICES: withinHtml(licences.filter(Boolean).join(`\n${"-".repeat(60)}\n\n`)),
  PARACAL_PROGRAM: gzipSync(built("bin/paracal.wasm"), { level: 9 }).toString("base64"),
  PARACAL_WORKER: withinScript(`${built("bin/paracal.js")}\n${worker.text}`),
  PARACAL_SAMPLES: JSON.stringify(Object.fromEntries(carried)).replaceAll("<", "\\u003c"),
  PARACAL_PAGE: program,
  PARACAL_HASH: hashOf(program),
  PARACAL_REPORT_HASH: reportHash,
});
writeFileSync(output, text);
console.log(`${output}: ${(text.length / 1e6).toFixed(2)} MB`);
