// The verdict, its numbers and their uncertainty: what a reader in a hurry must see.
import type { Calibration, ErrorMap, Largest, Report, Validation } from "../data";
import { h, svg, type Child } from "../dom";
import { decimalsFor, digits, exact, fixed, milli, percent, withUncertainty } from "../numbers";
import { strings } from "../strings";

const text = strings.verdict;

function sign(yes: boolean): SVGElement {
  const path = yes ? "M4 13l5 5L20 6" : "M6 6l12 12M18 6L6 18";
  return svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true", fill: "none", stroke: "currentColor", "stroke-width": 3, "stroke-linecap": "round" }, svg("path", { d: path }));
}

interface Verdict {
  yes: boolean;
  says: string;
  sentence: string;
  reasons?: string[];
  cards: HTMLElement[];
  notes?: string[];
}

function card(name: string, value: Child[], notes: (string | null)[]): HTMLElement {
  return h("div", { class: "card" }, h("dt", {}, name), h("dd", {}, h("div", { class: "value" }, ...value), ...notes.map((note) => (note === null ? null : h("div", { class: "note" }, note)))));
}

/// "3.35 → 0.02 mm"; both to the last digit that the uncertainty lets count.
function beforeAfter(name: string, before: number, after: number, unit: string, uncertainty: number | null, notes: (string | null)[]): HTMLElement {
  const decimals = uncertainty === null ? decimalsFor(after) : Math.max(0, decimalsFor(uncertainty) - (uncertainty < 1 ? 0 : 1));
  const number = (value: number) => fixed(value, decimals);
  return card(name, [h("span", { class: "from" }, `${number(before)} \u2192 `), number(after), h("span", { class: "unit" }, ` ${unit}`)], notes);
}

/// Notes on the uncertainty of each of the three.
interface Notes {
  distance: string | null;
  aligned: string | null;
  rotation: string | null;
}

function largestCards(before: Largest, after: Largest, uncertainty: number | null, notes: Notes): HTMLElement[] {
  const cards = [
    beforeAfter(text.distance, before.max_abs_distance_mm, after.max_abs_distance_mm, "mm", uncertainty, [text.rms(digits(before.rms_distance_mm, 3), digits(after.rms_distance_mm, 2)), notes.distance]),
    ...(before.max_volumetric_aligned_mm > 0 ? [beforeAfter(text.aligned, before.max_volumetric_aligned_mm, after.max_volumetric_aligned_mm, "mm", uncertainty, [notes.aligned])] : []),
  ];
  if (before.max_abs_rotation_deg !== null && after.max_abs_rotation_deg !== null) {
    cards.push(beforeAfter(text.rotation, before.max_abs_rotation_deg, after.max_abs_rotation_deg, "deg", null, [notes.rotation]));
  }
  return cards;
}

function ofCalibration(calibration: Calibration): Verdict {
  const points = calibration.residuals.some((residual) => "pose" in residual);
  const uncertainty = 2 * calibration.noise_mm * (points ? Math.SQRT2 : 1);
  const unseen = calibration.null_space.map((direction) => direction.text);
  return {
    yes: calibration.accepted,
    says: calibration.accepted ? text.yes.calibration : text.no.calibration(calibration.verdict),
    sentence: text.calibration(calibration.readings, calibration.noise_mm, calibration.degrees_of_freedom),
    reasons: calibration.reasons,
    cards: largestCards(calibration.before, calibration.after, uncertainty, { distance: text.reading(digits(uncertainty, 2)), aligned: text.point(digits(2 * calibration.noise_mm, 2)), rotation: null }),
    notes: [...calibration.notes, ...(unseen.length > 0 ? [text.unseen(unseen, calibration.accepted)] : [])],
  };
}

