// A printer's values, saved, by its firmware's fit and new, and how far the nozzle is off with them.
import type { DeltaAccuracy, DeltaGeometry, Report } from "../data";
import { h, table } from "../dom";
import { fixed } from "../numbers";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.printer;

/// One row a number; those of the towers apart.
function rowsOf(geometries: DeltaGeometry[]): string[][] {
  return Object.entries(text.names).flatMap(([key, name]) => {
    const values = geometries.map((geometry) => geometry[key]);
    if (values.some((value) => value === undefined)) return [];
    const ofTowers = values.map((value) => [value!].flat());
    return ofTowers[0]!.map((_, tower) => [ofTowers[0]!.length > 1 ? text.tower(name, tower) : name, ...ofTowers.map((value) => fixed(value[tower]!, 4))]);
  });
}

export function printer({ results }: Report): Section | null {
  const found = results.calibration?.printer;
  if (!found) return null;
  const errors = Object.entries(text.errorNames).map(([key, name]) => [name, ...[found.accuracy_saved, found.accuracy_new].map((accuracy) => fixed(accuracy[key as keyof DeltaAccuracy], 3))]);
  return section("printer", strings.nav.printer, text.heading, text.intro,
    table(text.columns, rowsOf([found.saved.geometry, found.firmware.geometry, found.new]), text.heading, [1, 2, 3]),
    h("h3", {}, text.lines),
    h("pre", { class: "command", tabindex: "0" }, found.lines),
    h("h3", {}, text.errors),
    table(text.errorColumns, errors, text.errors, [1, 2]));
}
