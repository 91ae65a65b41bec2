// How many points a circle a calibration needs [huang2016, Figs. 7, 8].
import { dot, line, ruleX } from "@observablehq/plot";
import type { Curve, Report } from "../data";
import { h } from "../dom";
import { figure } from "../figure";
import { draw } from "../plot";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.observability;

/// The largest relative change after n.
const laterChange = ({ n, curve }: Curve) => Math.max(0, ...curve.filter((point) => point.n > n).map((point) => point.change));

function curveFigure(id: string, title: string, both: Curve): HTMLElement {
  const { n, curve } = both;
  return figure({
    id,
    title,
    shows: text.shows(n, laterChange(both)),
    marks: curve.length,
    sheet: { columns: ["n", "O2", "relative_change"], rows: curve.map((point) => [point.n, point.O2, point.change]) },
    draw: (width) =>
      draw({
        width,
        height: 260,
        x: { label: text.n, ticks: curve.map((point) => point.n), tickFormat: "d" },
        y: { label: text.O2, grid: true, ticks: 5, zero: true },
        insetLeft: 8,
        insetRight: 8,
        marks: [
          ...(n > 0 ? [ruleX([n], { stroke: "var(--muted)", strokeDasharray: "4 4" })] : []),
          line(curve, { x: "n", y: "O2", stroke: "var(--after)" }),
          dot(curve, { x: "n", y: "O2", r: 3.5, fill: (point: { n: number }) => (point.n === n ? "var(--before)" : "var(--after)") }),
        ],
      }),
  });
}

export function observability({ figures }: Report): Section | null {
  const both = figures.observability;
  if (!both) return null;
  return section("poses-needed", strings.nav.observability, text.heading, null,
    h("div", { class: "pair" }, curveFigure("observability-rough", text.rough, both.rough), curveFigure("observability-fine", text.fine, both.fine)));
}
