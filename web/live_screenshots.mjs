// Pictures of the live page for docs/live-page.md: node live_screenshots.mjs BUILD [FOLDER]. Look at them before they are committed.
import { mkdirSync } from "node:fs";
import { join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { launch, open } from "./tests/browser.mjs";

const [build, folder = fileURLToPath(new URL("../docs/figures/live", import.meta.url))] = process.argv.slice(2);
const wide = { viewport: { width: 1100, height: 800 }, deviceScaleFactor: 0.6 };
const views = {
  printer: wide,
  "printer-dark": { ...wide, colorScheme: "dark" },
  "printer-phone": { viewport: { width: 380, height: 740 }, deviceScaleFactor: 0.8 },
};

mkdirSync(folder, { recursive: true });
const browser = await launch();
try {
  for (const [name, view] of Object.entries(views)) {
    const { page, context } = await open(browser, resolve(build, "paracal-live.html"), view);
    await page.waitForFunction(() => /ready/.test(document.getElementById("status").textContent));
    await page.locator("#load-sample").click();
    await page.locator("#result .verdict").waitFor();
    await page.waitForFunction(() => [...document.querySelectorAll(".answer")].every((one) => one.getAttribute("aria-busy") === "false"));
    await page.screenshot({ type: "jpeg", quality: 55, fullPage: true, path: join(folder, `${name}.jpg`) });
    await context.close();
  }
} finally {
  await browser.close();
}
