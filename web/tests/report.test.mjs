// The pages of the built program in a real browser: PARACAL=path/to/paracal node --test web/tests/
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { hostileNames, samples } from "../samples.mjs";
import { dataOf, launch, open } from "./browser.mjs";

const kLargestFile = 2.5e6; // bytes
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const folder = mkdtempSync(join(tmpdir(), "paracal-report-"));
let pages, browser;
before(async () => {
  pages = samples(resolve(process.env.PARACAL), folder);
  browser = await launch();
});
after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});

/// What a drawing holds of what its frame promises: marks of a plot, cells of a map.
const kMarks = {
  dots: ".drawing svg g[aria-label=dot] > *",
  bars: ".drawing svg g[aria-label=bar] > rect",
  rects: ".drawing svg g[aria-label=rect] > rect",
  cells: ".drawing svg g[aria-label=cell] > rect, .drawing svg .cell",
};
const kMarksOf = [
  [/^(residual|normal|validated|parameters|observability)/, "dots", 1],
  [/^(offsets|table|figure\d|tilt)/, "dots", 2], // paper and ours
  [/^(map|sigma|correlations)/, "cells", 1],
  [/^(pareto|global|allocated)/, "bars", 1],
  [/^(batch|machines)/, "rects", 1],
];

async function checkMarks(page) {
  const figures = await page.$$eval("figure[data-marks]", (all, selectors) => all.map((one) => ({ id: one.id, promised: Number(one.dataset.marks), drawn: Object.fromEntries(Object.entries(selectors).map(([kind, selector]) => [kind, one.querySelectorAll(selector).length])) })), kMarks);
  assert.ok(figures.length > 0);
  for (const { id, promised, drawn } of figures) {
    if (id === "robot-errors") continue; // drawn in three dimensions
    const [, kind, times] = kMarksOf.find(([pattern]) => pattern.test(id)) ?? assert.fail(`${id}: not in this test's list`);
    assert.ok(promised > 0, id);
    const beside = id === "global-sensitivity" ? drawn.dots : promised; // its largest values are dots
    assert.equal(beside, promised, id);
    assert.equal(drawn[kind], times * promised, `${id}: ${kind}`);
  }
}

const kinds = ["published", "calibration", "validation", "report", "hostile", "refused", "delta", "printer", "keep", "many", "sensitivity", "allocation", "analysis", "yield", "reproduction", "struts", "strutreport", "strutsensitivity", "strutallocation", "6-rss", "6-pss"];
for (const kind of kinds) {
  test(`${kind}: draws every figure, says nothing, asks for nothing`, async () => {
    assert.ok(statSync(pages[kind]).size <= kLargestFile);
    const { page, context, complaints, requests } = await open(browser, pages[kind]);
    await checkMarks(page);
    await page.waitForTimeout(300);
    assert.deepEqual(complaints, []);
    assert.deepEqual(requests, []);
    await context.close();
  });

  test(`${kind}: no serious violation of accessibility rules, light and dark`, async () => {
    for (const colorScheme of ["light", "dark"]) {
      const { page, context } = await open(browser, pages[kind], { colorScheme, bypassCSP: true });
      await page.evaluate(axe);
      const { violations } = await page.evaluate(() => window.axe.run());
      const serious = violations.filter(({ impact }) => impact === "serious" || impact === "critical");
      assert.deepEqual(serious.map(({ id, nodes }) => [colorScheme, id, ...nodes.slice(0, 3).map((node) => node.html.slice(0, 200))]), []);
      await context.close();
    }
  });
}

test("how soon the first figure stands", async () => {
  const { page, context } = await open(browser, pages.calibration);
  const times = [];
  for (let k = 0; k < 3; ++k) {
    await page.reload({ waitUntil: "commit" });
    times.push(await page.evaluate(() => new Promise((done) => {
      const look = () => (document.querySelector(".drawing svg, canvas[data-frames]") ? done(performance.now()) : requestAnimationFrame(look));
      look();
    })));
  }
  console.log(`first figure after ${times.map((time) => Math.round(time)).join(", ")} ms`); // told, not judged: the machine may be busy
  await context.close();
});

test("every published number stands with its verdict and reason, and the counts above", async () => {
  const { page, context } = await open(browser, pages.reproduction);
  const { rows, counts, rule } = (await dataOf(page)).results.reproduction;
  const shown = await page.locator("#published > .scroll tbody tr").evaluateAll((all) => all.map((row) => [...row.cells].map((cell) => cell.textContent)));
  assert.deepEqual(shown.map((cells) => [cells[0], ...cells.slice(-2)]), rows.map((row) => [row.quantity, row.verdict, row.reason]));
  const head = await page.locator("#verdict .verdict").first().textContent();
  assert.ok(head.includes(`${counts.reproduced} of ${rows.length} published numbers reproduced`), head);
  assert.ok(head.includes(`${counts.not_reproduced} are not reproduced and ${counts.cannot_be_tested} cannot be tested`), head);
  const text = await page.locator("#published").textContent();
  for (const sentence of rule) assert.ok(text.includes(sentence), sentence);
  await context.close();
});

