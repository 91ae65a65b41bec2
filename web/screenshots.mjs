// Pictures of every page for docs/report.md: node screenshots.mjs PROGRAM [FOLDER]. Look at them before they are committed.
import { mkdirSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { samples } from "./samples.mjs";
import { launch, open } from "./tests/browser.mjs";

const [program, folder = fileURLToPath(new URL("../docs/figures/report", import.meta.url))] = process.argv.slice(2);
const temporary = mkdtempSync(join(tmpdir(), "paracal-screenshots-"));
const kSmall = { type: "jpeg", quality: 55, fullPage: true };
const wide = { viewport: { width: 1100, height: 800 }, deviceScaleFactor: 0.6 };
const views = {
  report: wide,
  "report-dark": { ...wide, colorScheme: "dark" },
  "report-phone": { viewport: { width: 380, height: 740 }, deviceScaleFactor: 0.8 },
  "report-print": { viewport: { width: 690, height: 980 }, deviceScaleFactor: 0.8 }, // A4 within its margins
  published: wide,
  calibration: wide,
  validation: wide,
  printer: wide,
  sensitivity: wide,
  allocation: wide,
  analysis: wide,
  yield: wide,
  reproduction: wide,
};

mkdirSync(folder, { recursive: true });
const browser = await launch();
try {
  const pages = samples(resolve(program), temporary);
  for (const [name, view] of Object.entries(views)) {
    const { page, context } = await open(browser, pages[name.replace(/-.*/, "")], view);
    if (name.endsWith("print")) {
      await page.emulateMedia({ media: "print" });
      await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    }
    await page.waitForTimeout(1000); // the robot and figures of a new width
    await page.screenshot({ ...kSmall, path: join(folder, `${name}.jpg`) });
    await context.close();
  }
  const { page } = await open(browser, pages.report, { viewport: { width: 1200, height: 1640 }, deviceScaleFactor: 0.65 });
  await page.evaluate(() => { document.querySelector("header details")?.removeAttribute("open"); });
  await page.waitForTimeout(1000);
  await page.screenshot({ path: join(folder, "top.png") });
} finally {
  await browser.close();
  rmSync(temporary, { recursive: true });
}
