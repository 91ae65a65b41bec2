// One report of every kind from the built program, for tests and screenshots: samples(PROGRAM, FOLDER) -> paths by name. Quick ones are of
// fewer machines, and of poses chosen from fewer.
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { fileURLToPath } from "node:url";

const published = fileURLToPath(new URL("../data/huang2016/", import.meta.url));

/// Names that would do harm if they were ever taken for markup or for a program.
export const hostileNames = ["<img src=x onerror=alert(1)>", "</script><script>alert(2)</script>", "{{7*7}}${7*7}", "=HYPERLINK(1)", "\u200f\u05d0\u05d1, right to left"];

/// The tenth reading, two millimetres off in x.
function withGrossError(table) {
  const lines = table.split("\n"), header = lines.findIndex((line) => !line.startsWith("#"));
  const fields = lines[header + 10].split(","), x = lines[header].split(",").indexOf("x_mm");
  fields[x] = String(Number(fields[x]) + 2);
  lines[header + 10] = fields.join(",");
  return lines.join("\n");
}

/// A set of data/klipper-delta as Klipper writes it.
function printerConfig(id, radius) {
  const set = JSON.parse(readFileSync(fileURLToPath(new URL("../data/klipper-delta/sets.json", import.meta.url)), "utf8")).find((one) => one.id === id);
  const towers = ["a", "b", "c"].map((name, k) => `[stepper_${name}]\nangle: ${set.tower_angle_deg[k]}\narm_length: ${set.arm_length_mm[k]}\nposition_endstop: ${set.position_endstop_mm[k]}\nstep_distance: ${set.step_distance_mm[k]}`);
  const heights = set.heights.map(([height, ...steps], k) => `#*# height${k} = ${height}\n#*# height${k}_pos = ${steps}`);
  const distances = set.distances.map(([distance, ...steps], k) => `#*# distance${k} = ${distance}\n#*# distance${k}_pos1 = ${steps.slice(0, 3)}\n#*# distance${k}_pos2 = ${steps.slice(3)}`);
  return ["[printer]", "kinematics: delta", `delta_radius: ${radius ?? set.delta_radius_mm}`, ...towers, "#*# [delta_calibrate]", ...heights, ...distances, ""].join("\n");
}

const rowsOf = (table) => table.trim().split("\n").filter((line) => !line.startsWith("#"));

/// Points of a rotary Delta at 40 poses whose joints are off by up to 0.01 deg, smoothly along their stroke.
function unevenReadings(run, at, few) {
  const robot = ["--robot", "rotary_delta"];
  run("poses", ...robot, "--optimal", "40", ...few, "--out", "uneven-plan.csv");
  const [head, ...joints] = rowsOf(run("inverse", ...robot, "--poses", "uneven-plan.csv"));
  const moved = joints.map((row) => row.split(",").map((cell, k) => (k === 0 ? cell : Number(cell) + 0.01 * Math.sin(Number(cell) / 11 + k))).join(","));
  writeFileSync(at("uneven-joints.csv"), [head, ...moved].join("\n"));
  const plan = rowsOf(readFileSync(at("uneven-plan.csv"), "utf8")).slice(1), [columns, ...reached] = rowsOf(run("forward", ...robot, "--joints", "uneven-joints.csv"));
  const x = columns.split(",").indexOf("x_mm");
  const rows = reached.flatMap((row, k) => [0, 1].map((visit) => [...plan[k].split(",").slice(0, 4), ...row.split(",").slice(x, x + 3).map((cell, axis) => (Number(cell) + 0.01 * Math.sin(7 * k + 3 * visit + 2 * axis)).toFixed(4))].join(",")));
  return ["# robot: rotary_delta", "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,x_mm,y_mm,z_mm", ...rows].join("\n") + "\n";
}

