// The workspace as a wire cylinder with its size, and the axes.
import { BufferGeometry, CanvasTexture, Group, Line, LineBasicMaterial, LineLoop, Sprite, SpriteMaterial, Vector3 } from "three";
import type { Robot } from "../data";
import { exact } from "../numbers";

export function circle(radius: number, z: number): BufferGeometry {
  const points = Array.from({ length: 96 }, (_, k) => new Vector3(radius * Math.cos((k * Math.PI) / 48), radius * Math.sin((k * Math.PI) / 48), z));
  return new BufferGeometry().setFromPoints(points);
}

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
  const { radius_mm: radius, height_mm: height, top_z_mm: top } = robot.workspace;
  const edges = new LineBasicMaterial({ color: muted, transparent: true, opacity: 0.8 });
  group.add(new LineLoop(circle(radius, top), edges), new LineLoop(circle(radius, top - height), edges));
  for (let k = 0; k < 8; ++k) {
    const [x, y] = [radius * Math.cos((k * Math.PI) / 4), radius * Math.sin((k * Math.PI) / 4)];
    group.add(new Line(new BufferGeometry().setFromPoints([new Vector3(x, y, top), new Vector3(x, y, top - height)]), edges));
  }
  const text = span / 7;
  const diameter = sign(`\u2300 ${exact(2 * radius)} mm`, muted, text);
  diameter.position.set(-radius - 0.45 * span, 0, top);
  const depth = sign(`${exact(height)} mm`, muted, text);
  depth.position.set(radius + 0.3 * span, 0, top - height / 2);
  group.add(diameter, depth);
  const axes: [string, Vector3][] = [["x", new Vector3(1, 0, 0)], ["y", new Vector3(0, 1, 0)], ["z", new Vector3(0, 0, 1)]];
  for (const [name, direction] of axes) {
    const tip = direction.clone().multiplyScalar((direction.z > 0 ? 0.36 : 0.62) * span);
    group.add(new Line(new BufferGeometry().setFromPoints([new Vector3(), tip]), new LineBasicMaterial({ color: ink })));
    const letter = sign(name, ink, text);
    letter.position.copy(tip.multiplyScalar(1.2));
    group.add(letter);
  }
  return group;
}
