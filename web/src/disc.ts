// Maps over a layer of the workspace, seen from above: one cell a point of the grid of the axis and rings around it.
import type { ErrorMap, SigmaMap } from "./data";
import { svg } from "./dom";
import type { Bands } from "./scale";

/// What both maps have.
type MapAxes = Pick<ErrorMap & SigmaMap, "radii_mm" | "azimuths_deg"> & { points: Place[] };
interface Place {
  x_mm?: number;
  y_mm?: number;
}

export interface Disc {
  heading: string;
  row: string;
  points: Place[]; ///< the axis, then the rings from inside out
  values: number[]; ///< there
}

type Corner = [number, number];
const path = (corners: Corner[]) => `M${corners.map(([x, y]) => `${x.toFixed(2)} ${y.toFixed(2)}`).join("L")}Z`;
const scaled = (corners: Corner[], share: number) => corners.map(([x, y]): Corner => [share * x, share * y]);
const middle = ([ax, ay]: Corner, [bx, by]: Corner): Corner => [(ax + bx) / 2, (ay + by) / 2];

/// Where a layer ends, from its middle in pixels.
function wall(axes: MapAxes, { points }: Disc, { x, y }: { x: number; y: number }, pixels: number): Corner[] {
  return points.slice(-axes.azimuths_deg.length).map((point) => [pixels * (point.x_mm! - x), pixels * (y - point.y_mm!)]);
}

function cells(axes: MapAxes, values: number[], wall: Corner[], bands: Bands): SVGElement[] {
  const rings = axes.radii_mm.length, spokes = wall.length;
  return values.map((value, k) => {
    const i = Math.floor((k - 1) / spokes) + 1, j = (k - 1) % spokes;
    const side = (): Corner[] => [middle(wall[(j + spokes - 1) % spokes]!, wall[j]!), wall[j]!, middle(wall[j]!, wall[(j + 1) % spokes]!)];
    const corners = k === 0 ? scaled(wall, 0.5 / rings) : [...scaled(side(), (i - 0.5) / rings), ...scaled(side(), Math.min(i + 0.5, rings) / rings).reverse()];
    return svg("path", { d: path(corners), fill: bands.colourOf(value), class: "cell" });
  });
}

const label = (x: number, y: number, text: string, anchor = "middle", extra: Record<string, string | number> = {}) =>
  svg("text", { x, y, "text-anchor": anchor, fill: "currentColor", "font-size": 11, ...extra }, text);

function ticks(x: number, y: number, radius: number, centre: number, largest: number, axis: "x" | "y"): SVGElement[] {
  return [-1, 0, 1].map((k) => {
    const text = String(Math.round(centre + k * largest)).replace("-", "\u2212");
    if (axis === "y") return label(x, y - k * radius * 0.94 + 4, text, "end");
    return label(x + k * radius, y, text, ["start", "middle", "end"][k + 1]);
  });
}

/// Rows and columns of discs with shared axes.
/// @param axisNames  of x and y with their unit
export function discs(axes: MapAxes, rows: Disc[][], bands: Bands, width: number, axisNames: [string, string]): Element {
  const columns = rows[0]!.length, left = 58, gap = 14, top = 22;
  const cellWidth = Math.min((width - left - 16) / columns, 230);
  const radius = (cellWidth - gap) / 2, rowHeight = 2 * radius + 24;
  const centre = { x: axes.points[0]!.x_mm!, y: axes.points[0]!.y_mm! }; // the axis of the top layer
  const largest = Math.max(...axes.points.flatMap((point) => [Math.abs(point.x_mm! - centre.x), Math.abs(point.y_mm! - centre.y)]));
  const height = top + rows.length * rowHeight + 22;
  const totalWidth = left + columns * cellWidth + 16;
  const drawing = svg("svg", { viewBox: `0 0 ${totalWidth} ${height}`, width: totalWidth, height, "aria-hidden": "true", color: "var(--ink)" });
  rows.forEach((row, r) => {
    const y = top + r * rowHeight + radius + 4;
    drawing.append(...ticks(left - 4, y, radius, centre.y, largest, "y"));
    drawing.append(label(13, y, axisNames[1], "middle", { transform: `rotate(-90 13 ${y})`, fill: "var(--muted)" }));
    const shared = columns > 1 && row.every((disc) => disc.row === row[0]!.row);
    row.forEach((disc, c) => {
      const x = left + c * cellWidth + cellWidth / 2;
      if (r === 0 && disc.heading) drawing.append(label(x, 12, disc.heading, "middle", { "font-weight": 600 }));
      const outline = wall(axes, disc, centre, radius / largest);
      drawing.append(svg("g", { transform: `translate(${x} ${y})` }, ...cells(axes, disc.values, outline, bands), svg("path", { d: path(outline), fill: "none", stroke: "var(--line)" })));
      if (disc.row && !shared) drawing.append(label(x, y + radius + 14, disc.row, "middle", { fill: "var(--muted)" }));
    });
    if (shared) drawing.append(label(left + (columns * cellWidth) / 2, y + radius + 14, row[0]!.row, "middle", { fill: "var(--muted)" }));
  });
  const bottom = top + rows.length * rowHeight + 8;
  for (let c = 0; c < columns; ++c) {
    const x = left + c * cellWidth + cellWidth / 2;
    drawing.append(...ticks(x, bottom, radius, centre.x, largest, "x"), label(x, bottom + 13, axisNames[0], "middle", { fill: "var(--muted)" }));
  }
  return drawing;
}

/// The bands with their thresholds between them.
export function bandLegend(bands: Bands, unit: string, width: number): Element {
  const count = bands.colours.length, left = 12, box = Math.min(42, (width - left - 40) / count);
  const drawing = svg("svg", { viewBox: `0 0 ${left + count * box + 40} 34`, width: left + count * box + 40, height: 34, "aria-hidden": "true", color: "var(--ink)" });
  bands.colours.forEach((colour, k) => drawing.append(svg("rect", { x: left + k * box, y: 2, width: box, height: 12, fill: colour, stroke: "var(--line)", "stroke-width": 0.5 })));
  bands.thresholds.forEach((threshold, k) => drawing.append(label(left + (k + 1) * box, 28, String(threshold))));
  drawing.append(label(left + count * box + 6, 13, unit, "start"));
  return drawing;
}
