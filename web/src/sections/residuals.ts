// What the fit leaves over, reading by reading, and what other poses say.
import { dot, line, ruleX, ruleY } from "@observablehq/plot";
import type { Calibration, DistanceResidual, Report, Residual, Validation } from "../data";
import { isLength, isPoint, length, type LengthResidual } from "../report";
import { h, table } from "../dom";
import { figure, legend } from "../figure";
import { digits, normalQuantile, probability } from "../numbers";
import { after, before, dots, draw, logarithmic } from "../plot";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.residuals;

interface NumberRead {
  index: number;
  name: string;
  before: number;
  after: number;
}

const nameOf = (residual: DistanceResidual | LengthResidual) => (isLength(residual) ? residual.pose : `${residual.from} \u2013 ${residual.to}`);

/// One row a number read and used: a distance, a length, or each coordinate of a point.
function residualsOf(calibration: Calibration): NumberRead[] {
  return calibration.residuals.flatMap((residual, k) => {
    if (residual.excluded) return [];
    if (!isPoint(residual)) return [{ index: k + 1, name: nameOf(residual), before: residual.before_mm, after: residual.after_mm }];
    return residual.after_mm.map((value, axis) => ({ index: k + 1, name: `${residual.pose}, ${"xyz"[axis]}`, before: residual.before_mm[axis]!, after: value }));
  });
}

const rms = (values: number[]) => Math.sqrt(values.reduce((sum, v) => sum + v * v, 0) / Math.max(values.length, 1));
const byPose = { before: strings.robot.before, after: strings.robot.after };
const bothKinds = (out: boolean) => legend([{ text: byPose.before, kind: "before" }, { text: byPose.after, kind: "after" }, ...(out ? [{ text: text.leftOut, kind: "out" }] : [])]);

interface Sizes {
  index: number;
  name: string;
  before: number;
  after: number;
  out?: boolean; ///< left out of the fit
}

const kZero = 1e-6; // mm: what is smaller, as home against itself, has no place on a logarithmic axis

/// Before and after on a logarithmic axis; readings that were left out are hollow.
function sizesFigure(id: string, title: string, shows: string, sizes: Sizes[], x: string, y: string): HTMLElement {
  const on = (key: "before" | "after") => sizes.filter((size) => size[key] > kZero);
  const scale = logarithmic([...on("before").map((size) => size.before), ...on("after").map((size) => size.after)]);
  return figure({
    id,
    title,
    shows,
    marks: on("before").length + on("after").length,
    sheet: { columns: ["name", "before_mm", "after_mm"], rows: sizes.map((size) => [size.name, size.before, size.after]) },
    draw: (width) => [
      bothKinds(sizes.some((size) => size.out)),
      draw({
        width,
        height: 280,
        x: { label: x, ticks: Math.min(sizes.length, Math.floor(width / 60)), tickFormat: "d" },
        y: { label: y, grid: true, ...scale },
        inset: 6,
        marks: [
          dots(on("before"), { x: "index", y: "before", colour: before, size: 6, symbol: "circle" }),
          dots(on("after").filter((size) => !size.out), { x: "index", y: "after", colour: after, size: 6, symbol: "square" }),
          dot(on("after").filter((size) => size.out), { x: "index", y: "after", fill: "none", stroke: after, r: 3, symbol: "square" }),
        ],
      }),
    ],
  });
}

function sizeOf(calibration: Calibration): HTMLElement {
  const sizes: Sizes[] = calibration.residuals.map((residual, k) =>
    isPoint(residual)
      ? { index: k + 1, name: residual.pose, before: length(residual.before_mm), after: length(residual.after_mm), out: residual.excluded }
      : { index: k + 1, name: nameOf(residual), before: Math.abs(residual.before_mm), after: Math.abs(residual.after_mm), out: residual.excluded });
  const used = sizes.filter((size) => !size.out);
  const shows = text.sizeShows(digits(rms(used.map((size) => size.before))), digits(rms(used.map((size) => size.after)), 2), sizes.length - used.length);
  return sizesFigure("residual-sizes", text.size, shows, sizes, text.reading, text.size_mm);
}

function afterFigure(residuals: NumberRead[], noise: number): HTMLElement {
  return figure({
    id: "residuals-after",
    title: text.after,
    shows: text.afterShows(digits(noise, 2)),
    marks: residuals.length,
    sheet: { columns: ["name", "after_mm"], rows: residuals.map((one) => [one.name, one.after]) },
    draw: (width) =>
      draw({
        width,
        height: 280,
        x: { label: text.reading, ticks: Math.min(residuals.length, Math.floor(width / 60)), tickFormat: "d" },
        y: { label: text.residual_mm, grid: true, nice: true },
        inset: 6,
        marks: [ruleY([0], { stroke: "var(--muted)" }), ruleY([-2 * noise, 2 * noise], { stroke: "var(--muted)", strokeDasharray: "4 4" }), dots(residuals, { x: "index", y: "after", colour: after, size: 5, symbol: "square", opacity: 0.75 })],
      }),
  });
}

