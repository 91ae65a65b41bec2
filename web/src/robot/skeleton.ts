// Base, arms, rails, parallelograms or single rods, and plate of the nominal robot at a pose.
import { BufferAttribute, BufferGeometry, DoubleSide, Group, InstancedMesh, Matrix4, Mesh, MeshLambertMaterial, Object3D, SphereGeometry, TorusGeometry, Vector3 } from "three";
import type { Robot, ScenePose, SingleRodOnARail, Vector } from "../data";
import { singleRodsOf, type SingleRod } from "../report";
import { Rods, type Segment } from "./arrows";
import { shapeOf } from "./shape";

const kRound = 16;
const vector = (v: Vector) => new Vector3(...v);

/// How large the parts of a robot are.
export interface Size {
  base: number; ///< radius of its joints
  plate: number;
  rod: number;
  above: number; ///< how high arms reach above the base
}

const lengthOf = (limb: SingleRod) => (limb.kind === "strut" ? limb.length_at_zero_mm : limb.rod_mm);
const isOnRail = (limb: SingleRod): limb is SingleRodOnARail => limb.kind === "rail";

/// Where a limb begins at all poses: of a rail, its carriage.
const beginnings = (poses: ScenePose[], limb: number): Vector3[] => poses.flatMap(({ limbs }) => (limbs?.[limb] ? [vector(limbs[limb].base_mm)] : []));

export function sizeOf(robot: Robot, poses: ScenePose[]): Size {
  if (robot.geometry) return { base: robot.geometry.base_radius_mm, plate: robot.geometry.plate_radius_mm, rod: robot.geometry.rod_mm, above: robot.geometry.arm_mm / 2 }; // arms seldom stand steeper
  const limbs = singleRodsOf(robot), hangs = shapeOf(robot.workspace).top < 0, largest = (of: (limb: SingleRod) => number) => Math.max(...limbs.map(of));
  return {
    base: Math.max(...limbs.flatMap((limb, k) => [vector(limb.base_joint_mm), ...(isOnRail(limb) ? beginnings(poses, k) : [])]).map(({ x, y }) => Math.hypot(x, y))),
    plate: largest(({ plate_joint_mm: [x, y] }) => Math.hypot(x, y)),
    rod: largest(lengthOf),
    above: largest((limb) => limb.base_joint_mm[2] + (hangs && limb.kind === "arm" ? limb.arm_mm / 2 : 0)),
  };
}

const middleOf = (corners: Vector3[]) => corners.reduce((sum, corner) => sum.add(corner), new Vector3()).divideScalar(corners.length);

/// From corner to corner in the order of their azimuth about their middle.
function edges(corners: Vector3[]): Segment[] {
  const middle = middleOf(corners);
  const ordered = [...corners].sort((a, b) => Math.atan2(a.y - middle.y, a.x - middle.x) - Math.atan2(b.y - middle.y, b.x - middle.x));
  return ordered.map((corner, k) => [corner, ordered[(k + 1) % ordered.length]!]);
}

/// A fan about the middle.
function plateGeometry(corners: Vector3[]): BufferGeometry {
  const middle = middleOf(corners);
  const points = edges(corners).flatMap((edge) => [middle, ...edge]).flatMap((p) => p.toArray());
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  geometry.computeVertexNormals();
  return geometry;
}

/// From the endstops down to the bottom of the workspace.
function rails(robot: Robot, azimuths: number[], thickness: number, material: MeshLambertMaterial): Object3D {
  const radius = sizeOf(robot, []).base;
  const { bottom } = shapeOf(robot.workspace);
  const rods = new Rods(azimuths.length, thickness, material, kRound);
  rods.set(azimuths.map((degrees): Segment => {
    const angle = (degrees * Math.PI) / 180, foot = new Vector3(radius * Math.cos(angle), radius * Math.sin(angle), bottom);
    return [foot, foot.clone().setZ(0)];
  }));
  return rods.object;
}

