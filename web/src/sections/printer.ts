// A printer's values, rung by rung, what judges them, and the bed before and after.
import type { DeltaGeometry, PrinterFigure as Interval, Printer, Report } from "../data";
import { bandLegend, discs, type Disc } from "../disc";
import { h, table } from "../dom";
import { figure } from "../figure";
import { fixed } from "../numbers";
import { bandsFor } from "../scale";
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

function judged({ ladder, rung, advice }: Printer): string[][] {
  const names = text.judgedNames;
  const interval = ({ value, low, high }: Interval, places: number) => `${fixed(value, places)} (${fixed(low, places)} to ${fixed(high, places)})`;
  return [
    [names.layer, ...ladder.map((one) => interval(one.first_layer_mm, 3))],
    [names.size, ...ladder.map((one) => interval(one.size_percent, 2))],
    [names.chance, ...ladder.map((one) => (one.rung === "saved" ? "" : fixed(100 * Math.min(one.chance_better, 0.999), 1)))],
    [names.depth, ...ladder.map((one) => (one.depth_mm === null ? "" : fixed(Math.max(one.depth_mm, 0), 2)))],
    [names.advised, ...ladder.map((one) => (one.rung === rung && advice !== "check_input" ? text.yes : ""))],
  ];
}

/// The bed as a mesh shows it: the height of the nozzle over the disk, with the saved and the recommended values.
function bed({ bed: points, print_radius_mm, advice }: Printer): HTMLElement | null {
  if (points.length === 0) return null;
  const around = 12, rings = (points.length - 1) / around;
  const axes = {
    radii_mm: Array.from({ length: rings }, (_, k) => (print_radius_mm * (k + 1)) / rings),
    azimuths_deg: Array.from({ length: around }, (_, k) => (360 * k) / around),
    points,
  };
  const disc = (heading: string, values: number[]): Disc => ({ heading, row: text.row, points, values });
  const saved = points.map((point) => point.saved_mm), advised = points.map((point) => point.new_mm);
  const bands = bandsFor([...saved, ...advised]);
  const range = (values: number[]) => fixed(Math.max(...values) - Math.min(...values), 3);
  const row = [disc(text.before, saved), ...(advice === "accept_new" ? [disc(text.after, advised)] : [])];
  return figure({
    id: "bed",
    title: text.bed,
    shows: text.bedShows(range(saved), range(advised)),
    marks: row.length * points.length,
    sheet: { columns: ["x_mm", "y_mm", "saved_mm", "new_mm"], rows: points.map((point) => [point.x_mm, point.y_mm, point.saved_mm, point.new_mm]) },
    draw: (width) => [bandLegend(bands, "mm", width), discs(axes, [row], bands, width, [strings.map.x, strings.map.y])],
  });
}

export function printer({ results }: Report): Section | null {
  const found = results.calibration?.printer;
  if (!found) return null;
  const columns = ["", ...found.ladder.map((one) => text.rungs[one.rung]!)], numeric = found.ladder.map((_, k) => k + 1);
  return section("printer", strings.nav.printer, text.heading, text.intro,
    bed(found),
    ...(found.advice === "accept_new" || found.advice === "accept_shift" ? [h("h3", {}, text.lines), h("pre", { class: "command", tabindex: "0" }, found.lines)] : []),
    h("h3", {}, text.judged),
    table(columns, judged(found), text.judged, numeric),
    table(columns, rowsOf(found.ladder.map((one) => one.geometry)), text.heading, numeric));
}
