// The verdict, its numbers and their uncertainty: what a reader in a hurry must see.
import type { Report } from "../data";
import { h, svg } from "../dom";
import { strings } from "../strings";
import { ofReproduction, ofYield } from "../verdicts/batch";
import type { Verdict } from "../verdicts/card";
import { ofAllocation, ofAnalysis, ofSensitivity } from "../verdicts/design";
import { ofCalibration, ofValidation } from "../verdicts/machine";
import { ofPrinter } from "../verdicts/printer";

const text = strings.verdict;

function sign(yes: boolean): SVGElement {
  const path = yes ? "M4 13l5 5L20 6" : "M6 6l12 12M18 6L6 18";
  return svg("svg", { viewBox: "0 0 24 24", "aria-hidden": "true", fill: "none", stroke: "currentColor", "stroke-width": 3, "stroke-linecap": "round" }, svg("path", { d: path }));
}

function verdictsOf({ results, figures }: Report): Verdict[] {
  const { reproduction, validation, calibration, analysis, allocation, sensitivity, yield: batch } = results;
  return [
    ...(reproduction ? [ofReproduction(reproduction)] : []),
    ...(validation ? [ofValidation(validation, figures.error_map, calibration)] : []),
    ...(calibration && !validation ? [calibration.printer ? ofPrinter(calibration.printer) : { ...ofCalibration(calibration), ...(reproduction ? { yes: null } : {}) }] : []),
    ...(analysis ? [ofAnalysis(analysis)] : []),
    ...(allocation ? [ofAllocation(allocation)] : []),
    ...(sensitivity && !reproduction ? [ofSensitivity(sensitivity)] : []),
    ...(batch ? [ofYield(batch)] : []),
  ];
}

export function verdict(report: Report): HTMLElement {
  const parts = verdictsOf(report).flatMap(({ yes, says, sentence, reasons, cards, notes }) => [
    h("div", { class: `verdict ${yes === null ? "plain" : yes ? "yes" : "no"}` }, yes === null ? null : sign(yes), h("div", {}, h("strong", {}, says), h("p", {}, sentence), reasons?.length ? h("ul", {}, ...reasons.map((reason) => h("li", {}, reason))) : null)),
    h("dl", { class: "cards" }, ...cards),
    ...(notes?.length ? [h("details", { open: "" }, h("summary", {}, text.notes), h("ul", { class: "notes" }, ...notes.map((note) => h("li", {}, note))))] : []),
  ]);
  return h("header", { id: "verdict", tabindex: "-1" },
    h("p", { class: "kind" }, strings.madeBy(report.program, report.date)),
    h("h1", { class: "name" }, strings.title(report.robot.name, strings.kind[report.kind] ?? report.kind)),
    ...parts);
}
