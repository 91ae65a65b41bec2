// The report that stands in the page, and what is asked of its results in more than one place.

import type { BallBarResidual, DialResidual, ErrorSummary, HeightResidual, PointResidual, Report, Residual, Robot, SingleRodOnAnArm, SingleRodOnARail, Strut, Vector } from "./data";

/// A limb with one rod.
export type SingleRod = Strut | SingleRodOnAnArm | SingleRodOnARail;
export const singleRodsOf = (robot: Robot): SingleRod[] => (robot.limb ?? []).filter((one): one is SingleRod => one.kind !== undefined);

/// Of a height, a ball bar's length or a dial's reading: its own number stands under the name of its column.
export type LengthResidual = HeightResidual | BallBarResidual | DialResidual;

export const isPoint = (residual: Residual): residual is PointResidual => Array.isArray(residual.before_mm);
export const isLength = (residual: Residual): residual is LengthResidual => "pose" in residual && !isPoint(residual);

type LengthOf<Key> = Key extends `rms_${infer Length}_mm` ? Exclude<Length, "distance"> : never;
/// The kinds of length of which a summary has a root mean square: ["height", "ball_bar"].
export const lengthsOf = (summary: ErrorSummary) =>
  Object.entries(summary).flatMap(([key, value]) => (value == null || key === "rms_distance_mm" ? [] : ((/^rms_(.+)_mm$/.exec(key)?.slice(1) ?? []) as LengthOf<keyof ErrorSummary>[])));

export const length = (v: Vector) => Math.hypot(...v);

export function readReport(): Report {
  const report = JSON.parse(document.getElementById("data")!.textContent!) as Report;
  if (report.format !== "paracal report 1") throw new Error(`expected a "paracal report 1", got "${report.format}"`);
  return report;
}
