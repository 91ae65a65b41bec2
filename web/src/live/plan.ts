// How well a machine will be known from so many poses.
import { h, svg, table } from "../dom";
import { digits } from "../numbers";
import type { Section } from "../section";
import { button, field, save, select, slider } from "./parts";
import type { Files } from "./process";
import { strings } from "./strings";
import { AnswerPlace, askedBy, toolSection, type Around, type Question } from "./tool";

const words = strings.tools.plan;
const kCandidates = 300; // few enough to answer while a slider is dragged
/// What asks for nothing but poses; a ball bar and a dial want to know where they stand, which a command can say.
export const kMeasures = ["coordinates", "pose", "home-distance", "height"];
const kDefaultSigma = 0.02; // mm

type Spread = Record<"rms_distance_mm" | "max_distance_mm" | "rms_aligned_mm" | "max_aligned_mm" | "rms_rotation_deg" | "max_rotation_deg", number>;
interface PlanAnswer {
  n: number;
  workspace_std: Spread;
  curve: (Spread & { n: number })[];
  poses: Record<string, string | number>[];
}

/// The curve, from nought upwards: numbers beside it say what it shows.
function curve(points: { n: number; value: number }[]): SVGElement {
  const width = 480, height = 190, left = 52, bottom = 34, top = 22;
  const last = points.at(-1)!, largest = Math.max(...points.map(({ value }) => value));
  const x = (n: number) => left + ((width - left - 12) * n) / last.n, y = (value: number) => height - bottom - ((height - bottom - top) * value) / largest;
  const at = (px: number, py: number, anchor: string, content: string) => svg("text", { x: px, y: py, "text-anchor": anchor }, content);
  return svg("svg", { viewBox: `0 0 ${width} ${height}`, class: "curve", "aria-hidden": "true" },
    svg("path", { class: "axis", fill: "none", d: `M${left} ${top}V${height - bottom}H${width - 12}` }),
    svg("polyline", { points: points.map(({ n, value }) => `${x(n)},${y(value)}`).join(" ") }),
    svg("circle", { cx: x(last.n), cy: y(last.value), r: 4 }),
    at(left - 6, y(largest) + 4, "end", digits(largest, 2)), at(left - 6, y(0) + 4, "end", "0"), at(left, 12, "start", words.axis),
    at(x(0), height - bottom + 16, "middle", "0"), at(x(last.n), height - bottom + 16, "middle", String(last.n)), at((left + width) / 2, height - 4, "middle", words.n));
}

function show({ n, workspace_std: std, curve: all }: PlanAnswer): Node[] {
  const row = (name: string, rms: keyof Spread, max: keyof Spread) => [words.names[name]!, digits(std[rms], 3), digits(std[max], 3)];
  return [
    table(words.columns, [row("distance", "rms_distance_mm", "max_distance_mm"), row("aligned", "rms_aligned_mm", "max_aligned_mm"), row("rotation", "rms_rotation_deg", "max_rotation_deg")], words.caption, [1, 2]),
    h("p", { class: "muted" }, words.curve(n, digits(std.rms_distance_mm, 3))),
    curve(all.map((one) => ({ n: one.n, value: one.rms_distance_mm }))),
  ];
}

export interface Plan extends Section {
  ask(): void;
  /// The table of the plan's poses, made by the program.
  poses(): Promise<{ n: number; table: Uint8Array }>;
  changed(listener: () => void): void;
}

export function plan(around: Around): Plan {
  const count = slider(words.poses, { min: 3, max: 60, step: 1, value: 20 }, String);
  const measure = select(kMeasures.map((name) => [name, name]));
  const sigma = slider(words.sigma, { min: 0.005, max: 0.2, step: 0.005, value: kDefaultSigma }, (value) => value.toFixed(3));
  const place = new AnswerPlace((answer) => show(answer as PlanAnswer));
  const sigmaOption = () => [measure.value === "height" ? "--height-sigma-mm" : "--sigma-mm", String(sigma.value())];
  const asked = (): Question => {
    const robot = around.robot();
    return { words: ["poses", ...robot.words, "--optimal", String(count.value()), "--candidates", String(kCandidates), "--measure", measure.value, ...sigmaOption()], files: robot.files };
  };
  const controls = [count.input, measure, sigma.input];
  const ask = askedBy(around, controls, place, () => ({ ...asked(), words: [...asked().words, "--json"] }));

  const kFile = "plan.csv";
  let made: { line: string; files: Promise<Files> } | undefined;
  const file = async () => {
    const { words: line, files } = asked();
    if (made?.line !== line.join(" ")) made = { line: line.join(" "), files: around.program.run([...line, "--out", kFile], files).then((result) => result.files) };
    return (await made.files)[kFile]!;
  };
  const element = toolSection("plan", strings.nav.plan, words.heading, words.intro,
    h("div", { class: "sliders" }, count.element, sigma.element), h("div", { class: "row" }, field(words.measure, measure), button(words.save, () => void file().then((data) => save(kFile, data, "text/csv")))),
    h("p", { class: "muted" }, words.candidates(kCandidates)), place.element);
  return {
    ...element,
    ask,
    poses: async () => ({ n: count.value(), table: await file() }),
    changed: (listener) => controls.forEach((control) => control.addEventListener("input", listener)),
  };
}
