// Every published number beside ours.
import { dot, ruleY } from "@observablehq/plot";
import type { Report, Row } from "../data";
import { h, table } from "../dom";
import { figure, legend } from "../figure";
import { decimalsFor, digits, fixed } from "../numbers";
import { draw } from "../plot";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.rows;

/// How many words all names begin with.
function commonWords(names: string[][]): number {
  const first = names[0]!;
  let count = 0;
  while (names.length > 1 && names.every((words) => words.length > count + 1 && words[count] === first[count])) ++count;
  return count;
}

/// Names without what all of them begin and end with: that is said once, by the title.
function shortened(names: string[]): string[] {
  const words = names.map((name) => name.split(" "));
  const start = commonWords(words), end = commonWords(words.map((one) => one.slice(start).reverse()));
  return words.map((one) => one.slice(start, one.length - end).join(" ").replace(/,$/, ""));
}

const kShares = ["figure9", "tilt"]; // no tolerance reaches beyond 1

/// The paper's number with the tolerance around it, ours on it; one panel a unit, for mm and deg share no axis.
function groupFigure(id: string, title: string, rows: Row[]): HTMLElement[] {
  const units = [...new Set(rows.map((row) => row.unit))];
  return units.map((unit) => {
    const own = rows.filter((row) => row.unit === unit).map((row) => ({ ...row, from: row.paper - row.tolerance, to: Math.min(row.paper + row.tolerance, kShares.includes(id) ? 1 : Infinity) }));
    const names = shortened(own.map((row) => row.quantity));
    return figure({
      id: `${id.replaceAll(".", "-")}-${unit.replaceAll(/[^a-z]/gi, "")}`,
      title: units.length > 1 ? `${title}, ${unit}` : title,
      shows: text.shows(own.filter((row) => row.ok).length, own.length),
      marks: own.length,
      sheet: { columns: text.columns, rows: own.map((row) => [row.quantity, row.unit, row.paper, row.ours, row.ours - row.paper, row.tolerance, row.verdict, row.reason]) },
      draw: (width) => {
        const labels = Math.min(260, width * 0.5);
        const short = (name: string) => (name.length * 6.6 > labels ? `${name.slice(0, Math.floor(labels / 6.6) - 1)}\u2026` : name);
        return [
          legend([{ text: text.paper, kind: "paper" }, { text: text.ours, kind: "after" }, { text: text.tolerance, kind: "prior" }]),
          draw({
            width,
            height: 60 + 19 * own.length,
            marginLeft: labels,
            marginTop: 8,
            marginRight: 24,
            x: { label: text.axes[id] ?? unit, grid: true, nice: true, ticks: Math.max(2, Math.floor((width - labels) / 70)) },
            y: { label: null, domain: own.map((row) => row.id), tickSize: 0, tickFormat: (key: string) => short(names[own.findIndex((row) => row.id === key)]!) },
            marks: [
              ruleY(own, { y: "id", x1: "from", x2: "to", stroke: "var(--prior)", strokeWidth: 11 }),
              dot(own, { y: "id", x: "paper", r: 5, stroke: "var(--before)", strokeWidth: 1.5 }),
              dot(own, { y: "id", x: "ours", r: 3, fill: "var(--after)" }),
            ],
          }),
        ];
      },
    });
  });
}

const verdictOf = (row: Row) => (row.verdict === "not reproduced" ? h("span", { class: "differs" }, row.verdict) : row.verdict);

export function publishedRows({ results }: Report): Section | null {
  if (!results.reproduction) return null;
  const { rows, rule } = results.reproduction;
  const figures = text.drawn.flatMap((prefix) => {
    const own = rows.filter((row) => row.id.startsWith(prefix));
    return own.length > 0 ? groupFigure(prefix, own[0]!.table, own) : [];
  });
  const number = (row: Row, value: number) => (row.tolerance > 0 ? fixed(value, decimalsFor(row.tolerance)) : digits(value));
  const tables = [...new Set(rows.map((row) => row.table))].flatMap((name) => {
    const cells = rows.filter((row) => row.table === name).map((row) => [row.quantity, row.unit, number(row, row.paper), number(row, row.ours), number(row, row.ours - row.paper), number(row, row.tolerance), verdictOf(row), row.reason]);
    return [h("h4", {}, name), table(text.columns, cells, name, [2, 3, 4, 5])];
  });
  return section("published", strings.nav.rows, text.heading, text.intro,
    h("ul", {}, ...rule.map((sentence) => h("li", {}, sentence))),
    h("div", { class: "pair" }, ...figures),
    h("h3", {}, text.all), ...tables);
}
