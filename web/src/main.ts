// The page: every section whose data are there.
import type { Report } from "./data";
import { readReport } from "./report";
import { h } from "./dom";
import type { Section } from "./section";
import { batch } from "./sections/batch";
import { contributors } from "./sections/contributors";
import { correlations } from "./sections/correlations";
import { drives } from "./sections/drives";
import { errorMaps } from "./sections/error_maps";
import { observability } from "./sections/observability";
import { parameters } from "./sections/parameters";
import { printer } from "./sections/printer";
import { publishedRows } from "./sections/published_rows";
import { repeat } from "./sections/repeat";
import { residuals } from "./sections/residuals";
import { robot } from "./sections/robot";
import { verdict } from "./sections/verdict";
import { strings } from "./strings";
import { startTheme, themeButton } from "./theme";

const kSections: ((report: Report) => Section | null)[] = [publishedRows, printer, robot, errorMaps, residuals, parameters, drives, correlations, observability, contributors, batch, repeat];

function navigation(sections: Section[]): HTMLElement {
  const link = (id: string, text: string) => h("li", {}, h("a", { href: `#${id}` }, text));
  return h("nav", { "aria-label": strings.sections }, h("div", {}, h("ul", {}, link("verdict", strings.nav.verdict), ...sections.map(({ id, nav }) => link(id, nav))), themeButton()));
}

const report = readReport();
document.title = strings.title(report.robot.name, strings.kind[report.kind] ?? report.kind);
startTheme();
const page = document.getElementById("report")!;
const head = verdict(report);
const sections = kSections.flatMap((make) => make(report) ?? []);
page.append(
  h("a", { class: "skip", href: "#verdict" }, strings.skip),
  navigation(sections),
  h("main", {}, head, ...sections.map(({ element }) => element)),
);