/// What the map says of the uncertainty of predictions, relative to home.
function predictedNotes(map: ErrorMap | undefined): Notes {
  const note = (key: string, unit: string) => {
    const values = (map?.points ?? []).map((point) => point[`${key}_after_${unit}`] ?? null).filter((value): value is number => value !== null);
    return values.length > 0 ? text.predicted(digits(Math.max(...values), 2), unit) : null;
  };
  return { distance: note("distance", "mm"), aligned: note("position", "mm"), rotation: note("rotation", "deg") };
}

function ofValidation(validation: Validation, map: ErrorMap | undefined): Verdict {
  const limited = validation.checks.length > 0;
  const iso = validation.iso9283;
  const inUnit = (quantity: string, value: number) => (quantity.endsWith("rad") ? (value * 180) / Math.PI : value);
  const checks = validation.checks.map((check) => {
    const unit = check.quantity.endsWith("rad") ? "deg" : "mm";
    const [error, u, limit] = [check.error, check.U, check.limit].map((value) => inUnit(check.quantity, value)) as [number, number, number];
    return card(text.checked(check.quantity.replace(/, (rad|mm)$/, "")), [withUncertainty(error, u), h("span", { class: "unit" }, ` ${unit}`)], [text.check(digits(limit), unit, check.conformity)]);
  });
  return {
    yes: validation.accepted,
    says: validation.accepted ? (limited ? text.yes.validation : text.improved) : limited ? text.no.validation : text.no.improved,
    sentence: text.validation(validation.poses.length),
    reasons: validation.reasons,
    cards: [
      ...checks,
      ...largestCards(validation.before, validation.after, null, predictedNotes(map)),
      ...(iso.poses.length > 0 ? [card(text.iso, [`AP ${digits(iso.max_AP_mm)}`, h("span", { class: "unit" }, " mm")], [text.isoMore(digits(iso.max_RP_mm, 2), digits(iso.max_AD_mm), digits(iso.max_RD_mm, 2))])] : []),
    ],
  };
}

