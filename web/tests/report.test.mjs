// The pages of the built program in a real browser: PARACAL=path/to/paracal node --test web/tests/
// Each page is loaded once for all that is checked of it. Accessibility: each kind of section and figure once, and its colours in the
// dark; with PARACAL_EVERY_MACHINE every page, and every one loaded in the dark and on a phone, too.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { test } from "node:test";
import { hostileNames, samples } from "../samples.mjs";
import { dataOf, isDrawn, launch, open } from "./browser.mjs";

const kEvery = process.env.PARACAL_EVERY_MACHINE !== undefined;
const kLargestFile = 2.5e6; // bytes
const kPhone = { width: 360, height: 740 };
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const folder = mkdtempSync(join(tmpdir(), "paracal-report-"));
let pages;

/// What is to be checked of a page, in this order, once it is loaded: { kind, name, check }.
const checks = [];
const of = (kind, name, check) => checks.push({ kind, name, check });

/// What a drawing holds of what its frame promises: marks of a plot, cells of a map.
const kMarks = {
  dots: ".drawing svg g[aria-label=dot] > *",
  bars: ".drawing svg g[aria-label=bar] > rect",
  rects: ".drawing svg g[aria-label=rect] > rect",
  cells: ".drawing svg g[aria-label=cell] > rect, .drawing svg .cell",
};
const kMarksOf = [
  [/^(residual|normal|validated|parameters|observability|drive)/, "dots", 1],
  [/^(offsets|table|volume|figure\d|tilt)/, "dots", 2], // paper and ours
  [/^(map|sigma|correlations|bed)/, "cells", 1],
  [/^(pareto|global|allocated)/, "bars", 1],
  [/^(batch|machines)/, "rects", 1],
];

async function checkMarks(page) {
  const figures = await page.$$eval("figure[data-marks]", (all, selectors) => all.map((one) => ({ id: one.id, promised: Number(one.dataset.marks), drawn: { ...Object.fromEntries(Object.entries(selectors).map(([kind, selector]) => [kind, one.querySelectorAll(selector).length])), points: [...one.querySelectorAll(".drawing svg g:is([stroke-width='5'], [stroke-width='6']) > path")].reduce((sum, path) => sum + path.getAttribute("d").split("M").length - 1, 0) } })), kMarks);
  assert.ok(figures.length > 0);
  for (const { id, promised, drawn } of figures) {
    if (id === "robot-errors") continue; // drawn in three dimensions
    drawn.dots += drawn.points;
    const [, kind, times] = kMarksOf.find(([pattern]) => pattern.test(id)) ?? assert.fail(`${id}: not in this test's list`);
    assert.ok(promised > 0, id);
    const beside = id === "global-sensitivity" ? drawn.dots : promised; // its largest values are dots
    assert.equal(beside, promised, id);
    assert.equal(drawn[kind], times * promised, `${id}: ${kind}`);
  }
}

async function checkRules(page, rules = {}) {
  await page.evaluate(axe);
  const { violations } = await page.evaluate((chosen) => window.axe.run(chosen), rules);
  const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
  assert.deepEqual(serious.map(({ id, nodes }) => [id, ...nodes.slice(0, 3).map((node) => node.html.slice(0, 200))]), []);
}

async function becomes(page, colorScheme) {
  await page.emulateMedia({ colorScheme });
  await page.waitForFunction((theme) => document.documentElement.dataset.theme === theme, colorScheme);
}

const accessible = new Set(); // sections and figures

async function checkAccessibility(page) {
  const parts = await page.$$eval("section[id], figure[id], #verdict", (all) => all.map(({ id }) => id));
  if (!kEvery && parts.every((part) => accessible.has(part))) return;
  for (const part of parts) accessible.add(part);
  await checkRules(page);
  await becomes(page, "dark");
  await checkRules(page, { runOnly: "cat.color" });
  await becomes(page, "light");
}

