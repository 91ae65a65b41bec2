// The workspace as wires along its edges with its size, and the axes.
import { BufferGeometry, CanvasTexture, Group, Line, LineBasicMaterial, LineLoop, Sprite, SpriteMaterial, Vector3 } from "three";
import type { Robot } from "../data";
import { exact } from "../numbers";
import { shapeOf } from "./shape";

/// Words that always face the reader.
export function sign(text: string, colour: string, height: number): Sprite {
  const canvas = document.createElement("canvas"), context = canvas.getContext("2d")!;
  const font = "48px system-ui, sans-serif";
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 16;
  canvas.height = 64;
  context.font = font;
  context.fillStyle = colour;
  context.textBaseline = "middle";
  context.fillText(text, 8, 34);
  const sprite = new Sprite(new SpriteMaterial({ map: new CanvasTexture(canvas), transparent: true, depthTest: false }));
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  return sprite;
}

/// @param span  mm, of what is seen: how large words and axes are
export function surroundings(robot: Robot, span: number, ink: string, muted: string): Group {
  const group = new Group();
  const { rings, width, top, bottom } = shapeOf(robot.workspace);
  const line = (points: Vector3[]) => new BufferGeometry().setFromPoints(points), left = Math.min(...rings.flat().map(({ x }) => x)), right = Math.max(...rings.flat().map(({ x }) => x));
  const edges = new LineBasicMaterial({ color: muted, transparent: true, opacity: 0.8 });
  group.add(...rings.map((ring) => new LineLoop(line(ring), edges)));
  for (let k = 0; k < rings[0]!.length; k += Math.max(1, rings[0]!.length / 8)) group.add(new Line(line(rings.map((ring) => ring[k]!)), edges));
  const text = span / 7;
  const diameter = sign(width, muted, text);
  diameter.position.set(left - 0.45 * span, 0, top);
  const depth = sign(`${exact(top - bottom)} mm`, muted, text);
  depth.position.set(right + 0.3 * span, 0, (top + bottom) / 2);
  group.add(diameter, depth);
  const axes: [string, Vector3][] = [["x", new Vector3(1, 0, 0)], ["y", new Vector3(0, 1, 0)], ["z", new Vector3(0, 0, 1)]];
  for (const [name, direction] of axes) {
    const tip = direction.clone().multiplyScalar((direction.z > 0 ? 0.36 : 0.62) * span);
    group.add(new Line(line([new Vector3(), tip]), new LineBasicMaterial({ color: ink })));
    const letter = sign(name, ink, text);
    letter.position.copy(tip.multiplyScalar(1.2));
    group.add(letter);
  }
  return group;
}
