// What a file that was dropped is taken for, by its name and its first lines; and the command that goes with such files. A guess
// only: the page shows both, and both can be changed. Whether the file is what it says the program itself decides.

export const kinds = ["measurements", "poses", "robot", "tolerances", "problem", "errors", "calibration", "printer", "readings", "other"] as const;
export type Kind = (typeof kinds)[number];

/// The columns of a table: the first line that is no comment.
function columnsOf(text: string): string[] {
  const header = text.split(/\r?\n/).find((line) => line.trim() !== "" && !line.startsWith("#")) ?? "";
  return header.split(/[,;\t]/).map((column) => column.trim().toLowerCase());
}

function kindOfTable(text: string): Kind {
  const columns = new Set(columnsOf(text));
  const has = (...names: string[]) => names.every((name) => columns.has(name));
  if (has("from_x_mm") || has("x_mm", "y_mm", "z_mm", "height_mm")) return "readings";
  if (has("x_cmd_mm", "x_mm") || ["distance_mm", "height_mm", "ball_bar_mm", "dial_mm", "qw"].some((name) => has(name))) return "measurements";
  if (has("x_cmd_mm") || has("x_mm", "phi_deg")) return "poses";
  return has("q1_deg") ? "other" : "measurements"; // an instrument's export
}

function kindOfToml(text: string): Kind {
  if (/^\s*\[\[requirement\]\]/m.test(text)) return "problem";
  if (/^\s*\[workspace\]/m.test(text)) return "robot";
  if (/^\s*\[tolerances\b/m.test(text)) return "tolerances";
  return /^\s*\[\[limb\]\]/m.test(text) ? "errors" : "tolerances";
}

export function kindOf(name: string, text: string): Kind {
  const ending = name.toLowerCase().split(".").at(-1)!;
  if (ending === "toml") return kindOfToml(text);
  if (ending === "json") return "calibration";
  if (ending === "cfg") return "printer";
  if (ending === "g") return "printer";
  return ["csv", "txt", "tsv", "dat"].includes(ending) ? kindOfTable(text) : "other";
}

export interface Taken {
  name: string;
  kind: Kind;
}

export const kReport = "report.html";

/// The command that these files ask for; null where they ask for none.
/// @param robot  its words where one was chosen.
export function commandFor(files: Taken[], robot: string[]): string[] | null {
  const of = (kind: Kind) => files.filter((file) => file.kind === kind).map(({ name }) => name);
  const given = (option: string, names: string[]) => (names.length > 0 ? [option, ...names] : []);
  const last = (option: string, kind: Kind) => given(option, of(kind).slice(-1));
  const report = ["--json", "--report", kReport];
  const ours = of("robot").length > 0 ? last("--robot", "robot") : robot;
  const measured = given("--measurements", of("measurements")), poses = given("--poses", of("poses"));
  const [printer] = of("printer").slice(-1);
  if (printer !== undefined) {
    const firmware = printer.toLowerCase().endsWith(".g") ? ["--firmware", "reprapfirmware"] : [];
    return ["calibrate", "--printer", printer, ...firmware, ...given("--readings", of("readings")), ...report];
  }
  if (measured.length > 0 && of("calibration").length > 0) return ["validate", ...last("--calibration", "calibration"), ...measured, ...poses, ...report];
  if (measured.length > 0) return ["calibrate", ...measured, ...poses, ...ours, ...last("--tolerances", "tolerances"), ...report];
  if (of("calibration").length > 0 && poses.length > 0) return ["compensate", ...last("--calibration", "calibration"), ...last("--poses", "poses"), "--json"];
  if (of("calibration").length > 0) return ["report", ...last("--calibration", "calibration"), "--out", kReport];
  if (of("problem").length > 0) return ["tolerance", "allocate", ...ours, ...last("--problem", "problem"), ...report];
  if (of("tolerances").length > 0) return ["tolerance", "analyze", ...ours, ...last("--tolerances", "tolerances"), ...report];
  if (poses.length > 0) return ["identifiability", ...last("--poses", "poses"), ...ours, "--json"];
  return ours.length > 0 && of("robot").length > 0 ? ["sensitivity", ...ours, ...report] : null;
}
