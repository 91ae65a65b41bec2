// How far each drive is off along its stroke, where that belongs to the machine.
import { areaY, dot, line, ruleY } from "@observablehq/plot";
import type { Calibration, Report, SplineOfADrive } from "../data";
import { h } from "../dom";
import { figure } from "../figure";
import { digits } from "../numbers";
import { draw } from "../plot";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.drives;
const kPerSpacing = 8; // points of a curve

/// A cubic B-spline, x spacings from its centre.
function bump(x: number): number {
  const away = Math.abs(x);
  if (away >= 2) return 0;
  return away < 1 ? 2 / 3 - away * away * (1 - away / 2) : (2 - away) ** 3 / 6;
}

interface Point {
  joint: number;
  off: number;
  U: number;
  isKnot: boolean;
}

/// Of the splines of one limb; `first` is the place of the first of them among all.
/// U is about the curve: of its offset d from an even drive the readings confirm g, so that g d d^T leaves the covariance.
function curve(splines: SplineOfADrive[], first: number, { drive_covariance, parameters, omitted_poses }: Calibration): Point[] {
  const sought = parameters.filter((one) => one.status !== "fixed").length, gain = 1 - (omitted_poses!.with_drives_mm / omitted_poses!.rigid_mm) ** 2;
  const covariance = splines.map((_, k) => splines.map((__, j) => drive_covariance![first + k]![sought + first + j]!));
  const { spacing } = splines[0]!, low = splines[0]!.centre + spacing, count = (splines.length - 3) * kPerSpacing;
  return Array.from({ length: count + 1 }, (_, n) => {
    const joint = low + (n * spacing) / kPerSpacing, by = splines.map(({ centre }) => bump((joint - centre) / spacing));
    const off = splines.reduce((sum, { size }, k) => sum + size! * by[k]!, 0);
    const square = covariance.reduce((sum, row, k) => sum + by[k]! * row.reduce((part, value, j) => part + value * by[j]!, 0), 0);
    return { joint, off, U: 2 * Math.sqrt(Math.max(0, square - gain * off * off)), isKnot: n % kPerSpacing === 0 };
  });
}

function driveFigure(limb: number, unit: string, points: Point[], most: number): HTMLElement {
  const knots = points.filter(({ isKnot }) => isKnot), size = Math.max(...points.map(({ off }) => Math.abs(off)));
  return figure({
    id: `drive-${limb}`,
    title: text.title(limb),
    shows: text.shows(digits(size, 2), digits(Math.max(...points.map(({ U }) => U)), 2), unit),
    marks: knots.length,
    sheet: { columns: text.columns(unit), rows: points.map(({ joint, off, U }) => [joint, off, U]) },
    draw: (width) =>
      draw({
        width,
        height: 220,
        x: { label: text.joint(limb, unit), ticks: 6 },
        y: { label: text.off(unit), domain: [-most, most], grid: true, ticks: 5 },
        marks: [
          areaY(points, { x: "joint", y1: ({ off, U }: Point) => off - U, y2: ({ off, U }: Point) => off + U, fill: "var(--prior)" }),
          ruleY([0], { stroke: "var(--muted)" }),
          line(points, { x: "joint", y: "off", stroke: "var(--after)" }),
          dot(knots, { x: "joint", y: "off", r: 3, fill: "var(--after)" }),
        ],
      }),
  });
}

export function drives({ results }: Report): Section | null {
  const { calibration } = results;
  if (!calibration?.uses_drives || !calibration.drive_covariance) return null;
  const limbs = [...new Set(calibration.drives.map(({ limb }) => limb))];
  const curves = limbs.map((limb) => {
    const own = calibration.drives.filter((one) => one.limb === limb);
    return { limb, unit: own[0]!.unit, points: curve(own, calibration.drives.indexOf(own[0]!), calibration) };
  });
  const most = 1.05 * Math.max(...curves.flatMap(({ points }) => points.map(({ off, U }) => Math.abs(off) + U)));
  const { poses, rigid_mm, with_drives_mm } = calibration.omitted_poses!;
  return section("drives", strings.nav.drives, text.heading, text.intro(poses, digits(rigid_mm, 2), digits(with_drives_mm, 2)),
    h("div", { class: "pair" }, ...curves.map(({ limb, unit, points }) => driveFigure(limb, unit, points, most))));
}
