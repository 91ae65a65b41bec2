// The source errors with what was known of them before.
import { dot, ruleX, ruleY } from "@observablehq/plot";
import type { Cell } from "../csv";
import type { Parameter, Report } from "../data";
import { h } from "../dom";
import { figure, legend } from "../figure";
import { decimalsFor, fixed } from "../numbers";
import { draw } from "../plot";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.parameters;

/// As far as the estimates reach; priors beyond are cut off.
function reach(parameters: Parameter[]): number {
  return 1.1 * Math.max(...parameters.map(({ value, U }) => Math.abs(value) + (U ?? 0)), 1e-12);
}

/// Value and both uncertainties to two digits of U.
function roundedToU([name, limb, value, U, priorU, unit, status, share]: Cell[]): string[] {
  const decimals = decimalsFor(U as number);
  const number = (cell: Cell | undefined) => (typeof cell === "number" ? fixed(cell, decimals) : "");
  return [String(name), String(limb), number(value), number(U), number(priorU), String(unit), String(status), fixed(share as number, 3)];
}

function unitFigure(unit: string, parameters: Parameter[]): HTMLElement {
  const edge = reach(parameters);
  const clamp = (value: number) => Math.max(-edge, Math.min(edge, value));
  const rows = parameters.map((one) => ({
    name: text.limb(one.name, one.limb),
    value: one.value,
    from: clamp(one.value - (one.U ?? 0)),
    to: clamp(one.value + (one.U ?? 0)),
    identified: one.status === "identified",
    priorFrom: one.prior_std === null ? null : clamp(one.expected - 2 * one.prior_std),
    priorTo: one.prior_std === null ? null : clamp(one.expected + 2 * one.prior_std),
  }));
  return figure({
    id: `parameters-${unit.replace("/", "-per-")}`,
    title: text.title(unit),
    shows: text.shows(rows.length, rows.filter((row) => row.identified).length),
    marks: rows.length,
    sheet: { columns: text.columns, rows: parameters.map((one) => [one.name, one.limb, one.value, one.U, one.prior_std === null ? null : 2 * one.prior_std, one.unit, one.status, one.data_share]) },
    print: roundedToU,
    draw: (width) => [
      legend([{ text: text.estimate, kind: "after" }, { text: text.prior, kind: "prior" }]),
      draw({
        width,
        height: 60 + 17 * rows.length,
        marginLeft: 158,
        marginTop: 8,
        x: { label: text.axis(unit), domain: [-edge, edge], grid: true, ticks: Math.floor(width / 110) },
        y: { label: null, domain: rows.map((row) => row.name), tickSize: 0 },
        marks: [
          ruleY(rows.filter((row) => row.priorFrom !== null), { y: "name", x1: "priorFrom", x2: "priorTo", stroke: "var(--prior)", strokeWidth: 11 }),
          ruleX([0], { stroke: "var(--muted)" }),
          ruleY(rows, { y: "name", x1: "from", x2: "to", stroke: "var(--after)", strokeWidth: 2 }),
          dot(rows, { y: "name", x: "value", r: 3.5, fill: (row: { identified: boolean }) => (row.identified ? "var(--after)" : "var(--bg)"), stroke: "var(--after)" }),
        ],
      }),
    ],
  });
}

export function parameters({ results }: Report): Section | null {
  const sought = results.calibration?.parameters.filter((one) => one.status !== "fixed") ?? [];
  if (sought.length === 0) return null;
  const units = [...new Set(sought.map((one) => one.unit))];
  return section("parameters", strings.nav.parameters, text.heading, text.intro,
    h("div", { class: "pair" }, ...units.map((unit) => unitFigure(unit, sought.filter((one) => one.unit === unit)))));
}
