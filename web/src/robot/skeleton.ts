// Base, arms, parallelograms and plate of the nominal robot at a pose.
import { BufferAttribute, BufferGeometry, DoubleSide, Group, InstancedMesh, Matrix4, Mesh, MeshLambertMaterial, Object3D, SphereGeometry, TorusGeometry, Vector3 } from "three";
import type { Robot, ScenePose, Vector } from "../data";
import { Rods, type Segment } from "./arrows";

const kRound = 16;
const vector = (v: Vector) => new Vector3(...v);

/// Corners in the order of their azimuth about their middle, as a fan.
function plateGeometry(corners: Vector3[]): BufferGeometry {
  const middle = corners.reduce((sum, corner) => sum.add(corner), new Vector3()).divideScalar(corners.length);
  const ordered = [...corners].sort((a, b) => Math.atan2(a.y - middle.y, a.x - middle.x) - Math.atan2(b.y - middle.y, b.x - middle.x));
  const points = ordered.flatMap((corner, k) => [middle, corner, ordered[(k + 1) % ordered.length]!]).flatMap((p) => p.toArray());
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  geometry.computeVertexNormals();
  return geometry;
}

/// From the endstops down to the bottom of the workspace.
function rails(robot: Robot, thickness: number, material: MeshLambertMaterial): Object3D {
  const { base_radius_mm: radius, limb_azimuth_deg: azimuths } = robot.geometry;
  const bottom = robot.workspace.top_z_mm - robot.workspace.height_mm;
  const rods = new Rods(azimuths.length, thickness, material, kRound);
  rods.set(azimuths.map((degrees): Segment => {
    const angle = (degrees * Math.PI) / 180, foot = new Vector3(radius * Math.cos(angle), radius * Math.sin(angle), bottom);
    return [foot, foot.clone().setZ(0)];
  }));
  return rods.object;
}

export class Skeleton {
  readonly object = new Group();
  private readonly arms: Rods;
  private readonly rods: Rods;
  private readonly pointer: Rods;
  private readonly joints: InstancedMesh;
  private readonly plate: Mesh;

  constructor(private readonly robot: Robot, readonly material: { links: MeshLambertMaterial; plate: MeshLambertMaterial; base: MeshLambertMaterial; pointer: MeshLambertMaterial }) {
    const limbs = robot.geometry.limb_azimuth_deg.length, size = robot.geometry.rod_mm / 950;
    this.arms = new Rods(limbs, 11 * size, material.links, kRound);
    this.rods = new Rods(4 * limbs, 5 * size, material.links, kRound);
    this.pointer = new Rods(1, 6 * size, material.pointer, kRound);
    this.joints = new InstancedMesh(new SphereGeometry(14 * size, 16, 12), material.base, 2 * limbs);
    this.joints.frustumCulled = false;
    this.plate = new Mesh(new BufferGeometry(), material.plate);
    material.plate.side = DoubleSide;
    const base = robot.geometry.actuator === "linear" ? rails(robot, 9 * size, material.base) : new Mesh(new TorusGeometry(robot.geometry.base_radius_mm, 9 * size, 10, 72), material.base);
    this.object.add(base, this.arms.object, this.rods.object, this.pointer.object, this.joints, this.plate);
  }

  stand(pose: ScenePose): void {
    const limbs = pose.limbs ?? [];
    this.arms.set(limbs.map((limb) => [vector(limb.base_mm), vector(limb.elbow_mm)]));
    this.rods.set(limbs.flatMap(({ rods_mm: [one, other] }) => [one, other, [one[0], other[0]], [one[1], other[1]]].map(([from, to]): Segment => [vector(from!), vector(to!)])));
    limbs.forEach((limb, k) => {
      this.joints.setMatrixAt(2 * k, new Matrix4().setPosition(vector(limb.base_mm)));
      this.joints.setMatrixAt(2 * k + 1, new Matrix4().setPosition(vector(limb.elbow_mm)));
    });
    this.joints.instanceMatrix.needsUpdate = true;
    this.plate.geometry.dispose();
    this.plate.geometry = plateGeometry(limbs.flatMap((limb) => limb.rods_mm.map(([, to]) => vector(to))));
    const centre = vector(pose.position_mm), angle = (pose.rotation_deg * Math.PI) / 180;
    const reach = 1.6 * this.robot.geometry.plate_radius_mm + 40;
    this.pointer.set(this.robot.plate ? [[centre, centre.clone().add(new Vector3(Math.cos(angle), Math.sin(angle), 0).multiplyScalar(reach))]] : []);
  }
}
