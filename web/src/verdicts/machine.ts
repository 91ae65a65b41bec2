// Is the machine good? A calibration and a validation.
import type { Calibration, ErrorMap, ErrorMapPoint, ErrorSummary, Use, UseQuantity, Validation } from "../data";
import { lengthsOf } from "../report";
import { decimalsFor, digits, fixed } from "../numbers";
import { strings } from "../strings";
import { assumptions, card, from, unitOf, type Verdict } from "./card";

const text = strings.verdict;

/// "3.35 → 0.02 mm".
/// Nobody measures finer: what a fit without anything to spare leaves of a residual is rounding.
const kNanometres = 6;

function beforeAfter(name: string, before: number, after: number, unit: string, notes: (string | null)[]): HTMLElement {
  const number = (value: number) => fixed(value, Math.min(kNanometres, decimalsFor(after)));
  return card(name, [from(number(before)), number(after), unitOf(unit)], notes);
}

/// Notes on the uncertainty of each.
interface Notes {
  distance: string | null;
  aligned: string | null;
  rotation: string | null;
  orientation: string | null;
}

/// Before and after, of what was read: nothing is shown that no reading tells.
function largestCards(before: ErrorSummary, after: ErrorSummary, names: Record<keyof Notes, string>, notes: Notes): HTMLElement[] {
  const largest = (name: string, was: number | null, is: number | null, unit: string, ...more: (string | null)[]) =>
    was === null || is === null || was === 0 ? [] : [beforeAfter(name, was, is, unit, more)];
  const rms = before.rms_distance_mm === null || after.rms_distance_mm === null ? null : text.rms(digits(before.rms_distance_mm, 3), digits(after.rms_distance_mm, 2));
  return [
    ...largest(names.distance, before.max_abs_distance_mm, after.max_abs_distance_mm, "mm", rms, notes.distance),
    ...largest(names.aligned, before.max_volumetric_aligned_mm, after.max_volumetric_aligned_mm, "mm", notes.aligned),
    ...largest(names.rotation, before.max_abs_rotation_deg, after.max_abs_rotation_deg, "deg", notes.rotation),
    ...largest(names.orientation, before.max_orientation_deg ?? null, after.max_orientation_deg ?? null, "deg", notes.orientation),
  ];
}

/// How good the machine is where nobody measured: what a buyer asks for.
function useCards(use: Use | null): HTMLElement[] {
  const one = (name: string, quantity: UseQuantity | null, unit: string) =>
    quantity === null ? [] : [card(name, [`\u00b1\u00a0${digits(quantity.U, 2)}`, unitOf(unit)], [quantity.limit === null ? null : text.use.limit(digits(quantity.limit), unit, quantity.verdict ?? ""), text.use.everywhere])];
  if (use === null) return [];
  return [...one(text.use.distance, use.distance_mm, "mm"), ...one(text.use.aligned, use.aligned_mm, "mm"), ...one(text.use.rotation, use.rotation_deg, "deg")];
}

function notesOf(calibration: Calibration): string[] {
  const unseen = calibration.null_space.map((direction) => direction.text);
  return [...calibration.notes, ...assumptions(calibration.assumed), ...(unseen.length > 0 ? [text.unseen(unseen, calibration.accepted)] : [])];
}

export function ofCalibration(calibration: Calibration): Verdict {
  const { before, after } = calibration;
  const lengths = lengthsOf(after).map((kind) => beforeAfter(text.residual.length(kind.replaceAll("_", " ")), before[`rms_${kind}_mm`] ?? 0, after[`rms_${kind}_mm`] ?? 0, "mm", [text.residual.fitted]));
  const fitted = { distance: text.residual.fitted, aligned: text.residual.fitted, rotation: text.residual.fitted, orientation: text.residual.fitted };
  return {
    yes: calibration.accepted,
    says: calibration.accepted ? text.yes.calibration : text.no.calibration(calibration.verdict),
    sentence: text.calibration(calibration.readings, calibration.noise_mm, calibration.degrees_of_freedom),
    reasons: calibration.reasons,
    cards: [...useCards(calibration.use), ...largestCards(before, after, text.residual, fitted), ...lengths],
    notes: notesOf(calibration),
  };
}

/// What the map says of the uncertainty of predictions, relative to home.
function predictedNotes(map: ErrorMap | undefined): Notes {
  const note = (key: string, unit: string) => {
    const values = (map?.points ?? []).map((point) => point[`${key}_after_${unit}` as keyof ErrorMapPoint] ?? null).filter((value): value is number => value !== null);
    return values.length > 0 ? text.predicted(digits(Math.max(...values), 2), unit) : null;
  };
  return { distance: note("distance", "mm"), aligned: note("position", "mm"), rotation: note("rotation", "deg"), orientation: null };
}

/// One banner: a calibration that other poses were measured for is judged by these; what it says of itself stands below.
export function ofValidation(validation: Validation, map: ErrorMap | undefined, calibration: Calibration | undefined): Verdict {
  const limited = validation.checks.length > 0;
  const iso = validation.iso9283;
  const inUnit = (quantity: string, value: number) => (quantity.endsWith("rad") ? (value * 180) / Math.PI : value);
  const checks = validation.checks.map((check) => {
    const unit = check.quantity.endsWith("rad") ? "deg" : "mm";
    const decimals = decimalsFor(inUnit(check.quantity, check.U));
    const [error, least, most] = [check.error, check.at_least, check.error + check.U].map((value) => fixed(inUnit(check.quantity, value), decimals)) as [string, string, string];
    return card(text.checked(check.quantity.replace(/, (rad|mm)$/, "")), [error, unitOf(unit)], [text.check(least, most, digits(inUnit(check.quantity, check.limit)), unit, check.conformity)]);
  });
  const yes = validation.accepted ?? validation.reasons.length === 0;
  return {
    yes,
    says: yes ? (limited ? text.yes.validation : text.improved) : limited ? text.no.validation : text.no.improved,
    sentence: text.validation(validation.poses.length, validation.readings.length),
    reasons: validation.reasons,
    cards: [
      ...checks,
      ...largestCards(validation.before, validation.after, text, predictedNotes(map)),
      ...useCards(calibration?.use ?? null),
      ...(iso.poses.length > 0 ? [card(text.iso, [`AP ${digits(iso.max_AP_mm)}`, unitOf("mm")], [text.isoMore(digits(iso.max_RP_mm, 2), digits(iso.max_AD_mm), digits(iso.max_RD_mm, 2))])] : []),
    ],
    notes: [...validation.notes, ...agreementOf(validation), ...(calibration ? notesOf(calibration) : assumptions(validation.assumed))],
  };
}

function agreementOf({ agreement }: Validation): string[] {
  return agreement && !agreement.contradicts ? [text.agrees(digits(agreement.chi_square), String(Math.round(agreement.dof)))] : [];
}
