// Which parts matter [huang2016, Figs. 5, 6] and how tight they must be.
import { barX, dot, ruleX, text as label } from "@observablehq/plot";
import type { Allocation, Contributor, Report, Sensitivity, SigmaMap } from "../data";
import { singleRodsOf } from "../report";
import { bandLegend, discs } from "../disc";
import { h } from "../dom";
import { figure } from "../figure";
import { digits, milli, percent } from "../numbers";
import { draw } from "../plot";
import { bandsFor } from "../scale";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.contributors;
const words = (name: string) => name.replace("_over_c", " / c");
const bars = { marginLeft: 150, marginTop: 8 };

interface Bar {
  name: string;
  value: number;
}

/// One bar a name, its number behind it.
const labelledBars = (rows: Bar[], axis: string) => (width: number) =>
  draw({
    width,
    height: 60 + 24 * rows.length,
    ...bars,
    marginRight: 48,
    x: { label: axis, grid: true, ticks: 5 },
    y: { label: null, domain: rows.map((row) => row.name), tickSize: 0 },
    marks: [barX(rows, { y: "name", x: "value", fill: "var(--after)" }), label(rows, { y: "name", x: "value", text: (row: Bar) => digits(row.value, 3), dx: 6, textAnchor: "start", fill: "currentColor" })],
  });

function pareto(quantity: string, contributors: Contributor[], number: number): HTMLElement {
  const rows = contributors.filter((one) => one.share > 0).map((one) => ({ name: one.name, value: 100 * one.share }));
  return figure({
    id: `pareto-${number}`,
    title: text.pareto(quantity),
    shows: rows.length > 0 ? text.paretoShows(rows[0]!.name, percent(rows[0]!.value / 100)) : "",
    marks: rows.length,
    sheet: { columns: ["name", "share_percent"], rows: rows.map((row) => [row.name, row.value]) },
    draw: labelledBars(rows, text.share),
  });
}

function globalFigure(sensitivity: Sensitivity, onStruts: boolean): HTMLElement {
  const rows = Object.entries(sensitivity.global).map(([name, mean]) => ({ name: words(name), mean, largest: sensitivity.largest[name]! })).filter((row) => row.largest > 0).sort((one, other) => other.mean - one.mean);
  const tilt = sensitivity.quantity === "tilt" && !onStruts; // in the paper's units
  return figure({
    id: "global-sensitivity",
    title: text.global(sensitivity.quantity),
    shows: tilt ? text.globalShows : text.globalMixed,
    marks: rows.length,
    sheet: { columns: ["name", "mean", "largest"], rows: rows.map((row) => [row.name, row.mean, row.largest]) },
    draw: (width) =>
      draw({
        width,
        height: 60 + 24 * rows.length,
        ...bars,
        x: { label: tilt ? text.unit : text.per(sensitivity.quantity), grid: true, ticks: 5 },
        y: { label: null, domain: rows.map((row) => row.name), tickSize: 0 },
        marks: [barX(rows, { y: "name", x: "mean", fill: "var(--after)" }), dot(rows, { y: "name", x: "largest", r: 4, fill: "var(--before)" }), ruleX([0])],
      }),
  });
}

/// What a drawing says of an error: its key has the unit behind the name.
function onADrawing(name: string, drawing: Allocation["drawing"]): string {
  const error = name.replace(/_over_c$/, "");
  return Object.entries(drawing).find(([key]) => key === error || key.startsWith(`${error}_`))?.[1].text ?? "";
}

/// Of the tilt group in the paper's units; of limbs with one rod, which have none, all half-widths.
function tolerancesFigure({ tolerances, half_widths: halfWidths, drawing }: Allocation): HTMLElement {
  const values = tolerances ?? Object.fromEntries(Object.entries(halfWidths).filter((one): one is [string, number] => typeof one[1] === "number"));
  const scale = tolerances ? 1e3 : 1;
  const rows = Object.entries(values).map(([name, value]) => ({ name: words(name), value: scale * value, drawn: onADrawing(name, drawing) }));
  return figure({
    id: "allocated-tolerances",
    title: tolerances ? text.allocated : text.allocatedAll,
    shows: tolerances ? text.allocatedShows : text.allocatedAllShows,
    marks: rows.length,
    sheet: { columns: ["name", tolerances ? "tolerance_mrad" : "half_width", "drawing"], rows: rows.map((row) => [row.name, row.value, row.drawn]) },
    draw: labelledBars(rows, tolerances ? text.milli : text.half),
  });
}

function sigmaFigure(map: SigmaMap): HTMLElement {
  const { scale, unit } = milli(map.unit);
  const values = map.points.map((point) => scale * point.value);
  const bands = bandsFor(values);
  const perLayer = values.length / map.layers_mm.length;
  const worst = map.points.reduce((one, other) => (other.value > one.value ? other : one));
  const layers = map.layers_mm.map((z, layer) => ({ heading: "", row: strings.map.layer(z), points: map.points.slice(layer * perLayer, (layer + 1) * perLayer), values: values.slice(layer * perLayer, (layer + 1) * perLayer) }));
  return figure({
    id: "sigma-map",
    title: `${strings.map.sigma(map.quantity)}, ${unit}`,
    shows: strings.map.sigmaShows(digits(scale * worst.value), unit, worst.z_mm, Math.hypot(worst.x_mm, worst.y_mm)),
    marks: values.length,
    sheet: { columns: ["x_mm", "y_mm", "z_mm", `three_sigma_${unit}`], rows: map.points.map((point) => [point.x_mm, point.y_mm, point.z_mm, scale * point.value]) },
    draw: (width) => [bandLegend(bands, unit, width), discs(map, width < 480 ? layers.map((layer) => [layer]) : [layers], bands, width, [strings.map.x, strings.map.y])],
  });
}

export function contributors({ robot, results, figures }: Report): Section | null {
  const { sensitivity, allocation, analysis } = results;
  const parts = [
    ...(allocation && allocation.reason === "" ? [tolerancesFigure(allocation)] : []),
    ...(sensitivity ? [globalFigure(sensitivity, singleRodsOf(robot).length > 0), pareto(sensitivity.quantity, sensitivity.contributors, 1)] : []),
    ...(analysis?.requirements.map((one, k) => pareto(one.quantity, one.contributors, k + 1)) ?? []),
  ];
  if (parts.length === 0 && !figures.sigma_map) return null;
  return section("contributors", strings.nav.contributors, text.heading, null,
    h("div", { class: "pair" }, ...parts),
    figures.sigma_map ? sigmaFigure(figures.sigma_map) : null);
}
