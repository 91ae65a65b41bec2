// Maps over a layer of the workspace, seen from above: one cell a point of a polar grid.
import type { ErrorMap, SigmaMap } from "./data";
import { svg } from "./dom";
import type { Bands } from "./scale";

/// What both maps have.
type MapAxes = Pick<ErrorMap & SigmaMap, "radii_mm" | "azimuths_deg" | "layers_mm">;

export interface Disc {
  heading: string;
  row: string;
  values: number[]; ///< the axis, then the circles from inside out
}

const polar = (radius: number, azimuth: number) => `${(radius * Math.cos(azimuth)).toFixed(2)} ${(-radius * Math.sin(azimuth)).toFixed(2)}`;

/// The part of a ring about an azimuth.
function sector(inner: number, outer: number, azimuth: number, half: number): string {
  const [a, b] = [azimuth - half, azimuth + half];
  return `M${polar(inner, a)}L${polar(outer, a)}A${outer} ${outer} 0 0 0 ${polar(outer, b)}L${polar(inner, b)}A${inner} ${inner} 0 0 1 ${polar(inner, a)}Z`;
}

function cells(axes: MapAxes, values: number[], radius: number, bands: Bands): SVGElement[] {
  const rings = axes.radii_mm.length, spokes = axes.azimuths_deg.length, ring = radius / rings;
  return values.map((value, k) => {
    const i = Math.floor((k - 1) / spokes) + 1;
    const azimuth = ((axes.azimuths_deg[(k - 1) % spokes] ?? 0) * Math.PI) / 180;
    const shape = k === 0
      ? svg("circle", { r: ring / 2 })
      : svg("path", { d: sector((i - 0.5) * ring, Math.min(i + 0.5, rings) * ring, azimuth, Math.PI / spokes) });
    shape.setAttribute("fill", bands.colourOf(value));
    shape.setAttribute("class", "cell");
    return shape;
  });
}

const label = (x: number, y: number, text: string, anchor = "middle", extra: Record<string, string | number> = {}) =>
  svg("text", { x, y, "text-anchor": anchor, fill: "currentColor", "font-size": 11, ...extra }, text);

function ticks(x: number, y: number, radius: number, largest: number, axis: "x" | "y"): SVGElement[] {
  return [-1, 0, 1].map((k) => {
    const text = String(Math.round(k * largest)).replace("-", "\u2212");
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
  const largest = axes.radii_mm[axes.radii_mm.length - 1]!;
  const height = top + rows.length * rowHeight + 22;
  const totalWidth = left + columns * cellWidth + 16;
  const drawing = svg("svg", { viewBox: `0 0 ${totalWidth} ${height}`, width: totalWidth, height, "aria-hidden": "true", color: "var(--ink)" });
  rows.forEach((row, r) => {
    const y = top + r * rowHeight + radius + 4;
    drawing.append(...ticks(left - 4, y, radius, largest, "y"));
    drawing.append(label(13, y, axisNames[1], "middle", { transform: `rotate(-90 13 ${y})`, fill: "var(--muted)" }));
    const shared = columns > 1 && row.every((disc) => disc.row === row[0]!.row);
    row.forEach((disc, c) => {
      const x = left + c * cellWidth + cellWidth / 2;
      if (r === 0 && disc.heading) drawing.append(label(x, 12, disc.heading, "middle", { "font-weight": 600 }));
      drawing.append(svg("g", { transform: `translate(${x} ${y})` }, ...cells(axes, disc.values, radius, bands), svg("circle", { r: radius, fill: "none", stroke: "var(--line)" })));
      if (disc.row && !shared) drawing.append(label(x, y + radius + 14, disc.row, "middle", { fill: "var(--muted)" }));
    });
    if (shared) drawing.append(label(left + (columns * cellWidth) / 2, y + radius + 14, row[0]!.row, "middle", { fill: "var(--muted)" }));
  });
  const bottom = top + rows.length * rowHeight + 8;
  for (let c = 0; c < columns; ++c) {
    const x = left + c * cellWidth + cellWidth / 2;
    drawing.append(...ticks(x, bottom, radius, largest, "x"), label(x, bottom + 13, axisNames[0], "middle", { fill: "var(--muted)" }));
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