/// A rail as far as its carriage goes, and a little farther.
function along(limb: SingleRod, carriages: Vector3[]): Segment {
  const base = vector(limb.base_joint_mm), direction = vector(isOnRail(limb) ? limb.direction : [0, 0, 1]).normalize(), end = 0.05 * lengthOf(limb);
  const places = carriages.map((one) => one.clone().sub(base).dot(direction));
  const at = (place: number) => base.clone().addScaledVector(direction, place);
  return places.length > 0 ? [at(Math.min(...places) - end), at(Math.max(...places) + end)] : [at(-end), at(end)];
}

function baseOf(robot: Robot, poses: ScenePose[], thickness: number, material: MeshLambertMaterial): Object3D {
  if (!robot.geometry) {
    const limbs = singleRodsOf(robot), corners = limbs.map((one) => vector(one.base_joint_mm)), rods = new Rods(corners.length, thickness, material, kRound);
    rods.set(limbs.some(isOnRail) ? limbs.map((one, k) => along(one, beginnings(poses, k))) : edges(corners));
    return rods.object;
  }
  if (robot.geometry.actuator === "linear") return rails(robot, robot.geometry.limb_azimuth_deg, thickness, material);
  return new Mesh(new TorusGeometry(robot.geometry.base_radius_mm, thickness, 10, 72), material);
}

export class Skeleton {
  readonly object = new Group();
  private readonly arms: Rods;
  private readonly rods: Rods;
  private readonly pointer: Rods;
  private readonly joints: InstancedMesh;
  private readonly plate: Mesh;

  constructor(private readonly robot: Robot, poses: ScenePose[], readonly material: { links: MeshLambertMaterial; plate: MeshLambertMaterial; base: MeshLambertMaterial; pointer: MeshLambertMaterial }) {
    const limbs = robot.geometry?.limb_azimuth_deg.length ?? singleRodsOf(robot).length, size = sizeOf(robot, poses).rod / 950;
    this.arms = new Rods(limbs, 11 * size, material.links, kRound);
    this.rods = new Rods(4 * limbs, (robot.geometry ? 5 : 9) * size, material.links, kRound);
    this.pointer = new Rods(1, 6 * size, material.pointer, kRound);
    this.joints = new InstancedMesh(new SphereGeometry(14 * size, 16, 12), material.base, 2 * limbs);
    this.joints.frustumCulled = false;
    this.plate = new Mesh(new BufferGeometry(), material.plate);
    material.plate.side = DoubleSide;
    this.object.add(baseOf(robot, poses, 9 * size, material.base), this.arms.object, this.rods.object, this.pointer.object, this.joints, this.plate);
  }

  stand(pose: ScenePose): void {
    const limbs = pose.limbs ?? [];
    const across = ([one, other]: [Vector, Vector][]): [Vector, Vector][] => (one && other ? [[one[0], other[0]], [one[1], other[1]]] : []);
    this.arms.set(limbs.flatMap(({ base_mm: base, elbow_mm: elbow }): Segment[] => (elbow ? [[vector(base), vector(elbow)]] : [])));
    this.rods.set(limbs.flatMap(({ rods_mm: rods }) => [...rods, ...across(rods)].map(([from, to]): Segment => [vector(from), vector(to)])));
    limbs.forEach((limb, k) => {
      this.joints.setMatrixAt(2 * k, new Matrix4().setPosition(vector(limb.base_mm)));
      this.joints.setMatrixAt(2 * k + 1, new Matrix4().setPosition(vector(limb.elbow_mm ?? limb.rods_mm[0]![1])));
    });
    this.joints.instanceMatrix.needsUpdate = true;
    this.plate.geometry.dispose();
    this.plate.geometry = plateGeometry(limbs.flatMap((limb) => limb.rods_mm.map(([, to]) => vector(to))));
    const centre = vector(pose.position_mm), angle = (pose.rotation_deg * Math.PI) / 180;
    const reach = 1.6 * sizeOf(this.robot, []).plate + 40;
    this.pointer.set(this.robot.plate ? [[centre, centre.clone().add(new Vector3(Math.cos(angle), Math.sin(angle), 0).multiplyScalar(reach))]] : []);
  }
}
