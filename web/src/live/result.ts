// What a command gave: its verdict first, as the report has it, then what the program says, then files to keep.
import type { Report } from "../data";
import { h } from "../dom";
import { verdict } from "../sections/verdict";
import { kReport } from "./kinds";
import { button, save } from "./parts";
import type { Result } from "./program";
import { strings } from "./strings";
import { join } from "./words";

/// The data of a page that the program has written.
function reportIn(page: Uint8Array): Report | null {
  const parsed = new DOMParser().parseFromString(new TextDecoder().decode(page), "text/html");
  const data = parsed.getElementById("data")?.textContent;
  return data ? (JSON.parse(data) as Report) : null;
}

const isJson = (text: string) => text.startsWith("{");

export const endOf = ({ words, code, milliseconds }: Result): string =>
  strings.status(`paracal ${words[0] ?? ""}`, strings.ended[code] ?? strings.unknownEnd(code), milliseconds);

/// The report within the page, and its switch.
function reportView(page: Uint8Array): [HTMLElement, HTMLElement] {
  const place = h("div", {});
  const press = button(strings.showReport, () => {
    const open = place.childElementCount > 0;
    const address = URL.createObjectURL(new Blob([page as BlobPart], { type: "text/html" }));
    place.replaceChildren(...(open ? [] : [h("iframe", { src: address, title: strings.reportFrame })]));
    press.textContent = open ? strings.showReport : strings.hideReport;
    press.setAttribute("aria-expanded", String(!open));
  }, { "aria-expanded": "false" });
  return [press, place];
}

export function show(result: Result): Node[] {
  const { stdout, stderr, files, words } = result;
  const page = files[kReport], report = page ? reportIn(page) : null;
  const [press, place] = page && report ? reportView(page) : [null, null];
  const others = Object.entries(files).filter(([name]) => name !== kReport);
  const said = stderr.trim();
  return [
    ...(report ? [verdict(report)] : []),
    ...(said ? [h("h3", {}, strings.messages), h("pre", { class: "said errors", tabindex: "0", "aria-label": strings.messages }, said)] : []),
    h("div", { class: "row" },
      isJson(stdout) ? button(strings.saveJson, () => save(`${words[0]}.json`, stdout, "application/json")) : null,
      page ? button(strings.saveReport, () => save(kReport, page, "text/html")) : null, press,
      ...others.map(([name, data]) => button(strings.saveFile(name), () => save(name, data)))),
    ...(place ? [place] : []),
    ...(stdout.trim() ? [h("details", report ? {} : { open: "" }, h("summary", {}, strings.output), h("pre", { class: "said", tabindex: "0", "aria-label": strings.output }, stdout.trim()))] : []),
    h("p", { class: "muted" }, h("code", {}, `paracal ${join(words)}`)),
  ];
}
