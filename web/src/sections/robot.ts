// The robot, its workspace and the errors at the poses, with what one turns and slides.
import type { Report, Scene, ScenePose } from "../data";
import { length } from "../report";
import { h } from "../dom";
import { figure, legend } from "../figure";
import { digits, exact } from "../numbers";
import { shapeOf } from "../robot/shape";
import { kTiltMore, RobotView, type Shown } from "../robot/view";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.robot;

/// So large that the largest error is a third of the workspace's radius, in steps 1, 2, 5.
function suitable(scene: Scene, radius: number): number {
  const largest = Math.max(...scene.poses.map((pose) => length(pose.before_mm)), 1e-6);
  const wanted = radius / 3 / largest, power = 10 ** Math.floor(Math.log10(wanted));
  return Math.max(1, [1, 2, 5].map((k) => k * power).filter((k) => k <= wanted).pop() ?? power);
}

/// More than rounding.
const tilts = ({ tilt_rad }: ScenePose) => tilt_rad !== null && Math.hypot(...tilt_rad) > 1e-9;

function readout(pose: ScenePose): string {
  const [x, y, z] = pose.position_mm.map(exact) as [string, string, string];
  const after = pose.after_mm ? digits(length(pose.after_mm), 2) : null;
  const tilt = tilts(pose) ? ` ${text.tilted(digits(1e3 * Math.hypot(...pose.tilt_rad!), 2))}` : "";
  const turned = pose.tilt_deg ? text.tiltedBy(pose.tilt_deg.map(exact)) : `\u03c6 ${exact(pose.rotation_deg)}\u00b0`;
  return `${text.readout(pose.pose, x, y, z, turned)} ${text.error(digits(length(pose.before_mm)), after)}${tilt}`;
}

function checkbox(name: string, kind: string, on: boolean, change: (on: boolean) => void): HTMLElement {
  const box = h("input", { type: "checkbox", id: `show-${kind}` });
  box.checked = on;
  box.addEventListener("change", () => change(box.checked));
  return h("label", {}, box, h("span", { class: `swatch ${kind}`, "aria-hidden": "true" }), name);
}

function errorsFigure(scene: Scene): HTMLElement {
  const tilts = scene.poses.some((pose) => pose.tilt_deg), turned = (pose: ScenePose) => (tilts ? pose.tilt_deg! : [pose.rotation_deg]);
  const rows = scene.poses.map((pose) => [pose.pose, ...pose.position_mm, ...turned(pose), ...pose.before_mm, ...(pose.after_mm ?? [null, null, null]), ...(pose.tilt_rad ?? [null, null])]);
  const columns = ["pose", "x_mm", "y_mm", "z_mm", ...(tilts ? ["tilt_x_deg", "tilt_y_deg", "tilt_z_deg"] : ["phi_deg"]), "before_x_mm", "before_y_mm", "before_z_mm", "after_x_mm", "after_y_mm", "after_z_mm", "tilt_x_rad", "tilt_y_rad"];
  const one = figure({ id: "robot-errors", title: text.table, shows: text.tableShows, marks: rows.length, sheet: { columns, rows }, draw: () => [] });
  one.querySelector(".drawing")!.remove();
  return one;
}

/// The canvas with its keys; the view itself is made when the browser has time, so that numbers stand first.
function stage(report: Report, scene: Scene, shown: Shown, controls: HTMLElement[]): { element: HTMLElement; apply: () => void; home: () => void } {
  const canvas = h("canvas", { tabindex: "0", role: "img", "aria-label": text.label(report.robot.name, scene.poses.length), id: "robot-view" });
  const element = h("div", { class: "stage" }, canvas, h("p", { class: "keys" }, text.keys));
  let view: RobotView | null = null;
  const keys: Record<string, (view: RobotView) => void> = {
    ArrowLeft: (v) => v.turn(-0.12, 0),
    ArrowRight: (v) => v.turn(0.12, 0),
    ArrowUp: (v) => v.turn(0, -0.1),
    ArrowDown: (v) => v.turn(0, 0.1),
    "+": (v) => v.zoom(0.9),
    "=": (v) => v.zoom(0.9),
    "-": (v) => v.zoom(1 / 0.9),
    Home: (v) => v.home(),
  };
  canvas.addEventListener("keydown", (event) => {
    const action = keys[event.key];
    if (!action || !view || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action(view);
  });
  requestAnimationFrame(() => {
    try {
      view = new RobotView(canvas, report, scene.poses, shown);
    } catch {
      element.replaceChildren(h("p", {}, text.none));
      for (const control of controls) control.remove();
    }
  });
  return { element, apply: () => view?.show(shown), home: () => view?.home() };
}

export function robot(report: Report): Section | null {
  const { scene } = report.figures;
  if (!scene || scene.poses.length === 0) return null;
  const shown: Shown = { pose: 0, magnification: suitable(scene, shapeOf(report.robot.workspace).radius), before: true, after: scene.measured, tilt: false };
  const says = h("p", { class: "readout", role: "status" });
  const standing = scene.poses.flatMap((pose, k) => (pose.limbs ? [{ pose, k }] : []));
  const choice = h("select", { id: "robot-pose" }, ...standing.map(({ pose, k }) => h("option", { value: String(k) }, pose.pose)));
  const slider = h("input", { type: "range", min: "0", max: "4", step: "0.01", value: String(Math.log10(shown.magnification)), id: "robot-magnification", "aria-label": text.magnify });
  const factor = h("output", { for: "robot-magnification" });
  const controls = h("div", { class: "controls" });
  const tilting = scene.poses.some(tilts);
  const kinds = [{ text: text.before, kind: "before" }, ...(scene.measured ? [{ text: text.after, kind: "after" }] : []), ...(tilting ? [{ text: text.tilt, kind: "tilt" }] : [])];
  const printed = h("div", { class: "print-only" });
  const { element, apply, home } = stage(report, scene, shown, [controls]);
  const magnified = () => text.magnified(shown.magnification, shown.tilt ? kTiltMore * shown.magnification : null);
  const update = () => {
    factor.replaceChildren(magnified());
    printed.replaceChildren(legend(kinds), magnified());
    slider.setAttribute("aria-valuetext", magnified());
    says.replaceChildren(readout(scene.poses[shown.pose]!));
    apply();
  };
  choice.addEventListener("change", () => { shown.pose = Number(choice.value); update(); });
  slider.addEventListener("input", () => { shown.magnification = 10 ** Number(slider.value); update(); });
  const switchable = (name: string, kind: "before" | "after" | "tilt") => checkbox(name, kind, shown[kind], (on) => { shown[kind] = on; update(); });
  const reset = h("button", { type: "button" }, text.reset);
  reset.addEventListener("click", home);
  controls.append(
    h("label", {}, text.pose, choice),
    h("label", {}, slider, factor),
    switchable(text.before, "before"),
    ...(scene.measured ? [switchable(text.after, "after")] : []),
    ...(tilting ? [switchable(text.tilt, "tilt")] : []),
    reset);
  update();
  return section("robot", strings.nav.robot, text.heading, scene.measured ? text.measured : text.predicted, element, controls, printed, says, errorsFigure(scene));
}
