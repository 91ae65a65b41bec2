// What the half-widths of the parts cost in accuracy.
import { h, table } from "../dom";
import { digits, percent } from "../numbers";
import type { Section } from "../section";
import { button, field, save, select, slider, type Slider } from "./parts";
import { strings } from "./strings";
import { AnswerPlace, askedBy, text, toolSection, type Around, type Question } from "./tool";

const words = strings.tools.tolerances;
const kMachines = 200; // few enough to answer while a slider is dragged
const kLimits: Record<string, { key: string; unit: string; value: string }> = {
  tilt: { key: "limit_rad", unit: "rad", value: "0.001" },
  position: { key: "limit_mm", unit: "mm", value: "30" },
  "position-compensated": { key: "limit_mm", unit: "mm", value: "0.5" },
};

interface AnalysisAnswer {
  requirements: { unit: string; worst_case: number; rss_3sigma: number; monte_carlo_3sigma: number; contributors: { name: string; share: number }[] }[];
  dpmo: { value: number; low: number; high: number };
}

function show({ requirements: [one], dpmo: beyond }: AnalysisAnswer): Node[] {
  const { unit, contributors } = one!;
  const bar = (value: number) => {
    const element = h("div", { class: "bar" });
    element.style.width = `${8 * value}rem`;
    return element;
  };
  const shown = contributors.filter((contributor) => contributor.share > 0.0005);
  return [
    table(words.columns, [
      [words.worst(unit), digits(one!.worst_case)],
      [words.rss(unit), digits(one!.rss_3sigma)],
      [words.drawn(unit), digits(one!.monte_carlo_3sigma)],
      [words.beyond, words.between(digits(beyond.value), digits(beyond.low), digits(beyond.high))],
    ], words.caption, [1]),
    h("h3", {}, words.contributors),
    table(words.contributorColumns, shown.map(({ name, share: part }) => [name, percent(part), bar(part)]), words.contributors, [1]),
  ];
}

/// Widths as a file of tolerances.
const asToml = (widths: [string, number][], distribution: string) =>
  `[tolerances]\n${widths.map(([key, value]) => `${key} = ${value}\n`).join("")}distribution = "${distribution}"\n`;

interface Stated {
  tolerances?: Record<string, unknown>;
}

export function tolerances(around: Around): Section & { ask(): void } {
  const grid = h("div", { class: "sliders" });
  const quantity = select(Object.entries(words.quantities)), limit = h("input", { type: "number", step: "any", min: "0", required: "" });
  const limitField = h("span", {});
  const place = new AnswerPlace((answer) => show(answer as AnalysisAnswer));
  let sliders: [string, Slider, number][] = [], distribution = "normal";

  const setLimit = () => {
    const { unit, value } = kLimits[quantity.value]!;
    limit.value = value;
    limitField.replaceChildren(field(words.limit(unit), limit));
  };
  const widths = () => sliders.map(([key, one]): [string, number] => [key, one.value()]);
  const question = (): Question => {
    const robot = around.robot(), { key } = kLimits[quantity.value]!;
    const problem = `[[requirement]]\nquantity = "${quantity.value}"\n${key} = ${limit.value || "0"}\n`;
    return {
      words: ["tolerance", "analyze", ...robot.words, "--tolerances", "tolerances.toml", "--problem", "requirement.toml", "--max-machines", String(kMachines), "--failure-error", "0.5", "--json"],
      files: { ...robot.files, "tolerances.toml": text(asToml(widths(), distribution)), "requirement.toml": text(problem) },
    };
  };
  quantity.addEventListener("input", setLimit); // before it is asked about
  const ask = askedBy({ ...around, robotChanged: () => undefined }, [quantity, limit, grid], place, question);

  /// Sliders for what the robot states.
  const restate = async () => {
    const robot = around.robot();
    const { code, stdout } = await around.program.run(["robot", ...robot.words, "--json"], robot.files);
    const stated = code === 0 ? ((JSON.parse(stdout) as Stated).tolerances ?? {}) : {};
    distribution = typeof stated.distribution === "string" ? stated.distribution : "normal";
    sliders = Object.entries(stated).flatMap(([key, value]): [string, Slider, number][] =>
      typeof value !== "number" || value <= 0 ? [] : [[key, slider(key, { min: 0, max: 2 * value, step: value / 50, value }, (now) => digits(now)), value]]);
    grid.replaceChildren(...(sliders.length > 0 ? sliders.map(([, one]) => one.element) : [h("p", {}, words.none)]));
    if (sliders.length > 0) ask();
  };
  const reset = () => {
    for (const [, one, value] of sliders) one.set(value);
    ask();
  };
  setLimit();
  around.robotChanged(() => void restate());
  const element = toolSection("tolerances", strings.nav.tolerances, words.heading, words.intro,
    h("div", { class: "row" }, field(words.quantity, quantity), limitField, button(words.reset, reset), button(words.save, () => save("tolerances.toml", asToml(widths(), distribution), "text/plain"))),
    grid, h("p", { class: "muted" }, words.machines(kMachines)), place.element);
  return { ...element, ask: () => void restate() };
}