async function checkWidth(page) {
  const [content, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  assert.ok(content <= screen, `${content} px on ${screen}`);
}

of("calibration", "how soon the first figure stands", async (page) => {
  const times = [];
  for (let k = 0; k < (kEvery ? 3 : 1); ++k) {
    await page.reload({ waitUntil: "commit" });
    times.push(await page.evaluate(() => new Promise((done) => {
      const look = () => (document.querySelector(".drawing svg, canvas[data-frames]") ? done(performance.now()) : requestAnimationFrame(look));
      look();
    })));
  }
  await isDrawn(page);
  console.log(`first figure after ${times.map((time) => Math.round(time)).join(", ")} ms`); // told, not judged: the machine may be busy
});

of("reproduction", "every published number stands with its verdict and reason, and the counts above", async (page) => {
  const { rows, counts, rule } = (await dataOf(page)).results.reproduction;
  const shown = await page.locator("#published > .scroll tbody tr").evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  assert.deepEqual(shown.map((cells) => [cells[0], ...cells.slice(-2)]), rows.map((row) => [row.quantity, row.verdict, row.reason]));
  const head = await page.locator("#verdict .verdict").first().textContent();
  assert.ok(head.includes(`${counts.reproduced} of ${rows.length} published numbers reproduced`), head);
  assert.ok(head.includes(`${counts.not_reproduced} are not reproduced and ${counts.cannot_be_tested} cannot be tested`), head);
  const text = await page.locator("#published").textContent();
  for (const sentence of rule) assert.ok(text.includes(sentence), sentence);
});

/// What `yield` prints where it was stopped before the first machine.
function withoutMachines(report) {
  const { yield: batch } = report.results, nothing = (value) => (Array.isArray(value) ? value.map(nothing) : typeof value === "object" && value ? Object.fromEntries(Object.entries(value).map(([key, one]) => [key, nothing(one)])) : null);
  const none = { bin_width: 0, counts: [], total: 0 };
  Object.assign(batch, { machines: 0, produced: 0, partial: true, passed: 0, yield: { value: null, low: 0, high: 1, confidence: 0.95 }, dpmo: { value: null, low: 0, high: 1e6 }, quantities: nothing(batch.quantities) });
  for (const one of report.figures.largest_of_a_machine) Object.assign(one, { before: none, after: none });
  return report;
}

/// A page of the program with other data.
function changed(page, name, change) {
  const file = join(folder, name);
  const data = /(<script[^>]*id="data"[^>]*>)(.*?)(<\/script>)/s;
  writeFileSync(file, readFileSync(page, "utf8").replace(data, (_, begin, json, end) => begin + JSON.stringify(change(JSON.parse(json))) + end));
  return file;
}

const kManyPoints = 3000;

function withManyPoints(report) {
  const { calibration } = report.results, few = calibration.residuals;
  const round = (numbers) => numbers.map((number) => Number(number.toPrecision(4)));
  calibration.residuals = Array.from({ length: kManyPoints }, (_, k) => ({ ...few[k % few.length], before_mm: round(few[k % few.length].before_mm), after_mm: round(few[k % few.length].after_mm) }));
  return report;
}

of("large", "thousands of readings do not become as many elements", async (page) => {
  assert.ok((await page.locator("*").count()) < 10_000);
  const points = await page.$$eval("#residuals-after .drawing g:is([stroke-width='5'], [stroke-width='6']) > path", (all) => all.map((one) => one.getAttribute("d").split("M").length - 1));
  const used = (await dataOf(page)).results.calibration.residuals.filter((one) => !one.excluded).length;
  assert.ok(points.includes(3 * used), points.join());
});

of("nothing", "a batch that was stopped before its first machine says nothing of machines", async (page) => {
  const cells = await page.locator("#machines table", { hasText: "99.73 %" }).last().locator("tbody tr").evaluateAll((rows) => rows.map((row) => [...row.cells].slice(2).map((cell) => cell.textContent)));
  assert.ok(cells.length >= 8);
  for (const cell of cells.flat()) assert.match(cell, /^\u2013( to \u2013)?$/);
  assert.deepEqual(await page.locator("#verdict .card").allTextContents(), []);
});

for (const [kind, rows] of [["allocation", { "rod_difference_mm": 0, "beta2_deg": 5 }], ["strutallocation", { "zero_mm": 0 }]]) {
  of(kind, "tolerances stand beside what they are on a drawing", async (page) => {
    const { drawing } = (await dataOf(page)).results.allocation;
    const table = page.locator("#allocated-tolerances details");
    await table.locator("summary").click();
    await table.locator("tbody tr").first().waitFor();
    const said = await table.locator("tbody tr").evaluateAll((all) => all.map((row) => row.cells[2].textContent));
    for (const [key, row] of Object.entries(rows)) assert.equal(said[row], drawing[key].text);
    assert.ok(said.every((text) => text.length > 10), said);
  });
}

of("calibration", "numbers in the page are those of the JSON", async (page) => {
  const { results } = await dataOf(page);
  const printed = JSON.parse(readFileSync(join(folder, "calibration.json"), "utf8"));
  assert.deepEqual(results.calibration, printed);
  const table = page.locator("#parameters-deg details");
  await table.locator("summary").click();
  await table.locator("tbody tr").first().waitFor();  // written when it opens
  const rows = await table.locator("tbody tr").evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  const wanted = printed.parameters.filter(({ status, unit }) => status !== "fixed" && unit === "deg");
  assert.equal(rows.length, wanted.length);
  rows.forEach(([name, limb, value, U], k) => {
    assert.equal(name, wanted[k].name);
    assert.equal(Number(limb), wanted[k].limb);
    const expanded = wanted[k].U; // two digits of it are shown, and the value to the same place
    const near = (text, number) => assert.ok(Math.abs(Number(text.replace("\u2212", "-")) - number) <= 0.051 * expanded, `${text} for ${number}`);
    near(value, wanted[k].value);
    near(U, expanded);
  });
  const cards = await page.locator(".card").allTextContents();
  const inUse = Number(cards[0].match(/\u00b1\s*([\d.]+)/)[1]); // U over the workspace comes first, to two digits
  assert.ok(cards[0].startsWith("U over the workspace") && Math.abs(inUse - printed.use.distance_mm.U) <= 0.051 * printed.use.distance_mm.U, cards[0]);
  const [from, to] = cards.find((text) => text.startsWith("Residuals of distances")).match(/[\d.]+/g).map(Number);
  assert.ok(Math.abs(from - printed.before.max_abs_distance_mm) < 0.051 && Math.abs(to - printed.after.max_abs_distance_mm) < 0.051, cards.join());
  assert.equal(await page.locator(".verdict").count(), 1);
  for (const one of printed.assumed) assert.ok((await page.locator(".notes").allTextContents()).join().includes(one), one);
});

of("calibration", "an outlier is named and excluded", async (page) => {
  const { results } = await dataOf(page);
  const [worst] = results.calibration.suspects;
  assert.ok(worst.excluded);
  const row = await page.locator("#residuals table tbody tr").first().allTextContents();
  assert.ok(row[0].startsWith(worst.reading) && row[0].endsWith("excluded"), row[0]);
});

for (const kind of ["printer", "keep"]) {
  of(kind, "an owner of a printer is not told what only makers of robots need", async (page) => {
    for (const id of ["poses-needed", "correlations"]) assert.equal(await page.$(`#${id}`), null, `${kind}: ${id}`);
    assert.notEqual(await page.$("#printer"), null);
    const { printer } = (await dataOf(page)).results.calibration, discs = printer.advice === "accept_new" ? 2 : 1; // the bed before, and after
    assert.equal(await page.locator("#bed .cell").count(), discs * printer.bed.length);
  });
}

for (const [kind, are, are_not] of [["yield", /Machines within the limits: \d+ of 30/, /null/], ["unlimited", /\d+ machines; no limits are stated/, /within the limits|null/]]) {
  of(kind, "what was assumed is noted, and without limits nothing is said to keep them", async (page) => {
    const { results } = await dataOf(page), header = await page.locator("#verdict").textContent();
    assert.ok(results.yield.assumed[0].includes("theta_offset"));
    assert.ok((await page.locator(".notes").textContent()).includes(results.yield.assumed[0]));
    assert.match(header, are);
    assert.doesNotMatch(header, are_not);
  });
}

of("bodies", "poses of a body show how far it is turned", async (page) => {
  const { results } = await dataOf(page);
  const verdict = await page.locator("#verdict").textContent();
  assert.match(verdict, /Residuals of a body's orientation, largest/);
  assert.ok(results.calibration.after.max_orientation_deg > 0);
});

of("refused", "a calibration that was refused says so first, and why", async (page) => {
  const { results } = await dataOf(page);
  const verdict = page.locator(".verdict.no");
  assert.match(await verdict.locator("strong").textContent(), new RegExp(results.calibration.verdict));
  for (const reason of results.calibration.reasons) assert.ok((await verdict.textContent()).includes(reason));
  assert.equal(await page.locator("#where").count(), 0);
});

of("hostile", "each figure gives its data as CSV, and text that a spreadsheet would run is harmless", async (page) => {
  const { results } = await dataOf(page);
  const download = page.waitForEvent("download");
  await page.locator("#residual-sizes button").click();
  const file = await download;
  assert.equal(file.suggestedFilename(), "residual-sizes.csv");
  const lines = readFileSync(await file.path(), "utf8").trim().split("\n");
  assert.equal(lines[0], "name,before_mm,after_mm");
  assert.equal(lines.length, 1 + results.calibration.residuals.length);
  assert.ok(lines.some((line) => line.startsWith("'=HYPERLINK(1),")), lines.join("\n"));
});

of("hostile", "names stay text whatever they hold", async (page) => {
  assert.deepEqual(await page.locator("img").count(), 0);
  assert.deepEqual(await page.locator("script").count(), 2);
  const options = await page.locator("#robot-pose option").allTextContents();
  for (const name of hostileNames) assert.ok(options.includes(name), name);
  assert.equal(await page.locator("h1").textContent(), "</script><img src=x onerror=alert(3)>: calibration");
  assert.equal(await page.title(), "</script><img src=x onerror=alert(3)>: calibration");
});

/// A busy machine draws late, so the picture has half a minute to become another one.
async function changes(page, what, action) {
  const was = await page.locator("#robot-view").evaluate((canvas) => ({ frames: canvas.dataset.frames, picture: canvas.toDataURL() }));
  await action();
  const isAnother = ({ frames, picture }) => {
    const canvas = document.getElementById("robot-view");
    return canvas.dataset.frames !== frames && canvas.toDataURL() !== picture;
  };
  await page.waitForFunction(isAnother, was, { timeout: 30_000 }).catch(() => assert.fail(`${what}: the picture stays`));
}

of("calibration", "slider, poses, switches, mouse and keys move the robot", async (page) => {
  await page.locator("#robot").scrollIntoViewIfNeeded();
  await changes(page, "slider", () => page.locator("#robot-magnification").fill("3"));
  assert.match(await page.locator("output").textContent(), /^Errors × 1000$/);
  await changes(page, "pose", () => page.locator("#robot-pose").selectOption({ index: 5 }));
  await changes(page, "tilt", () => page.locator("#show-tilt").check());
  await changes(page, "switch", () => page.locator("#show-before").uncheck());
  await changes(page, "key", () => page.locator("#robot-view").press("ArrowLeft"));
  await changes(page, "zoom", () => page.locator("#robot-view").press("+"));
  const box = await page.locator("#robot-view").boundingBox();
  await changes(page, "mouse", async () => {
    await page.mouse.move(box.x + 300, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(box.x + 450, box.y + 230, { steps: 5 });
    await page.mouse.up();
  });
});

of("many", "orbiting with 200 poses: the rate that software WebGL reaches here", async (page) => {
  const { figures } = await dataOf(page);
  assert.ok(figures.scene.poses.length >= 200);
  await page.locator("#robot").scrollIntoViewIfNeeded();
  const rate = await page.locator("#robot-view").evaluate((canvas, time) => new Promise((done) => {
    const start = performance.now(), first = Number(canvas.dataset.frames);
    const turn = () => {
      canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true, cancelable: true }));
      const seconds = (performance.now() - start) / 1000;
      seconds < time ? requestAnimationFrame(turn) : done((Number(canvas.dataset.frames) - first) / seconds);
    };
    turn();
  }), kEvery ? 2 : 0.4);
  console.log(`${rate.toFixed(1)} frames a second, ${figures.scene.poses.length} poses`);
  assert.ok(rate > 0);
});