function verdictsOf({ results, figures }: Report): Verdict[] {
  const verdicts: Verdict[] = [];
  const { analysis, allocation, sensitivity, reproduction } = results;
  if (reproduction) {
    const good = reproduction.rows.filter((row) => row.ok).length, all = reproduction.rows.length;
    verdicts.push({ yes: good === all, says: good === all ? text.yes.reproduction : text.no.reproduction(all - good), sentence: text.rows(good, all), cards: [] });
  }
  if (results.validation) verdicts.push(ofValidation(results.validation, figures.error_map));
  if (results.calibration) verdicts.push(ofCalibration(results.calibration));
  if (analysis) {
    const interval = text.interval(percent(analysis.yield.low, 4), percent(analysis.yield.high, 4), analysis.confidence);
    verdicts.push({
      yes: analysis.converged,
      says: analysis.converged ? text.yes.analysis : text.no.analysis,
      sentence: `${text.yield}: ${percent(analysis.yield.value, 4)} of ${analysis.machines} drawn (${analysis.model} model).`,
      cards: [
        card(text.yield, [percent(analysis.yield.value, 4)], [interval]),
        ...analysis.requirements.map((one) => {
          const half = (one.monte_carlo_3sigma_interval[1] - one.monte_carlo_3sigma_interval[0]) / 2;
          const { scale, unit } = milli(one.unit);
          return card(text.threeSigma(one.quantity), [withUncertainty(scale * one.monte_carlo_3sigma, scale * half), h("span", { class: "unit" }, ` ${unit}`)], [
            text.limit(`${digits(scale * one.limit)} ${unit}`, digits(one.cpk)),
            text.worstCase(`${digits(scale * one.worst_case)} ${unit}`),
          ]);
        }),
      ],
    });
  }
  if (allocation) {
    verdicts.push({
      yes: allocation.status === "found" || allocation.reason === "",
      says: allocation.reason === "" ? text.yes.allocation : `${text.no.allocation}: ${allocation.status}`,
      sentence: allocation.max_tilt_3sigma === undefined ? allocation.status : text.allocation(digits(1e3 * allocation.max_tilt_3sigma)),
      reasons: allocation.reason === "" ? [] : [allocation.reason],
      cards: [
        ...allocation.requirements.map((one) => {
          const key = Object.keys(one).find((name) => name.startsWith("worst_") && name !== "worst_pose")!;
          const { scale, unit } = milli(key.slice("worst_".length));
          const [worst, limit] = [one[key], one[key.replace("worst", "limit")]] as [number, number];
          return card(text.largest(one.quantity, one.criterion), [digits(scale * worst), h("span", { class: "unit" }, ` ${unit}`)], [text.allocated(`${digits(scale * limit)} ${unit}`)]);
        }),
        card(text.cost, [digits(allocation.cost, 4)], []),
      ],
    });
  }
  if (sensitivity && !reproduction) {
    const key = Object.keys(sensitivity.worst).find((name) => name.startsWith("three_sigma_"))!;
    const { scale, unit } = milli(key.slice(key.lastIndexOf("_") + 1));
    verdicts.push({
      yes: true,
      says: text.yes.sensitivity,
      sentence: text.sensitivity(sensitivity.quantity, sensitivity.poses),
      cards: [card(text.worst, [digits(scale * sensitivity.worst[key]!), h("span", { class: "unit" }, ` ${unit}`)], [text.at(...(["x_mm", "y_mm", "z_mm"].map((axis) => exact(Math.round(sensitivity.worst[axis]!))) as [string, string, string]))])],
    });
  }
  if (results.yield) {
    const batch = results.yield, share = batch.yield;
    const spread = Object.entries(batch.quantities).flatMap(([name, both]) => (both ? [{ name, ...both }] : []));
    verdicts.push({
      yes: !batch.partial,
      says: batch.partial ? text.no.yield : text.yes.yield,
      sentence: `${text.yield}: ${text.of(String(batch.passed), String(batch.machines))}.`,
      cards: [
        ...(share ? [card(text.yield, [percent(share.value, 4)], [text.interval(percent(share.low), percent(share.high), share.confidence)])] : []),
        ...spread.map(({ name, before, after }) => {
          const { scale, unit } = milli(name.slice(name.lastIndexOf("_") + 1));
          const half = (scale * (after.p95_interval[1] - after.p95_interval[0])) / 2, decimals = decimalsFor(half);
          return card(text.p95(strings.batch.quantities[name.slice(0, name.lastIndexOf("_"))] ?? name), [h("span", { class: "from" }, `${digits(scale * before.p95)} \u2192 `), fixed(scale * after.p95, decimals), h("span", { class: "unit" }, ` ${unit}`)], [
            `${fixed(scale * after.p95_interval[0], decimals)} to ${fixed(scale * after.p95_interval[1], decimals)} after`,
          ]);
        }),
      ],
    });
  }
  return verdicts;
}

export function verdict(report: Report): HTMLElement {
  const parts = verdictsOf(report).flatMap(({ yes, says, sentence, reasons, cards, notes }) => [
    h("div", { class: `verdict ${yes ? "yes" : "no"}` }, sign(yes), h("div", {}, h("strong", {}, says), h("p", {}, sentence), reasons?.length ? h("ul", {}, ...reasons.map((reason) => h("li", {}, reason))) : null)),
    h("dl", { class: "cards" }, ...cards),
    ...(notes?.length ? [h("details", { open: "" }, h("summary", {}, text.notes), h("ul", { class: "notes" }, ...notes.map((note) => h("li", {}, note))))] : []),
  ]);
  return h("header", { id: "verdict", tabindex: "-1" },
    h("p", { class: "kind" }, strings.madeBy(report.program, report.date)),
    h("h1", { class: "name" }, strings.title(report.robot.name, strings.kind[report.kind] ?? report.kind)),
    ...parts);
}
