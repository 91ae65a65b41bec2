// When results of two builds of the program agree, although their compilers round differently; and the commands to compare.
const kSame = 1e-9;

/// What rounding decides, and another compiler may decide otherwise: which of several poses that a symmetric robot holds equal is the worst; which directions
/// span what readings do not show (how many, and that they span the same, is compared); which machines are drawn where failures are rare.
const kTies = /(^|\.)(\w*_pose|worst)(\.|$)/, kDrawn = /(^|\.)(yield|dpmo|failure)(\.|$)/, kStamps = /(^|\.)(program|date|build)$/;
/// U over the workspace is a quantile of machines drawn with a root of the covariance, of which rounding leaves half the digits.
const kOfRoots = /(^|\.)use\.\w+\.U$/;
const kHalfTheDigits = 2e-8;

const dot = (a, b) => a.reduce((sum, value, k) => sum + value * b[k], 0);
const without = (direction, basis) => basis.reduce((left, one) => left.map((value, k) => value - dot(left, one) * one[k]), direction);

function orthonormal(directions) {
  return directions.reduce((basis, direction) => {
    const rest = without(direction, basis), size = Math.sqrt(dot(rest, rest));
    return [...basis, rest.map((value) => value / size)];
  }, []);
}

/// The largest part of a direction of the one null space that lies outside of the other.
function outside(one, other) {
  const basis = orthonormal(other.map(({ direction }) => direction));
  return Math.max(0, ...one.map(({ direction }) => Math.hypot(...without(direction, basis))));
}

/// Where two answers differ by more than 1e-9 (of numbers above 1, of themselves).
export function differences(one, other, at = "") {
  if (kTies.test(at) || kDrawn.test(at) || kStamps.test(at)) return [];
  const said = `${at}: ${JSON.stringify(one)}, ${JSON.stringify(other)}`;
  if (typeof one === "number" && typeof other === "number") return Math.abs(one - other) <= (kOfRoots.test(at) ? kHalfTheDigits : kSame) * Math.max(1, Math.abs(one)) ? [] : [said];
  if (one === null || other === null || typeof one !== "object" || typeof other !== "object") return one === other ? [] : [said];
  const keys = Object.keys(one);
  if (JSON.stringify(keys) !== JSON.stringify(Object.keys(other))) return [`${at}: keys ${keys} and ${Object.keys(other)}`];
  if (/(^|\.)null_space$/.test(at) && one[0]?.direction) return outside(one, other) < 1e-7 && outside(other, one) < 1e-7 ? [] : [`${at}: another space`];
  return keys.flatMap((key) => differences(one[key], other[key], at ? `${at}.${key}` : key));
}

export const countNumbers = (value) => (typeof value === "number" ? 1 : value !== null && typeof value === "object" ? Object.values(value).reduce((sum, one) => sum + countNumbers(one), 0) : 0);

/// Commands on the samples that between them do most of what the program does.
export const kCommands = [
  "calibrate --printer printer.cfg --json --report report.html",
  "calibrate --printer config.g --firmware reprapfirmware --readings bed_heights.csv bed_distances.csv --json --report report.html",
  "calibrate --measurements distances.csv --poses poses.csv --json --report report.html",
  "calibrate --measurements measured.csv --tolerances tolerances.toml --json --report report.html",
  "calibrate --measurements stated.csv --json",
  "calibrate --measurements export.csv --poses plan.csv --json",
  "calibrate --measurements heights.csv home_distances.csv --poses heights_plan.csv --height-sigma-mm 0.01 --sigma-mm 0.02 --json",
  "calibrate --measurements bar.csv --poses bar_plan.csv --sigma-mm 0.005 --json",
  "calibrate --measurements heights.csv dial.csv --poses heights_plan.csv dial_plan.csv --height-sigma-mm 0.01 --json",
  "calibrate --measurements body.csv --reflectors end-effector --json",
  "identifiability --robot huang2016 --poses plan.csv --rotation relative --json",
  "poses --robot robot.toml --optimal 12 --candidates 300 --json",
  "sensitivity --robot huang2016 --json --report report.html",
  "tolerance analyze --robot huang2016 --tolerances drawing.toml --max-tilt 0.001 --max-machines 2000 --json --report report.html",
  "tolerance allocate --robot huang2016 --json",
  "yield --robot huang2016 --machines 20 --json",
  "forward --robot huang2016 --joints joints.csv --errors errors.toml --json",
  "calibrate --measurements nowhere.csv --json",
  "calibrate --measurements check_plan.csv --json",
];
