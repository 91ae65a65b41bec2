// Thin solids from one point to another, any number of them in one draw call.
import { ConeGeometry, CylinderGeometry, Group, InstancedMesh, Matrix4, MeshLambertMaterial, Object3D, Quaternion, Vector3, type BufferGeometry } from "three";

export type Segment = [Vector3, Vector3];
const kSides = 6; // enough for an arrow, and light for computers without a graphics card
const kUp = new Vector3(0, 1, 0);

/// Turns the y axis of a solid of length 1 along a segment.
function along(from: Vector3, to: Vector3, thickness: number, target: Matrix4): Matrix4 {
  const direction = to.clone().sub(from), length = direction.length();
  const turn = new Quaternion().setFromUnitVectors(kUp, length > 0 ? direction.divideScalar(length) : kUp);
  return target.compose(from, turn, new Vector3(thickness, Math.max(length, 1e-9), thickness));
}

function standing(geometry: BufferGeometry): BufferGeometry {
  return geometry.translate(0, 0.5, 0);
}

export class Rods {
  readonly object: InstancedMesh;
  constructor(count: number, private readonly radius: number, material: MeshLambertMaterial, sides = kSides) {
    this.object = new InstancedMesh(standing(new CylinderGeometry(1, 1, 1, sides, 1, true)), material, count);
    this.object.frustumCulled = false;
  }
  set(segments: Segment[]): void {
    const matrix = new Matrix4();
    segments.forEach(([from, to], k) => this.object.setMatrixAt(k, along(from, to, this.radius, matrix)));
    this.object.count = segments.length;
    this.object.instanceMatrix.needsUpdate = true;
  }
}

/// Arrows whose heads keep their size while the shafts grow.
export class Arrows {
  readonly object: Object3D;
  private readonly shafts: Rods;
  private readonly heads: InstancedMesh;
  constructor(count: number, private readonly radius: number, material: MeshLambertMaterial) {
    this.shafts = new Rods(count, radius, material);
    this.heads = new InstancedMesh(standing(new ConeGeometry(1, 1, kSides, 1, true)), material, count);
    this.heads.frustumCulled = false;
    this.object = new Group().add(this.shafts.object, this.heads);
  }
  set(segments: Segment[]): void {
    const matrix = new Matrix4();
    const shafts = segments.map(([from, to], k): Segment => {
      const direction = to.clone().sub(from), length = direction.length();
      const head = Math.min(5 * this.radius, length);
      const neck = to.clone().addScaledVector(direction, length > 0 ? -head / length : 0);
      this.heads.setMatrixAt(k, along(neck, to, head / 2.2, matrix));
      return [from, neck];
    });
    this.heads.count = segments.length;
    this.heads.instanceMatrix.needsUpdate = true;
    this.shafts.set(shafts);
  }
}
