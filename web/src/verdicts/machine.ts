// Is the machine good? A calibration and a validation.
import type { Calibration, ErrorMap, Largest, Validation } from "../data";
import { decimalsFor, digits, fixed, withUncertainty } from "../numbers";
import { strings } from "../strings";
import { card, from, unitOf, type Verdict } from "./card";

const text = strings.verdict;

/// "3.35 → 0.02 mm"; both to the last digit that the uncertainty lets count.
function beforeAfter(name: string, before: number, after: number, unit: string, uncertainty: number | null, notes: (string | null)[]): HTMLElement {
  const decimals = uncertainty === null ? decimalsFor(after) : Math.max(0, decimalsFor(uncertainty) - (uncertainty < 1 ? 0 : 1));
  const number = (value: number) => fixed(value, decimals);
  return card(name, [from(number(before)), number(after), unitOf(unit)], notes);
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

export function ofCalibration(calibration: Calibration): Verdict {
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

export function ofValidation(validation: Validation, map: ErrorMap | undefined): Verdict {
  const limited = validation.checks.length > 0;
  const iso = validation.iso9283;
  const inUnit = (quantity: string, value: number) => (quantity.endsWith("rad") ? (value * 180) / Math.PI : value);
  const checks = validation.checks.map((check) => {
    const unit = check.quantity.endsWith("rad") ? "deg" : "mm";
    const [error, u, limit] = [check.error, check.U, check.limit].map((value) => inUnit(check.quantity, value)) as [number, number, number];
    return card(text.checked(check.quantity.replace(/, (rad|mm)$/, "")), [withUncertainty(error, u), unitOf(unit)], [text.check(digits(limit), unit, check.conformity)]);
  });
  return {
    yes: validation.accepted,
    says: validation.accepted ? (limited ? text.yes.validation : text.improved) : limited ? text.no.validation : text.no.improved,
    sentence: text.validation(validation.poses.length),
    reasons: validation.reasons,
    cards: [
      ...checks,
      ...largestCards(validation.before, validation.after, null, predictedNotes(map)),
      ...(iso.poses.length > 0 ? [card(text.iso, [`AP ${digits(iso.max_AP_mm)}`, unitOf("mm")], [text.isoMore(digits(iso.max_RP_mm, 2), digits(iso.max_AD_mm), digits(iso.max_RD_mm, 2))])] : []),
    ],
  };
}
