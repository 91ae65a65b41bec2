// The shape of the workspace, of whichever kind.
import { Vector3 } from "three";
import type { Workspace } from "../data";
import { exact } from "../numbers";

export interface Shape {
  rings: Vector3[][]; ///< level edges of its wall, from the top down
  width: string;
  radius: number; ///< of the cylinder around it
  top: number;
  bottom: number;
}

const circle = (radius: number, z: number) => Array.from({ length: 96 }, (_, k) => new Vector3(radius * Math.cos((k * Math.PI) / 48), radius * Math.sin((k * Math.PI) / 48), z));

export function shapeOf(workspace: Workspace): Shape {
  const { x_mm: x, y_mm: y, z_mm: z, radius_mm: radius = 0, height_mm: height = 0, top_z_mm: top = 0 } = workspace;
  if (x && y && z) {
    const size = [x[1] - x[0], y[1] - y[0]] as const, [bottom, top] = z;
    const rings = [top, bottom].map((level) => [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(([px, py]) => new Vector3(px, py, level)));
    return { rings, width: `${exact(size[0])} \u00d7 ${exact(size[1])} mm`, radius: Math.hypot(...size) / 2, top, bottom };
  }
  const heights = workspace.heights_mm ?? [top, top - height], radii = workspace.radii_mm ?? [radius, radius], largest = Math.max(...radii);
  return { rings: heights.map((level, k) => circle(radii[k]!, level)), width: `\u2300 ${exact(2 * largest)} mm`, radius: largest, top: heights[0]!, bottom: heights[heights.length - 1]! };
}
