// A printer's values, saved, by its firmware's fit and new, and how far the nozzle is off with them.
import type { DeltaAccuracy, DeltaGeometry, Printer, Report } from "../data";
import { h, table } from "../dom";
import { fixed } from "../numbers";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.printer;

/// One row a number; those of the towers apart.
function rowsOf(geometries: DeltaGeometry[]): string[][] {
  return Object.entries(text.names).flatMap(([key, name]) => {
    const values = geometries.map((geometry): number | number[] | undefined => new Map(Object.entries(geometry)).get(key));
    if (values.some((value) => value === undefined)) return [];
    const ofTowers = values.map((value) => [value!].flat());
    return ofTowers[0]!.map((_, tower) => [ofTowers[0]!.length > 1 ? text.tower(name, tower) : name, ...ofTowers.map((value) => fixed(value[tower]!, 4))]);
  });
}

/// Saved, firmware's fit, new: what judges them. Without readings held out only what is expected.
function judged(found: Printer): string[][] {
  const names = text.judgedNames;
  const candidates = [found.judged_firmware, found.judged_new];
  const rows = [
    [names.shape, fixed(found.expected_shape_saved_mm, 3), ...candidates.map((one) => fixed(one.expected_shape_mm, 3))],
    [names.chance, "", ...candidates.map((one) => fixed(100 * Math.min(one.chance_better, one.chance_above_bed ?? 1, 0.999), 1))],
  ];
  const heldOut = [found.left_out_saved, found.left_out_firmware, found.left_out];
  if (heldOut.some((errors) => errors === null)) return rows;
  const errors = (key: "height_mm" | "distance_mm") => heldOut.map((one) => fixed(one![key], 3));
  const gains = candidates.map(({ gain }) => `${fixed(-100 * gain.value, 0)} (${fixed(-100 * gain.high, 0)} to ${fixed(-100 * gain.low, 0)})`);
  return [
    [names.heights, ...errors("height_mm")],
    ...(heldOut.some((one) => one!.distance_mm > 0) ? [[names.distances, ...errors("distance_mm")]] : []),
    [names.gain, "", ...gains],
    ...rows,
  ];
}

export function printer({ results }: Report): Section | null {
  const found = results.calibration?.printer;
  if (!found) return null;
  const errors = Object.entries(text.errorNames).map(([key, name]) => [name, ...[found.accuracy_saved, found.accuracy_new].map((accuracy) => fixed(accuracy[key as keyof DeltaAccuracy], 3))]);
  return section("printer", strings.nav.printer, text.heading, text.intro,
    table(text.columns, rowsOf([found.saved.geometry, found.judged_firmware.geometry, found.new]), text.heading, [1, 2, 3]),
    ...(found.advice !== "keep_saved" && found.advice !== "check_input" ? [h("h3", {}, text.lines), h("pre", { class: "command", tabindex: "0" }, found.lines)] : []),
    h("h3", {}, text.judged),
    h("p", {}, text.judgedIntro),
    table(text.columns, judged(found), text.judged, [1, 2, 3]),
    h("h3", {}, text.errors),
    table(text.errorColumns, errors, text.errors, [1, 2]));
}