of("report", "prints on A4, light even from the dark page", async (page) => {
  await becomes(page, "dark");
  const pdf = await page.pdf({ preferCSSPageSize: true, printBackground: true });
  assert.equal(pdf.subarray(0, 5).toString(), "%PDF-");
  assert.match(pdf.toString("latin1"), /\/MediaBox \[0 0 59[45](\.\d+)? 84[12](\.\d+)?\]/);
  await page.emulateMedia({ media: "print", colorScheme: "dark" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
  await page.evaluate(() => dispatchEvent(new Event("afterprint")));
  await page.emulateMedia({ media: "screen" });
  await becomes(page, "light");
});

of("published", "the theme button changes page and robot", async (page) => {
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  const was = await background();
  await changes(page, "robot", () => page.locator("nav button").click());
  assert.notEqual(await background(), was);
});

async function checkOtherLoads(browser, file) {
  for (const [options, check] of [[{ colorScheme: "dark" }, checkRules], [{ viewport: kPhone }, checkWidth]]) {
    const { page, context } = await open(browser, file, options);
    await check(page);
    await context.close();
  }
}

test("pages of the program", async (t) => {
  t.after(() => rmSync(folder, { recursive: true }));
  pages = samples(resolve(process.env.PARACAL), folder, !kEvery);
  pages.nothing = changed(pages.yield, "nothing.html", withoutMachines);
  pages.large = changed(pages.calibration, "large.html", withManyPoints);
  for (const { kind } of checks) assert.ok(pages[kind], kind);
  const browser = await launch();
  t.after(() => browser.close());
  for (const [kind, file] of Object.entries(pages)) {
    await t.test(kind, async (t) => {
      assert.ok(statSync(file).size <= kLargestFile);
      const { page, context, complaints, requests } = await open(browser, file);
      if (kind !== "nothing") await t.test("draws every figure", () => checkMarks(page));
      await t.test("has no serious violation of accessibility rules, light and dark", () => checkAccessibility(page));
      for (const { name, check } of checks.filter((one) => one.kind === kind)) await t.test(name, () => check(page));
      await t.test("fits a phone without sideways scrolling", async () => {
        await page.setViewportSize(kPhone);
        await checkWidth(page);
      });
      await t.test("says nothing, asks for nothing", () => assert.deepEqual([complaints, requests], [[], []]));
      await context.close();
      if (kEvery) await t.test("the same loaded in the dark and on a phone", () => checkOtherLoads(browser, file));
    });
  }
});
