// What the program puts into the page: results as its commands print them with --json (docs/files.md), and what figures
// need beyond.

export type Vector = [number, number, number];

/// A limb of a plate with six freedoms, as its robot file has it: a strut, or one rod on an arm or on a rail's carriage.
export interface SingleRod {
  kind: "strut" | "arm" | "rail";
  base_joint_mm: Vector;
  plate_joint_mm: Vector;
  length_at_zero_mm?: number; ///< of a strut
  rod_mm?: number;
  arm_mm?: number;
  direction?: Vector; ///< of a rail
}
export interface Robot {
  name: string;
  /// What all limbs share; none on limbs with one rod.
  geometry?: { base_radius_mm: number; plate_radius_mm: number; actuator: "revolute" | "linear"; arm_mm: number; rod_mm: number; parallelogram_width_mm: number; limb_azimuth_deg: number[] };
  limb?: (SingleRod | { kind?: undefined })[];
  plate?: { slide_axis: Vector };
  workspace: { radius_mm: number; height_mm: number; top_z_mm: number; rotation_deg: [number, number]; tilt_deg?: number };
}

export interface Largest {
  max_abs_distance_mm: number | null; ///< the first four: null where lengths alone were read
  rms_distance_mm: number | null;
  max_volumetric_mm: number | null;
  max_volumetric_aligned_mm: number | null;
  [length: `rms_${string}_mm`]: number | null | undefined; ///< of lengths, a kind each: null where none were read
  max_abs_rotation_deg: number | null;
  max_orientation_deg?: number | null; ///< of a body's orientation; files of earlier versions have none
}

/// U of one quantity anywhere in the workspace, against its limit where one was set.
export interface UseQuantity {
  U: number;
  limit: number | null;
  verdict: "kept" | "not kept" | null;
}
export interface Use {
  distance_mm: UseQuantity;
  aligned_mm: UseQuantity;
  rotation_deg: UseQuantity | null;
}

export interface Parameter {
  name: string;
  limb: number;
  value: number;
  unit: string;
  std: number | null;
  U: number | null;
  k: number | null;
  status: string;
  prior_std: number | null;
  expected: number;
  data_share: number;
}

export interface DistanceResidual {
  from: string;
  to: string;
  before_mm: number;
  after_mm: number;
  excluded: boolean;
}
/// A height, a ball bar's length or a dial's reading: its own number stands under the name of its column.
export interface LengthResidual {
  series: string;
  pose: string;
  before_mm: number;
  after_mm: number;
  excluded: boolean;
}
export interface PointResidual {
  series: string;
  pose: string;
  before_mm: Vector;
  after_mm: Vector;
  excluded: boolean;
}

export type Residual = DistanceResidual | LengthResidual | PointResidual;

/// What a delta's firmware is told: a number a tower, or one for all.
export type DeltaGeometry = Record<string, number | number[]>;
export interface DeltaFit {
  rms_height_mm: number;
  rms_distance_mm: number;
  parameters: number;
  geometry: DeltaGeometry;
}
export interface DeltaAccuracy {
  absolute_rms_mm: number;
  absolute_max_mm: number;
  shape_rms_mm: number;
  shape_max_mm: number;
}
export interface PredictionErrors {
  height_mm: number;
  distance_mm: number;
}
/// Values that could be written, against the saved ones.
export interface PrinterCandidate {
  geometry: DeltaGeometry;
  gain: { value: number; low: number; high: number };
  chance_better: number;
  expected_shape_mm: number;
}
export interface Printer {
  advice: "accept_new" | "take_firmware" | "keep_saved" | "check_input";
  findings: string[];
  saved: DeltaFit;
  firmware: DeltaFit;
  new: DeltaGeometry;
  lines: string;
  accuracy_saved: DeltaAccuracy;
  accuracy_new: DeltaAccuracy;
  left_out: PredictionErrors | null; ///< null: too few readings
  left_out_firmware: PredictionErrors | null;
  left_out_saved: PredictionErrors | null;
  judged_new: PrinterCandidate;
  judged_firmware: PrinterCandidate;
  expected_shape_saved_mm: number;
}

export interface Calibration {
  printer?: Printer;
  accepted: boolean;
  verdict: string;
  reasons: string[];
  use: Use | null;
  notes: string[];
  assumed: string[];
  parameters: Parameter[];
  covariance: number[][] | null;
  correlations: { one: string; other: string; value: number }[];
  rank: number;
  null_space: { text: string }[];
  readings: number;
  noise_mm: number;
  degrees_of_freedom: number;
  before: Largest;
  after: Largest;
  residuals: Residual[];
  suspects: { reading: string; statistic: number; chance: number; excluded: boolean }[];
  options: Record<string, unknown>;
  program: string;
  date: string;
  inputs: InputFile[];
}