function normalFigure(residuals: NumberRead[], noise: number): HTMLElement {
  const sorted = residuals.map((one) => one).sort((one, other) => one.after - other.after);
  const points = sorted.map((one, k) => ({ name: one.name, after: one.after, expected: noise * normalQuantile((k + 0.5) / sorted.length) }));
  const end = points[points.length - 1]!.expected * 1.1;
  return figure({
    id: "normal-plot",
    title: text.normal,
    shows: text.normalShows,
    marks: points.length,
    sheet: { columns: ["name", "expected_mm", "after_mm"], rows: points.map((one) => [one.name, one.expected, one.after]) },
    draw: (width) =>
      draw({
        width,
        height: 280,
        x: { label: text.expected, ticks: Math.floor(width / 80) },
        y: { label: text.residual_mm, grid: true },
        inset: 6,
        marks: [ruleX([0], { stroke: "var(--line)" }), line([[-end, -end], [end, end]], { stroke: "var(--muted)", strokeDasharray: "4 4" }), dots(points, { x: "expected", y: "after", colour: after, size: 5, symbol: "square", opacity: 0.75 })],
      }),
  });
}

function suspects(calibration: Calibration): HTMLElement {
  const worst = calibration.suspects.filter((one) => one.excluded || one.chance < 0.05).slice(0, 10);
  if (worst.length === 0) return h("p", {}, text.suspectsNone);
  return h("div", {}, h("h3", {}, text.suspects),
    table(text.columns, worst.map((one) => [one.reading, digits(one.statistic), probability(one.chance), one.excluded ? text.leftOut : text.used]), text.suspects, [1, 2]));
}

function validatedPoses(validation: Validation): HTMLElement[] {
  if (validation.poses.length === 0) return [];
  const sizes = validation.poses.map((one, k) => ({ index: k + 1, name: one.pose, before: one.before.d_v_mm, after: one.after.d_v_mm }));
  const shows = text.posesShows(digits(validation.before.max_volumetric_mm ?? 0), digits(validation.after.max_volumetric_mm ?? 0, 2));
  const { poses } = validation.iso9283;
  return [
    sizesFigure("validated-poses", text.poses, shows, sizes, text.pose, text.error_mm),
    ...(poses.length > 0 ? [h("details", {}, h("summary", {}, text.iso), table(text.isoColumns, poses.map((one) => [one.pose, String(one.repeats), ...[one.AP_mm, one.RP_mm, one.AD_mm, one.RD_mm].map((value) => digits(value))]), text.iso, [1, 2, 3, 4, 5]))] : []),
  ];
}

function validatedReadings({ readings }: Validation): HTMLElement[] {
  if (readings.length === 0) return [];
  const sizes = readings.map((one, k) => ({ index: k + 1, name: one.reading, before: Math.abs(one.before_mm), after: Math.abs(one.after_mm) }));
  const shows = text.readingsShows(digits(rms(sizes.map((size) => size.before))), digits(rms(sizes.map((size) => size.after)), 2));
  return [
    sizesFigure("validated-readings", text.readings, shows, sizes, text.reading, text.size_mm),
    h("details", {}, h("summary", {}, text.readings), table(text.readingsColumns, readings.map((one) => [one.reading, ...[one.before_mm, one.after_mm, one.U_mm].map((value) => digits(value))]), text.readings, [1, 2, 3])),
  ];
}

/// Whether all readings scatter alike; a probe and a calliper do not.
function alike({ residuals }: Calibration): boolean {
  const kindOf = (residual: Residual) => (isLength(residual) ? Object.keys(residual).join() : "other");
  return new Set(residuals.map(kindOf)).size <= 1;
}

export function residuals({ results }: Report): Section | null {
  const { calibration, validation } = results;
  const numbers = calibration ? residualsOf(calibration) : [];
  if (numbers.length === 0 && !validation) return null;
  return section("residuals", strings.nav.residuals, text.heading, text.intro,
    ...(validation ? [...validatedPoses(validation), ...validatedReadings(validation)] : []),
    ...(calibration && numbers.length > 0 ? [sizeOf(calibration), ...(alike(calibration) ? [h("div", { class: "pair" }, afterFigure(numbers, calibration.noise_mm), normalFigure(numbers, calibration.noise_mm))] : []), suspects(calibration)] : []));
}
