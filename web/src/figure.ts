// The frame of every figure: what it is, what it shows, the drawing, and its data.
import { download, type Cell, type Sheet } from "./csv";
import { h, table } from "./dom";
import { digits } from "./numbers";
import { strings } from "./strings";

export interface Figure {
  id: string;
  title: string;
  shows: string; ///< a sentence for everybody, also for those who do not see the drawing
  marks: number; ///< how many values the drawing holds; the tests count them
  sheet: Sheet;
  print?: (row: Cell[]) => string[]; ///< a row of the table for readers; four digits without it
  draw: (width: number) => Element | Element[];
}

const kMostRows = 200;

/// Drawn when it comes near the screen and again when its width changes.
function keepDrawn(place: HTMLElement, draw: (width: number) => Element | Element[]): void {
  let drawn = 0;
  new ResizeObserver(() => {
    const width = Math.floor(place.clientWidth);
    if (width === drawn || width === 0) return;
    drawn = width;
    const drawing = draw(width);
    place.replaceChildren(...(Array.isArray(drawing) ? drawing : [drawing]));
  }).observe(place);
}

function dataTable(figure: Figure): HTMLElement {
  const { columns, rows } = figure.sheet;
  const numeric = columns.flatMap((_, k) => (rows.some((row) => typeof row[k] === "number") ? [k] : []));
  const print = figure.print ?? ((row: Cell[]) => row.map((cell) => (typeof cell === "number" ? digits(cell, 4) : (cell ?? ""))));
  const shown = rows.slice(0, kMostRows).map(print);
  const rest = rows.length - shown.length;
  return h("div", {}, table(columns, shown, figure.title, numeric), rest > 0 ? h("p", {}, strings.figure.more(rest)) : null);
}

export function figure(one: Figure): HTMLElement {
  const place = h("div", { class: "drawing", role: "img", "aria-label": `${one.title}. ${one.shows}` });
  keepDrawn(place, one.draw);
  const details = h("details", {}, h("summary", {}, strings.figure.table));
  details.addEventListener("toggle", () => {
    if (details.open && details.children.length === 1) details.append(dataTable(one));
  });
  const csv = h("button", { type: "button", "aria-label": strings.figure.download(one.title) }, strings.figure.csv);
  csv.addEventListener("click", () => download(one.id, one.sheet));
  return h("figure", { id: one.id, "data-marks": String(one.marks) },
    h("figcaption", {}, h("h3", {}, one.title), h("p", {}, one.shows)),
    place,
    h("div", { class: "tools" }, csv, details));
}

/// Names of colours for those who read a legend.
export function legend(entries: { text: string; kind: string }[]): HTMLElement {
  return h("ul", { class: "legend" }, ...entries.map(({ text, kind }) => h("li", {}, h("span", { class: `swatch ${kind}`, "aria-hidden": "true" }), text)));
}
