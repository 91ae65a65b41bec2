// Machines drawn from tolerances: what customers get.
import { rectY, ruleX, ruleY } from "@observablehq/plot";
import type { BeforeAndAfter, Bins, Report } from "../data";
import { h, table } from "../dom";
import { figure } from "../figure";
import { digits, milli } from "../numbers";
import { draw } from "../plot";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.batch;

interface Histogram {
  id: string;
  title: string;
  axis: string; ///< with its unit
  bins: Bins;
  limit: number | null;
  fill: string;
}

const scaled = (bins: Bins, scale: number): Bins => ({ ...bins, bin_width: scale * bins.bin_width });

function histogram({ id, title, axis, bins, limit, fill }: Histogram): HTMLElement {
  const rows = bins.counts.map((count, k) => ({ from: k * bins.bin_width, to: (k + 1) * bins.bin_width, count }));
  const drawn = rows.filter((row) => row.count > 0);
  return figure({
    id,
    title,
    shows: text.shows(String(bins.total), limit === null ? null : digits(limit)),
    marks: drawn.length,
    sheet: { columns: ["from", "to", "machines"], rows: rows.map((row) => [row.from, row.to, row.count]) },
    draw: (width) =>
      draw({
        width,
        height: 220,
        x: { label: axis, ticks: Math.floor(width / 80) },
        y: { label: text.count, grid: true, ticks: 4, tickFormat: "d" },
        insetRight: 8,
        marks: [rectY(drawn, { x1: "from", x2: "to", y: "count", fill, inset: 0.5 }), ruleY([0]), ...(limit === null ? [] : [ruleX([limit], { stroke: "currentColor", strokeWidth: 2 })])],
      }),
  });
}

function percentiles(report: Report): HTMLElement | null {
  const { quantities } = report.results.yield!;
  const rows = (Object.entries(quantities) as [string, BeforeAndAfter | null][]).flatMap(([name, both]) => {
    if (!both) return [];
    const cut = name.lastIndexOf("_");
    return (["before", "after"] as const).map((when) => {
      const spread = both[when];
      const { scale, unit } = milli(name.slice(cut + 1)), number = (value: number | null) => digits(value === null ? null : scale * value);
      return [`${text.quantities[name.slice(0, cut)] ?? name}, ${unit}`, when, ...[spread.p50, spread.p90, spread.p95].map(number), spread.p95_interval.map(number).join(" to "), ...[spread.p99, spread.p99_73].map(number)];
    });
  });
  return h("div", {}, h("h3", {}, text.percentiles), table(text.percentilesColumns, rows, text.percentiles, [2, 3, 4, 5, 6, 7]));
}

function ofYield(report: Report): HTMLElement[] {
  return (report.figures.largest_of_a_machine ?? []).flatMap((one, k) => {
    const [name, unit] = one.quantity.split(", ") as [string, string];
    const shown = milli(unit), axis = `${name}, ${shown.unit}`;
    return [
      histogram({ axis, id: `batch-${k}-before`, title: `${text.histogram(name)}, ${text.before}`, bins: scaled(one.before, shown.scale), limit: null, fill: "var(--before)" }),
      histogram({ axis, id: `batch-${k}-after`, title: `${text.histogram(name)}, ${text.after}`, bins: scaled(one.after, shown.scale), limit: one.limit === undefined ? null : shown.scale * one.limit, fill: "var(--after)" }),
    ];
  });
}

function ofAnalysis(report: Report): HTMLElement[] {
  return (report.figures.largest_on_a_machine ?? []).map((one, k) => {
    const { scale, unit } = milli(one.unit);
    return histogram({ id: `machines-${k}`, title: text.histogram(one.quantity), axis: `${one.quantity}, ${unit}`, bins: scaled(one.machines, scale), limit: scale * one.limit, fill: "var(--after)" });
  });
}

export function batch(report: Report): Section | null {
  const figures = [...ofYield(report), ...ofAnalysis(report)];
  if (figures.length === 0) return null;
  const { yield: made } = report.results;
  return section("machines", strings.nav.batch, text.heading, null,
    h("div", { class: "pair" }, ...figures),
    made ? percentiles(report) : null,
    made ? h("div", {}, h("h3", {}, text.fates), table(text.fatesColumns, Object.entries(made.fates).map(([fate, n]) => [fate.replaceAll("_", " "), String(n)]), text.fates, [1])) : null);
}
