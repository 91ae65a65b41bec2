// Errors by layer before and after, on one scale [huang2016, Fig. 9]; 3 sigma by layer [Fig. 6] stands with the contributors.
import type { ErrorMap, ErrorMapPoint, Report } from "../data";
import { bandLegend, discs, type Disc } from "../disc";
import { h } from "../dom";
import { figure } from "../figure";
import { digits } from "../numbers";
import { bandsFor } from "../scale";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.map;

function mapFigure(map: ErrorMap, key: string, [title, unit]: string[]): HTMLElement | null {
  const names = { before: `${key}_before_${unit}`, after: `${key}_after_${unit}` } as Record<"before" | "after", keyof ErrorMapPoint>;
  if (!(names.before in map.points[0]!)) return null;
  const has = map.points[0]![names.after] !== null;
  const perLayer = map.points.length / map.layers_mm.length;
  const disc = (heading: string, name: keyof ErrorMapPoint, layer: number): Disc => {
    const points = map.points.slice(layer * perLayer, (layer + 1) * perLayer);
    return { heading, row: text.layer(map.layers_mm[layer]!), points, values: points.map((point) => point[name] as number) };
  };
  const all = map.points.flatMap((point) => [point[names.before]!, ...(has ? [point[names.after]!] : [])]);
  const bands = bandsFor(all);
  const largest = (name: keyof ErrorMapPoint) => digits(Math.max(...map.points.map((point) => point[name]!)));
  const rows: Disc[][] = map.layers_mm.map((_, layer) => [disc(text.before, names.before, layer), ...(has ? [disc(text.after, names.after, layer)] : [])]);
  return figure({
    id: `map-${key}`,
    title: `${title}, ${unit}`,
    shows: text.shows(largest(names.before), has ? largest(names.after) : null, unit!),
    marks: all.length,
    sheet: { columns: ["x_mm", "y_mm", "z_mm", names.before, names.after], rows: map.points.map((point) => [point.x_mm!, point.y_mm!, point.z_mm!, point[names.before]!, point[names.after] ?? null]) },
    draw: (width) => [bandLegend(bands, unit!, width), discs(map, rows, bands, width, [text.x, text.y])],
  });
}

export function errorMaps({ figures }: Report): Section | null {
  const map = figures.error_map;
  if (!map) return null;
  const intro = map.points[0]!.distance_after_mm === null ? text.introBefore : text.intro(map.coverage_factor);
  return section("where", strings.nav.map, text.heading, intro,
    h("div", { class: "three" }, mapFigure(map, "distance", text.distance), mapFigure(map, "position", text.position), mapFigure(map, "rotation", text.rotation)));
}
