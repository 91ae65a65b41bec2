// What all plots have in common.
import { dot, line, plot, type Markish, type PlotOptions, type ScaleOptions } from "@observablehq/plot";

/// Axes name their quantity and unit at their middle; dots keep off the frame.
export function draw({ x, y, ...options }: PlotOptions & { x: ScaleOptions; y: ScaleOptions }): Element {
  const drawing = plot({
    style: { background: "transparent", color: "var(--ink)", fontSize: "12px" },
    marginLeft: 60,
    marginBottom: 48,
    marginTop: 24,
    x: { labelAnchor: "center", labelOffset: 38, labelArrow: "none", ...x },
    y: { labelArrow: "none", ...y },
    ...options,
  });
  drawing.setAttribute("aria-hidden", "true"); // its frame says what it shows
  return drawing;
}

const kMostDots = 1000; // elements of a page cost memory and time: more points are one path

interface Dots {
  x: string;
  y: string;
  colour: string;
  size: number; ///< px across
  symbol: "circle" | "square";
  opacity?: number;
}

/// Points of a plot: an element each, or all of them in one path, whose lines of no length end in round or square caps.
export function dots<Point extends object>(points: Point[], { x, y, colour, size, symbol, opacity = 1 }: Dots): Markish {
  if (points.length <= kMostDots) return dot(points, { x, y, fill: colour, fillOpacity: opacity, r: size / 2, symbol });
  const apart = points.flatMap((point) => [point, { [x]: NaN, [y]: NaN } as Point]);
  return line(apart, { x, y, z: null, stroke: colour, strokeOpacity: opacity, strokeWidth: size, strokeLinecap: symbol === "circle" ? "round" : "square" });
}

export const before = "var(--before)";
export const after = "var(--after)";

/// A logarithmic axis from a round number to a round number, with few ticks.
export function logarithmic(values: number[]): { type: "log"; domain: [number, number]; ticks: number[]; tickFormat: (value: number) => string } {
  const smallest = Math.min(...values), largest = Math.max(...values);
  const low = Math.floor(Math.log10(smallest)), high = Math.ceil(Math.log10(largest));
  const steps = [];
  for (let k = low; k <= high; ++k) for (const step of [1, 2, 5]) steps.push(Number((step * 10 ** k).toPrecision(1)));
  const from = Math.max(...steps.filter((step) => step < smallest), 10 ** (low - 1)), to = Math.min(...steps.filter((step) => step > largest), 10 ** (high + 1));
  const ticks = steps.filter((step) => step >= from && step <= to);
  const decades = ticks.filter((step) => Math.abs(Math.log10(step) % 1) < 1e-9);
  return { type: "log", domain: [from, to], ticks: decades.length > 2 ? decades : ticks, tickFormat: String };
}
