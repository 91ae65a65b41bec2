// What it takes to get the same numbers again.
import type { Report } from "../data";
import { singleRodsOf } from "../report";
import { h, table } from "../dom";
import { exact } from "../numbers";
import { section, type Section } from "../section";
import { strings } from "../strings";

const text = strings.repeat;

export function repeat(report: Report): Section {
  const files = report.inputs.map(({ file, sha256 }) => [h("span", { class: "name" }, file), h("span", { class: "hash" }, sha256)]);
  const { calibration } = report.results;
  type Given = string | number | number[];
  const value = (given: Given) => (typeof given === "string" ? given : [given].flat().map(exact).join(", "));
  const listed = (names: Record<string, string>, given: object) => {
    const said = new Map<string, Given>(Object.entries(given));
    return Object.entries(names).flatMap(([key, name]) => (said.has(key) ? [[name, value(said.get(key)!)]] : []));
  };
  const limbs = singleRodsOf(report.robot).map(({ kind, ...numbers }, k) => [text.limb(k + 1, kind), Object.entries(numbers).map(([key, given]) => `${key} ${value(given)}`).join("; ")]);
  const dimensions = [...listed(text.geometry, report.robot.geometry ?? {}), ...limbs, ...listed(text.workspace, report.robot.workspace)];
  return section("repeat", strings.nav.repeat, text.heading, text.intro,
    h("p", {}, `${text.program}: ${report.program}. ${text.date}: ${report.date}. ${text.command}:`),
    h("code", { class: "command" }, report.command),
    files.length > 0 ? table(text.columns, files, text.inputs) : h("p", {}, text.none),
    calibration && calibration.date !== report.date ? h("p", {}, `${text.calibration} ${calibration.program}, ${calibration.date}; ${calibration.inputs.map((input) => `${input.file} (${input.sha256.slice(0, 12)}\u2026)`).join(", ")}.`) : null,
    h("h3", {}, text.robot),
    table(text.robotColumns, dimensions, text.robot, [1]));
}