/// What `yield` prints where it was stopped before the first machine.
function withoutMachines(report) {
  const { yield: batch } = report.results, nothing = (value) => (Array.isArray(value) ? value.map(nothing) : typeof value === "object" && value ? Object.fromEntries(Object.entries(value).map(([key, one]) => [key, nothing(one)])) : null);
  const none = { bin_width: 0, counts: [], total: 0 };
  Object.assign(batch, { machines: 0, produced: 0, partial: true, passed: 0, yield: { value: null, low: 0, high: 1, confidence: 0.95 }, dpmo: { value: null, low: 0, high: 1e6 }, quantities: nothing(batch.quantities) });
  for (const one of report.figures.largest_of_a_machine) Object.assign(one, { before: none, after: none });
  return report;
}

test("a batch that was stopped before its first machine says nothing of machines", async () => {
  const file = join(folder, "nothing.html");
  const data = /(<script[^>]*id="data"[^>]*>)(.*?)(<\/script>)/s;
  writeFileSync(file, readFileSync(pages.yield, "utf8").replace(data, (_, begin, json, end) => begin + JSON.stringify(withoutMachines(JSON.parse(json))) + end));
  const { page, context, complaints } = await open(browser, file);
  const cells = await page.locator("#machines table", { hasText: "99.73 %" }).last().locator("tbody tr").evaluateAll((rows) => rows.map((row) => [...row.cells].slice(2).map((cell) => cell.textContent)));
  assert.ok(cells.length >= 8);
  for (const cell of cells.flat()) assert.match(cell, /^\u2013( to \u2013)?$/);
  assert.deepEqual(await page.locator("#verdict .card").allTextContents(), []);
  assert.deepEqual(complaints, []);
  await context.close();
});

test("tolerances stand beside what they are on a drawing", async () => {
  for (const [kind, of] of [["allocation", { "rod_difference_mm": 0, "beta2_deg": 5 }], ["strutallocation", { "zero_mm": 0 }]]) {
    const { page, context } = await open(browser, pages[kind]);
    const { drawing } = (await dataOf(page)).results.allocation;
    const table = page.locator("#allocated-tolerances details");
    await table.locator("summary").click();
    await table.locator("tbody tr").first().waitFor();
    const said = await table.locator("tbody tr").evaluateAll((all) => all.map((row) => row.cells[2].textContent));
    for (const [key, row] of Object.entries(of)) assert.equal(said[row], drawing[key].text);
    assert.ok(said.every((text) => text.length > 10), said);
    await context.close();
  }
});

test("numbers in the page are those of the JSON", async () => {
  const { page, context } = await open(browser, pages.calibration);
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
  const inUse = Number(cards[0].match(/\u00b1\s*([\d.]+)/)[1]); // U in use comes first, to two digits
  assert.ok(cards[0].startsWith("In use") && Math.abs(inUse - printed.use.distance_mm.U) <= 0.051 * printed.use.distance_mm.U, cards[0]);
  const [from, to] = cards.find((text) => text.startsWith("Residuals of distances")).match(/[\d.]+/g).map(Number);
  assert.ok(Math.abs(from - printed.before.max_abs_distance_mm) < 0.051 && Math.abs(to - printed.after.max_abs_distance_mm) < 0.051, cards.join());
  assert.equal(await page.locator(".verdict").count(), 1);
  for (const one of printed.assumed) assert.ok((await page.locator(".notes").allTextContents()).join().includes(one), one);
  await context.close();
});

test("a reading that contradicts the others is named and left out", async () => {
  const { page, context } = await open(browser, pages.calibration);
  const { results } = await dataOf(page);
  const [worst] = results.calibration.suspects;
  assert.ok(worst.excluded);
  const row = await page.locator("#residuals table tbody tr").first().allTextContents();
  assert.ok(row[0].startsWith(worst.reading) && row[0].endsWith("left out"), row[0]);
  await context.close();
});

test("an owner of a printer is not told what only makers of robots need", async () => {
  for (const kind of ["printer", "keep"]) {
    const { page, context } = await open(browser, pages[kind]);
    for (const id of ["poses-needed", "correlations"]) assert.equal(await page.$(`#${id}`), null, `${kind}: ${id}`);
    assert.notEqual(await page.$("#printer"), null);
    await context.close();
  }
});

test("what was assumed is noted, and without limits nothing is said to keep them", async () => {
  const limited = await open(browser, pages.yield), unlimited = await open(browser, pages.unlimited);
  const { results } = await dataOf(unlimited.page);
  assert.ok(results.yield.assumed[0].includes("theta_offset"));
  for (const { page } of [limited, unlimited]) assert.ok((await page.locator(".notes").textContent()).includes(results.yield.assumed[0]));
  const header = (page) => page.locator("#verdict").textContent();
  assert.match(await header(limited.page), /Machines within the limits: \d+ of 300/);
  assert.doesNotMatch(await header(unlimited.page), /within the limits|null/);
  for (const { context } of [limited, unlimited]) await context.close();
});

