// Which estimates go together.
import { cell, legend } from "@observablehq/plot";
import type { Report } from "../data";
import { h, table } from "../dom";
import { figure } from "../figure";
import { digits, fixed } from "../numbers";
import { draw } from "../plot";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.correlations;
const kMostPairs = 12;

interface Pair {
  one: string;
  other: string;
  value: number;
}

/// Below the diagonal, from a covariance in the order of the parameters.
function pairsOf(names: string[], covariance: number[][]): Pair[] {
  return names.flatMap((one, i) => names.slice(0, i).map((other, k) => ({ one, other, value: covariance[i]![k]! / Math.sqrt(covariance[i]![i]! * covariance[k]![k]!) })));
}

export function correlations({ results }: Report): Section | null {
  const { calibration } = results;
  if (!calibration?.covariance || calibration.covariance.length < 2 || calibration.printer) return null; // for robot makers
  const sought = calibration.parameters.filter((one) => one.status !== "fixed");
  const names = sought.map((one) => strings.parameters.limb(one.name, one.limb));
  const pairs = pairsOf(names, calibration.covariance);
  const strong = pairs.filter((pair) => Math.abs(pair.value) >= 0.9).sort((one, other) => Math.abs(other.value) - Math.abs(one.value));
  const labels = names.length <= 28; // else the limbs alone
  const limbs = [...new Set(sought.map((one) => one.limb))].map((limb) => {
    const own = names.filter((_, k) => sought[k]!.limb === limb);
    return { first: own[0]!, second: own[1] ?? own[0]! };
  });
  const limbOf = (name: string) => text.limb(sought[names.indexOf(name)]!.limb);
  return section("correlations", strings.nav.correlations, text.heading, null,
    h("div", { class: "pair" }, figure({
      id: "correlations-matrix",
      title: text.title,
      shows: text.shows(strong.length),
      marks: pairs.length,
      sheet: { columns: text.columns, rows: pairs.map((pair) => [pair.one, pair.other, pair.value]) },
      draw: (width) => {
        const side = Math.min(width - 150, labels ? 34 * names.length + 40 : 520);
        const color = { type: "diverging", scheme: "PuOr", domain: [-1, 1], label: text.axis } as const;
        return [
          legend({ color, width: Math.min(width, 300), marginLeft: 18, marginRight: 18, ticks: 5, style: { background: "transparent" } }),
          draw({
            width: side + 150,
            height: side + (labels ? 130 : 50),
            marginLeft: labels ? 140 : 60,
            marginTop: 8,
            marginBottom: labels ? 120 : 34,
            padding: labels ? 0.05 : 0,
            x: { domain: names.slice(0, -1), label: null, tickSize: 0, tickRotate: labels ? -60 : 0, ...(labels ? {} : { ticks: limbs.slice(0, -1).map(({ first }) => first), tickFormat: limbOf, textAnchor: "start" }) },
            y: { domain: names.slice(1), label: null, tickSize: 0, ...(labels ? {} : { ticks: limbs.map(({ second }) => second), tickFormat: limbOf }) },
            color,
            marks: [cell(pairs, { x: "other", y: "one", fill: "value", title: (pair: Pair) => text.pair(pair.one, pair.other, digits(pair.value, 2)) })],
          }),
        ];
      },
    }),
    strong.length > 0 ? h("div", { class: "beside" }, h("h3", {}, text.strongest), table(text.columns, strong.slice(0, kMostPairs).map((pair) => [pair.one, pair.other, fixed(pair.value, 3)]), text.strongest, [2])) : null));
}