export interface PoseError {
  d_rho_mm: number;
  d_v_mm: number;
  d_phi_deg: number | null;
}
export interface Validation {
  accepted: boolean;
  reasons: string[];
  before: Largest;
  after: Largest;
  iso9283: { max_AP_mm: number; max_RP_mm: number; max_AD_mm: number; max_RD_mm: number; poses: { pose: string; repeats: number; AP_mm: number; RP_mm: number; AD_mm: number; RD_mm: number }[] };
  checks: { quantity: string; error: number; U: number; k: number; limit: number; conformity: string }[];
  poses: { series: string; pose: string; before: PoseError; after: PoseError; predicted_U_mm?: Vector }[];
  readings: { reading: string; before_mm: number; after_mm: number; sigma_mm: number; U_mm: number }[];
  agreement: { chi_square: number; dof: number; noise_dof: number | null; chance: number; contradicts: boolean } | null;
  notes: string[];
}

export interface Contributor {
  name: string;
  share: number;
}
export interface Sensitivity {
  quantity: string;
  poses: number;
  global: Record<string, number>;
  global_error: Record<string, number>;
  largest: Record<string, number>;
  worst: Record<string, number>;
  contributors: Contributor[];
  assumed: string[];
}

export interface Proportion {
  value: number;
  low: number;
  high: number;
}
export interface Requirement {
  quantity: string;
  unit: string;
  limit: number;
  worst_case: number;
  rss_3sigma: number;
  monte_carlo_3sigma: number;
  monte_carlo_3sigma_interval: [number, number];
  cpk: number;
  contributors: Contributor[];
}
export interface Analysis {
  model: string;
  machines: number;
  converged: boolean;
  confidence: number;
  requirements: Requirement[];
  yield: Proportion;
  dpmo: Proportion;
  assumed: string[];
}

export interface Allocation {
  status: string;
  reason: string;
  cost: number;
  tolerances?: Record<string, number>; ///< of the tilt group; struts have none
  max_tilt_3sigma?: number;
  half_widths: Record<string, unknown>;
  drawing: Record<string, { text: string }>; ///< by the keys of half_widths, without exact ones
  requirements: ({ quantity: string; criterion: string; price: number } & Record<string, unknown>)[];
  assumed: string[];
}

export interface Spread {
  mean: number;
  std: number;
  p50: number;
  p90: number;
  p95: number;
  p99: number;
  p99_73: number;
  p95_interval: [number, number];
}
export interface Yield {
  machines: number;
  partial: boolean;
  fates: Record<string, number>;
  passed: number | null; ///< null, as yield and dpmo: no limits
  min_yield?: number;
  yield: (Proportion & { confidence: number }) | null;
  dpmo: Proportion | null;
  assumed: string[];
  quantities: Record<string, { before: Spread; after: Spread } | null>;
}

export interface Row {
  id: string;
  table: string;
  quantity: string;
  unit: string;
  paper: number;
  ours: number;
  tolerance: number;
  ok: boolean;
  verdict: "reproduced" | "not reproduced" | "cannot be tested";
  reason: string;
}
export interface Reproduction {
  rule: string[];
  rows: Row[];
  counts: { reproduced: number; not_reproduced: number; cannot_be_tested: number };
}

export interface InputFile {
  file: string;
  sha256: string;
}

export interface ScenePose {
  pose: string;
  position_mm: Vector;
  rotation_deg: number;
  before_mm: Vector;
  after_mm: Vector | null;
  tilt_rad: [number, number] | null; ///< away from how it was commanded
  tilt_deg?: Vector; ///< commanded, and the plate's normal there: of plates with six freedoms
  normal?: Vector;
  limbs?: { base_mm: Vector; elbow_mm?: Vector; rods_mm: [Vector, Vector][] }[]; ///< struts and carriages have no elbow, and one rod
}
export interface Scene {
  measured: boolean;
  poses: ScenePose[];
}

export interface MapAxes {
  radii_mm: number[];
  azimuths_deg: number[];
  layers_mm: number[];
}
export interface ErrorMap extends MapAxes {
  coverage_factor: number;
  points: Record<string, number | null>[];
}
export interface SigmaMap extends MapAxes {
  quantity: string;
  unit: string;
  points: { x_mm: number; y_mm: number; z_mm: number; value: number }[];
}

export interface Curve {
  n: number;
  curve: { n: number; O2: number; change: number }[];
}
export interface Bins {
  bin_width: number;
  counts: number[];
  total: number;
}

export interface Report {
  format: string;
  program: string;
  date: string;
  command: string;
  kind: string;
  robot: Robot;
  results: {
    calibration?: Calibration;
    validation?: Validation;
    sensitivity?: Sensitivity;
    allocation?: Allocation;
    analysis?: Analysis;
    yield?: Yield;
    reproduction?: Reproduction;
  };
  figures: {
    scene?: Scene;
    error_map?: ErrorMap;
    observability?: { rough: Curve; fine: Curve };
    sigma_map?: SigmaMap;
    largest_on_a_machine?: { quantity: string; unit: string; limit: number; machines: Bins }[];
    largest_of_a_machine?: { quantity: string; limit?: number; before: Bins; after: Bins }[];
  };
  inputs: InputFile[];
}