test("poses of a body show how far it is turned", async () => {
  const { page, context } = await open(browser, pages.bodies);
  const { results } = await dataOf(page);
  const verdict = await page.locator("#verdict").textContent();
  assert.match(verdict, /Residuals of a body's orientation, largest/);
  assert.ok(results.calibration.after.max_orientation_deg > 0);
  await context.close();
});

test("a calibration that was refused says so first, and why", async () => {
  const { page, context } = await open(browser, pages.refused);
  const { results } = await dataOf(page);
  const verdict = page.locator(".verdict.no");
  assert.match(await verdict.locator("strong").textContent(), new RegExp(results.calibration.verdict));
  for (const reason of results.calibration.reasons) assert.ok((await verdict.textContent()).includes(reason));
  assert.equal(await page.locator("#where").count(), 0);
  await context.close();
});

test("each figure gives its data as CSV, and text that a spreadsheet would run is harmless", async () => {
  const { page, context } = await open(browser, pages.hostile);
  const { results } = await dataOf(page);
  const download = page.waitForEvent("download");
  await page.locator("#residual-sizes button").click();
  const file = await download;
  assert.equal(file.suggestedFilename(), "residual-sizes.csv");
  const lines = readFileSync(await file.path(), "utf8").trim().split("\n");
  assert.equal(lines[0], "name,before_mm,after_mm");
  assert.equal(lines.length, 1 + results.calibration.residuals.length);
  assert.ok(lines.some((line) => line.startsWith("'=HYPERLINK(1),")), lines.join("\n"));
  await context.close();
});

test("names stay text whatever they hold", async () => {
  const { page, context, complaints } = await open(browser, pages.hostile);
  assert.deepEqual(await page.locator("img").count(), 0);
  assert.deepEqual(await page.locator("script").count(), 2);
  const options = await page.locator("#robot-pose option").allTextContents();
  for (const name of hostileNames) assert.ok(options.includes(name), name);
  assert.equal(await page.locator("h1").textContent(), "</script><img src=x onerror=alert(3)>: calibration");
  assert.equal(await page.title(), "</script><img src=x onerror=alert(3)>: calibration");
  assert.deepEqual(complaints, []);
  await context.close();
});

/// The picture in the canvas as a data address.
const picture = (page) => page.locator("#robot-view").evaluate((canvas) => canvas.toDataURL());

/// A busy machine draws late, so the picture has half a minute to become another one.
async function changes(page, what, action) {
  const was = await picture(page);
  await action();
  for (let wait = 0; wait < 30_000 && (await picture(page)) === was; wait += 100) await page.waitForTimeout(100);
  assert.notEqual(await picture(page), was, what);
}

test("slider, poses, switches, mouse and keys move the robot", async () => {
  const { page, context, complaints } = await open(browser, pages.calibration);
  await page.locator("#robot").scrollIntoViewIfNeeded();
  await page.waitForTimeout(500);
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
  assert.deepEqual(complaints, []);
  await context.close();
});

test("orbiting with 200 poses: the rate that software WebGL reaches here", async () => {
  const { page, context } = await open(browser, pages.many);
  const { figures } = await dataOf(page);
  assert.ok(figures.scene.poses.length >= 200);
  await page.locator("#robot").scrollIntoViewIfNeeded();
  await page.waitForTimeout(500);
  const rate = await page.locator("#robot-view").evaluate((canvas) => new Promise((done) => {
    const start = performance.now(), first = Number(canvas.dataset.frames);
    const turn = () => {
      canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true, cancelable: true }));
      const seconds = (performance.now() - start) / 1000;
      seconds < 2 ? requestAnimationFrame(turn) : done((Number(canvas.dataset.frames) - first) / seconds);
    };
    turn();
  }));
  console.log(`${rate.toFixed(1)} frames a second, ${figures.scene.poses.length} poses`);
  assert.ok(rate > 0);
  await context.close();
});

test("prints on A4, light even from the dark page", async () => {
  const { page, context } = await open(browser, pages.report, { colorScheme: "dark" });
  const pdf = await page.pdf({ preferCSSPageSize: true, printBackground: true });
  assert.equal(pdf.subarray(0, 5).toString(), "%PDF-");
  assert.match(pdf.toString("latin1"), /\/MediaBox \[0 0 59[45](\.\d+)? 84[12](\.\d+)?\]/);
  await page.emulateMedia({ media: "print" });
  await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
  assert.equal(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), "rgb(255, 255, 255)");
  await context.close();
});

test("fits a phone without sideways scrolling", async () => {
  for (const kind of kinds) {
    const { page, context } = await open(browser, pages[kind], { viewport: { width: 360, height: 740 } });
    const [content, screen] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(content <= screen, `${kind}: ${content} px on ${screen}`);
    await context.close();
  }
});

test("the theme button changes page and robot", async () => {
  const { page, context } = await open(browser, pages.published);
  const background = () => page.evaluate(() => getComputedStyle(document.body).backgroundColor);
  await page.waitForTimeout(300);
  const was = await background();
  await changes(page, "robot", () => page.locator("nav button").click());
  assert.notEqual(await background(), was);
  await context.close();
});
