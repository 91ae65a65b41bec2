// What tests of the page share: a browser that notes everything that must not happen.
import { chromium } from "playwright-core";

export const launch = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-dev-shm-usage"] });

/// WebGL in software tells of its slowness; that is not the page's doing.
const harmless = /GL Driver Message|Automatic fallback to software WebGL|GroupMarkerNotSet/;

/// Waits until every figure and the robot are drawn.
export const isDrawn = (page) => page.waitForFunction(() => [...document.querySelectorAll(".drawing")].every((one) => one.childElementCount > 0) && [...document.querySelectorAll("#robot-view")].every((one) => one.dataset.frames));

/// A page with its complaints: console messages, exceptions, dialogs, and requests for anything but the file itself.
export async function open(browser, file, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 900 }, ...options });
  context.setDefaultTimeout(120_000); // ms; a machine may be busy
  const page = await context.newPage();
  const complaints = [], requests = [];
  page.on("console", (message) => { if (!harmless.test(message.text())) complaints.push(`${message.type()}: ${message.text()}`); });
  page.on("pageerror", (error) => complaints.push(error.message));
  page.on("dialog", (dialog) => { complaints.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
  page.on("request", (request) => { if (request.url() !== `file://${file}` && !request.url().startsWith("blob:")) requests.push(request.url()); });
  await page.goto(`file://${file}`);
  await isDrawn(page);
  return { page, context, complaints, requests };
}

export const dataOf = (page) => page.evaluate(() => JSON.parse(document.getElementById("data").textContent));