export function samples(program, folder, quick = false) {
  mkdirSync(folder, { recursive: true });
  const at = (name) => join(folder, name);
  const run = (...args) => execFileSync(program, [...args, ...(quick ? ["--threads", "1"] : [])], { cwd: folder, encoding: "utf8", env: { ...process.env, SOURCE_DATE_EPOCH: "1475668800" } });
  const refused = (...args) => {
    try {
      run(...args);
    } catch (verdict) {
      if (verdict.status !== 1) throw verdict;
    }
  };
  const few = quick ? ["--candidates", "300"] : [], rough = quick ? ["--sigma-error", "0.1", "--failure-error", "0.5"] : ["--max-machines", "20000"];
  const huang = ["--robot", "huang2016"]; // its tables say it themselves
  const machine = ["--seed", "3", "--noise-mm", "0.017", "--frame", "random"];

  cpSync(published, at("huang2016"), { recursive: true }); // pages say where their files are, and not on whose disk
  run("calibrate", "--measurements", "huang2016/distances.csv", "--poses", "huang2016/poses.csv", "--out", "published.json", "--report", "published.html");

  run("poses", ...huang, "--optimal", "20", ...few, "--seed", "7", "--out", "plan.csv");
  run("simulate", "--poses", "plan.csv", ...machine, "--repeats", "3", "--read-rotation", "--rotation-noise-deg", "0.1", "--out", "measured.csv");
  writeFileSync(at("measured.csv"), withGrossError(readFileSync(at("measured.csv"), "utf8")));
  run("calibrate", "--measurements", "measured.csv", "--out", "calibration.json", "--report", "calibration.html");
  run("poses", ...huang, "--optimal", "30", ...few, "--seed", "8", "--out", "check-plan.csv");
  run("simulate", "--poses", "check-plan.csv", ...machine, "--repeats", "2", "--read-rotation", "--rotation-noise-deg", "0.1", "--out", "check.csv");
  run("validate", "--calibration", "calibration.json", "--measurements", "check.csv", "--limit-mm", "0.15", "--report", "validation.html");
  run("report", "--calibration", "calibration.json", "--measurements", "check.csv", "--out", "report.html");

  const plan = readFileSync(at("plan.csv"), "utf8").split("\n").filter((line) => !line.startsWith("#"));
  const hostile = plan.map((line, k) => {
    const name = hostileNames[k - 2]; // after the header and home
    return name === undefined ? line : line.replace(/^[^,]*/, `"${name}"`);
  });
  writeFileSync(at("hostile-plan.csv"), hostile.join("\n"));
  writeFileSync(at("hostile.toml"), run("robot", ...huang).replace(/^name = .*$/m, 'name = "</script><img src=x onerror=alert(3)>"'));
  run("simulate", "--robot", "hostile.toml", "--poses", "hostile-plan.csv", ...machine, "--out", "hostile.csv");
  run("calibrate", "--robot", "hostile.toml", "--measurements", "hostile.csv", "--out", "hostile.json", "--report", "hostile.html");

  writeFileSync(at("two.csv"), "from,to,distance_mm\nP0,P1,501.0\nP0,P2,502.0\n");
  refused("calibrate", "--measurements", "two.csv", "--poses", "huang2016/poses.csv", "--report", "refused.html");

  run("poses", "--robot", "rotary_delta", "--optimal", "12", ...few, "--out", "delta-plan.csv");
  run("simulate", "--robot", "rotary_delta", "--poses", "delta-plan.csv", ...machine, "--out", "delta.csv");
  run("calibrate", "--robot", "rotary_delta", "--measurements", "delta.csv", "--out", "delta.json", "--report", "delta.html");

  writeFileSync(at("uneven.csv"), unevenReadings(run, at, few));
  run("calibrate", "--robot", "rotary_delta", "--measurements", "uneven.csv", "--out", "uneven.json", "--report", "uneven.html");

  run("simulate", "--robot", "rotary_delta", "--poses", "delta-plan.csv", "--measure", "pose", ...machine, "--rotation-noise-deg", "0.05", "--out", "bodies.csv");
  run("calibrate", "--robot", "rotary_delta", "--measurements", "bodies.csv", "--out", "bodies.json", "--report", "bodies.html");

  const hexapod = ["--robot", "hexapod.toml"];
  run("robot", "--template", "hexapod", "--out", "hexapod.toml");
  run("poses", ...hexapod, "--optimal", "24", "--candidates", quick ? "100" : "500", "--measure", "pose", "--out", "hexapod-plan.csv");
  run("simulate", ...hexapod, "--poses", "hexapod-plan.csv", "--measure", "pose", ...machine, "--rotation-noise-deg", "0.01", "--out", "hexapod.csv");
  run("calibrate", ...hexapod, "--measurements", "hexapod.csv", "--out", "hexapod.json", "--report", "struts.html");
  run("report", ...hexapod, "--calibration", "hexapod.json", "--out", "strutreport.html");
  run("sensitivity", ...hexapod, "--report", "strutsensitivity.html");
  writeFileSync(at("strut_problem.toml"), readFileSync(fileURLToPath(new URL("../samples/strut_problem.toml", import.meta.url))));
  run("tolerance", "allocate", ...hexapod, "--problem", "strut_problem.toml", "--report", "strutallocation.html");

  for (const kind of ["6-rss", "6-pss"]) {
    run("robot", "--template", kind, "--out", `${kind}.toml`);
    run("poses", "--robot", `${kind}.toml`, "--optimal", "24", "--candidates", quick ? "100" : "500", "--measure", "pose", "--out", `${kind}-plan.csv`);
    run("simulate", "--robot", `${kind}.toml`, "--poses", `${kind}-plan.csv`, "--measure", "pose", ...machine, "--rotation-noise-deg", "0.01", "--out", `${kind}.csv`);
    run("calibrate", "--robot", `${kind}.toml`, "--measurements", `${kind}.csv`, "--out", `${kind}.json`, "--report", `${kind}.html`);
  }

  writeFileSync(at("K18.cfg"), printerConfig("K18", 160.3)); // as if it had been changed since
  writeFileSync(at("K37.cfg"), printerConfig("K37"));
  run("calibrate", "--printer", "K18.cfg", "--out", "printer.json", "--report", "printer.html");
  refused("calibrate", "--printer", "K37.cfg", "--out", "printer-kept.json", "--report", "keep.html");

  run("poses", ...huang, "--optimal", "200", "--candidates", "400", "--out", "many-plan.csv");
  run("simulate", "--poses", "many-plan.csv", ...machine, "--out", "many.csv");
  run("calibrate", "--measurements", "many.csv", "--out", "many.json", "--report", "many.html");

  run("sensitivity", ...huang, "--out", "sensitivity.txt", "--report", "sensitivity.html");
  run("tolerance", "allocate", ...huang, "--out", "allocation.txt", "--report", "allocation.html", "--toml", "chosen.toml");
  run("tolerance", "analyze", ...huang, "--tolerances", "chosen.toml", ...rough, "--out", "analysis.txt", "--report", "analysis.html");
  run("yield", ...huang, "--machines", quick ? "30" : "300", "--limit-mm", "0.15", "--min-yield", quick ? "0.5" : "0.9", "--out", "yield.txt", "--report", "yield.html");
  run("yield", ...huang, "--machines", "5", "--out", "unlimited.txt", "--report", "unlimited.html");
  run("reproduce", "huang2016", "--out", "reproduction.txt", "--report", "reproduction.html");
  const names = ["published", "calibration", "validation", "report", "hostile", "refused", "delta", "uneven", "bodies", "printer", "keep", "many", "sensitivity", "allocation", "analysis", "yield", "unlimited", "reproduction", "struts", "strutreport", "strutsensitivity", "strutallocation", "6-rss", "6-pss"];
  return Object.fromEntries(names.map((name) => [name, at(`${name}.html`)]));
}
