// What the readings of a plan will show of a machine, and what they cannot.
import { h, table } from "../dom";
import { digits, percent } from "../numbers";
import type { Section } from "../section";
import type { Plan } from "./plan";
import { kMeasures } from "./plan";
import { field, select } from "./parts";
import type { Files } from "./process";
import { strings } from "./strings";
import { AnswerPlace, askedBy, toolSection, type Around, type Question } from "./tool";

const words = strings.tools.seen;

interface SeenAnswer {
  rank: number;
  rows: number;
  parameters: { name: string; limb: number; unit: string; prior_std: number | null; std: number | null; data_share: number }[];
  null_space: { text: string }[];
}

const number = (value: number | null) => (value === null ? "\u2013" : digits(value, 3));

function show({ rank, rows, parameters, null_space: hidden }: SeenAnswer): Node[] {
  return [
    h("p", {}, h("strong", {}, words.rank(rank, rows, parameters.length))),
    hidden.length === 0 ? h("p", {}, words.all) : h("p", {}, words.hidden(hidden.length)),
    h("ul", {}, ...hidden.map(({ text }) => h("li", {}, text))),
    table(words.columns, parameters.map((one) => [one.name, String(one.limb), number(one.prior_std), number(one.std), one.unit, percent(one.data_share, 2)]), words.caption, [1, 2, 3, 5]),
  ];
}

/// @param tables  the tables of poses that were dropped.
export function seen(around: Around, plan: Plan, tables: () => Files): Section & { ask(): void; tablesChanged(): void } {
  const poses = select([["", ""]]), measure = select(kMeasures.map((name) => [name, name]));
  const frame = select([["unknown", "unknown"], ["robot", "robot"]]);
  const rotation = select(["none", "relative", "absolute"].map((name) => [name, name]));
  const second = h("input", { type: "checkbox" });
  const place = new AnswerPlace((answer) => show(answer as SeenAnswer));

  const question = async (): Promise<Question> => {
    const robot = around.robot(), own = tables()[poses.value];
    const name = own ? poses.value : "plan.csv", data = own ?? (await plan.poses()).table;
    const coordinates = measure.value === "coordinates" ? ["--frame", frame.value, ...(second.checked ? ["--second"] : [])] : [];
    return { words: ["identifiability", ...robot.words, "--poses", name, "--measure", measure.value, ...coordinates, "--rotation", rotation.value, "--json"], files: { ...robot.files, [name]: data } };
  };
  const ask = askedBy(around, [poses, measure, frame, rotation, second], place, question);

  const tablesChanged = async () => {
    const chosen = poses.value, { n } = await plan.poses();
    poses.replaceChildren(h("option", { value: "" }, words.planned(n)), ...Object.keys(tables()).map((name) => h("option", { value: name }, name)));
    poses.value = chosen in tables() ? chosen : "";
    ask();
  };
  const element = toolSection("seen", strings.nav.seen, words.heading, words.intro,
    h("div", { class: "row" }, field(words.poses, poses), field(words.measure, measure), field(words.frame, frame), field(words.rotation, rotation), field(words.second, second)), place.element);
  plan.changed(() => void tablesChanged());
  return { ...element, ask, tablesChanged: () => void tablesChanged() };
}
