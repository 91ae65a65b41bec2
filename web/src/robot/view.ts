// The robot in three dimensions: drawn when something changes, not sixty times a second.
import { AmbientLight, Color, DirectionalLight, InstancedMesh, Matrix4, MeshLambertMaterial, PerspectiveCamera, Scene, SphereGeometry, Spherical, Vector3, WebGLRenderer, type Group } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Report, ScenePose, Vector } from "../data";
import { colour, onThemeChange } from "../theme";
import { Arrows } from "./arrows";
import { shapeOf } from "./shape";
import { Skeleton, sizeOf } from "./skeleton";
import { surroundings } from "./surroundings";

export interface Shown {
  pose: number;
  magnification: number;
  before: boolean;
  after: boolean;
  tilt: boolean;
}

/// Tilt is a matter of a thousandth of a rad: so many times more than errors it is magnified.
export const kTiltMore = 20;

const vector = (v: Vector) => new Vector3(...v);
const kColours = { base: "base", links: "links", plate: "accent", pointer: "ink", points: "muted", before: "before", after: "after", tilt: "yes" } as const;
type Materials = Record<keyof typeof kColours, MeshLambertMaterial>;

export class RobotView {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera: PerspectiveCamera;
  private readonly controls: OrbitControls;
  private readonly materials = Object.fromEntries(Object.keys(kColours).map((name) => [name, new MeshLambertMaterial()])) as Materials;
  private readonly skeleton: Skeleton;
  private readonly arrows: Record<"before" | "after" | "tilt", Arrows>;
  private readonly points: InstancedMesh;
  private readonly span: number;
  private around: Group | null = null;
  private pending = false;

  /// @throws where there is no WebGL.
  constructor(private readonly canvas: HTMLCanvasElement, private readonly report: Report, private readonly poses: ScenePose[], private shown: Shown) {
    const count = poses.length;
    this.span = Math.max(shapeOf(report.robot.workspace).radius, sizeOf(report.robot, poses).base / 2);
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.camera = new PerspectiveCamera(35, 1, this.span / 50, 40 * this.span);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableZoom = false; // the wheel scrolls the page
    this.controls.enablePan = false;
    this.controls.addEventListener("change", () => this.invalidate());
    this.skeleton = new Skeleton(report.robot, poses, this.materials);
    const thin = this.span / 160;
    this.arrows = { before: new Arrows(count, thin, this.materials.before), after: new Arrows(count, thin, this.materials.after), tilt: new Arrows(count, thin, this.materials.tilt) };
    this.points = new InstancedMesh(new SphereGeometry(1.8 * thin, 8, 5), this.materials.points, count);
    this.points.frustumCulled = false;
    poses.forEach((pose, k) => this.points.setMatrixAt(k, new Matrix4().setPosition(vector(pose.position_mm))));
    const sun = new DirectionalLight(0xffffff, 2.2);
    sun.position.set(1, -2, 3);
    this.scene.add(new AmbientLight(0xffffff, 1.6), sun, this.skeleton.object, this.points, ...Object.values(this.arrows).map((one) => one.object));
    this.paint();
    onThemeChange(() => { this.paint(); this.render(); });
    this.home();
    this.show(shown);
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  show(shown: Shown): void {
    this.shown = shown;
    const pose = this.poses[shown.pose];
    if (pose?.limbs) this.skeleton.stand(pose);
    const to = (start: Vector, error: Vector): [Vector3, Vector3] => [vector(start), vector(start).addScaledVector(vector(error), shown.magnification)];
    this.arrows.before.set(shown.before ? this.poses.map((one) => to(one.position_mm, one.before_mm)) : []);
    this.arrows.after.set(shown.after ? this.poses.flatMap((one) => (one.after_mm ? [to(one.position_mm, one.after_mm)] : [])) : []);
    this.arrows.tilt.set(shown.tilt ? this.poses.flatMap((one) => (one.tilt_rad ? [this.normal(one)] : [])) : []);
    this.invalidate();
  }

  /// Turns the view by angles in rad.
  turn(azimuth: number, polar: number): void {
    const place = new Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target).applyMatrix4(this.upright));
    place.theta += azimuth;
    place.phi = Math.min(Math.max(place.phi + polar, 0.05), Math.PI - 0.05);
    this.camera.position.copy(new Vector3().setFromSpherical(place).applyMatrix4(this.upright.clone().invert())).add(this.controls.target);
    this.controls.update();
  }

  zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).clampLength(0.8 * this.span, 12 * this.span).add(this.controls.target);
    this.controls.update();
  }

  home(): void {
    const shape = shapeOf(this.report.robot.workspace);
    const { above, base } = sizeOf(this.report.robot, this.poses), bottom = Math.min(shape.bottom, above), highest = Math.max(shape.top, above);
    const size = Math.max(highest - bottom, 2.4 * this.span, 1.8 * base);
    this.controls.target.set(0, 0, 0.5 * (bottom + highest));
    this.camera.position.copy(this.controls.target).add(new Vector3(1.05, -1.85, 0.55).multiplyScalar(size));
    this.controls.update();
    this.invalidate();
  }

  /// z up to y up, as Spherical wants it.
  private readonly upright = new Matrix4().makeRotationX(-Math.PI / 2);

  /// The plate's normal, turned by the magnified tilt, but by no more than 60 degrees.
  private normal({ position_mm, tilt_rad, normal }: ScenePose): [Vector3, Vector3] {
    const [x, y] = tilt_rad!, angle = Math.hypot(x, y), turned = Math.min(kTiltMore * angle * this.shown.magnification, Math.PI / 3);
    const upright = vector(normal ?? [0, 0, 1]), start = vector(position_mm);
    if (angle > 0) upright.applyAxisAngle(new Vector3(x, y, 0).divideScalar(angle), turned);
    return [start, start.clone().addScaledVector(upright, 0.16 * this.span)];
  }

  private paint(): void {
    for (const [name, variable] of Object.entries(kColours)) this.materials[name as keyof Materials].color = new Color(colour(variable));
    this.materials.plate.transparent = true;
    this.materials.plate.opacity = 0.85;
    if (this.around) this.scene.remove(this.around);
    this.around = surroundings(this.report.robot, this.span, colour("ink"), colour("muted"));
    this.scene.add(this.around);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.fov = width < height * 1.1 ? 35 * Math.min(1.6, (1.1 * height) / width) : 35;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  private invalidate(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => this.render());
  }

  private render(): void {
    this.pending = false;
    this.renderer.render(this.scene, this.camera);
    this.canvas.dataset.frames = String(this.renderer.info.render.frame);
  }
}
