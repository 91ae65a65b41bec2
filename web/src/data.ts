// Made by node types.mjs from the schemas in schema/, which say what each key means. Not to be edited.

export type Vector = [number, number, number];
export type Interval = [number, number];
export type Assumed = string[];
export type Residual = DistanceResidual | HeightResidual | BallBarResidual | DialResidual | PointResidual;
export type RotationMatrix = [Vector, Vector, Vector];
export type Rung = "saved" | "height" | "radius" | "towers" | "rods";
export type DeltaGeometry = LinearDelta | RotaryDelta;
export type Contributors = Contributor[];
export type IntervalOverMachines = [number | null, number | null];

export interface Report {
  format: "paracal report 1";
  program: string;
  date: string;
  command: string;
  kind: string;
  robot: Robot;
  results: Results;
  figures: Figures;
  inputs: InputFile[];
}
export interface Robot {
  name: string;
  geometry?: Geometry;
  plate?: Plate;
  workspace: Workspace;
  controller?: Controller;
  joints?: JointLimits;
  limb?: (Strut | SingleRodOnAnArm | SingleRodOnARail | IntendedLimb)[];
  tolerances?: HalfWidths;
}
export interface Geometry {
  base_radius_mm: number;
  plate_radius_mm: number;
  arm_mm: number;
  rod_mm: number;
  parallelogram_width_mm: number;
  limb_azimuth_deg: number[];
  actuator: "revolute" | "linear";
  pitch_mm?: number;
  pitch_deg?: number;
}
export interface Plate {
  slide_axis?: Vector;
  slide_sign?: number[];
  pinion_radius_mm?: number;
  freedoms?: ("x" | "y" | "z" | "tilt_x" | "tilt_y" | "tilt_z")[];
}
export interface Workspace {
  radius_mm?: number;
  height_mm?: number;
  top_z_mm?: number;
  x_mm?: Interval;
  y_mm?: Interval;
  z_mm?: Interval;
  heights_mm?: number[];
  radii_mm?: number[];
  rotation_deg: Interval;
  tilt_deg?: number;
}
export interface Controller {
  origin_mm: Vector;
}
export interface JointLimits {
  max_speed_deg_per_s?: number;
  max_acceleration_deg_per_s2?: number;
  max_speed_mm_per_s?: number;
  max_acceleration_mm_per_s2?: number;
}
export interface Strut {
  kind: "strut";
  base_joint_mm: Vector;
  plate_joint_mm: Vector;
  length_at_zero_mm: number;
  pitch_mm?: number;
}
export interface SingleRodOnAnArm {
  kind: "arm";
  base_joint_mm: Vector;
  plate_joint_mm: Vector;
  rod_mm: number;
  parallelogram_width_mm?: number;
  arm_mm: number;
  axis: Vector;
  arm_at_zero: Vector;
  pitch_deg?: number;
}
export interface SingleRodOnARail {
  kind: "rail";
  base_joint_mm: Vector;
  plate_joint_mm: Vector;
  rod_mm: number;
  parallelogram_width_mm?: number;
  direction: Vector;
  carriage: "ahead" | "behind";
  pitch_mm?: number;
}
export interface IntendedLimb {
  [k: string]: number | Vector;
}
export interface HalfWidths {
  others?: "exact";
  generous?: string[];
  distribution: "normal" | "uniform" | "truncated_normal";
  measured?: {
    [k: string]: number[];
  };
  [k: string]:
    | number
    | "exact"
    | string[]
    | "normal"
    | "uniform"
    | "truncated_normal"
    | {
        [k: string]: number[];
      }
    | undefined;
}
export interface Results {
  calibration?: Calibration;
  validation?: Validation;
  sensitivity?: Sensitivity;
  allocation?: Allocation;
  analysis?: Analysis;
  yield?: Yield;
  reproduction?: Reproduction;
}
export interface Calibration {
  format: "paracal calibration 1";
  program: string;
  build: string;
  date: string;
  accepted: boolean;
  verdict: "accepted" | "rejected" | "not identifiable" | "not converged";
  reasons: string[];
  use: Use | null;
  use_mean: Use | null;
  notes: string[];
  assumed: Assumed;
  components: Cause[];
  robot: Robot;
  controller: CommandingController;
  parameters: Parameter[];
  identified: number;
  covariance: number[][] | null;
  covariance_of_noise: number[][] | null;
  noise_dof: number | null;
  joint_std_deg?: number[];
  joint_std_mm?: number[];
  visit_std_deg?: number[];
  visit_std_mm?: number[];
  uses_drives: boolean;
  omitted_poses: OmittedPoses | null;
  drives: SplineOfADrive[];
  drive_covariance: number[][] | null;
  correlations: Correlation[];
  coverage_factor: number;
  rank: number;
  null_space: NullDirection[];
  stages: StageReport[];
  residual_rms_mm: number | null;
  readings: number;
  region: Region | null;
  noise_mm: number;
  orientation_noise_deg: number | null;
  degrees_of_freedom: number;
  unit_weight_std: number | null;
  fit_probability: number | null;
  chance: number | null;
  before: ErrorSummary;
  after: ErrorSummary;
  residuals: Residual[];
  suspects: Suspect[];
  frames: SeriesFrame[];
  planes: Plane[];
  ball_bars: BallBar[];
  dials: Dial[];
  distance_bias_mm: number | null;
  distance_bias_std_mm: number | null;
  options: CalibrationOptions;
  inputs: InputFile[];
  printer?: Printer;
}
export interface Use {
  distance_mm: UseQuantity;
  aligned_mm: UseQuantity;
  rotation_deg: UseQuantity | null;
}
export interface UseQuantity {
  U: number;
  limit: number | null;
  verdict: "kept" | "not kept" | null;
}
export interface Cause {
  cause: "visits" | "motion" | "parts" | "pose" | "noise" | "reflector" | "drift" | "backlash";
  text: string;
  probability: number;
  told: boolean;
}
export interface CommandingController {
  joints: "assumed" | "readings" | "confirmed" | "stated";
  source: string | null;
  robot: Robot | null;
}
export interface Parameter {
  name: string;
  limb: number;
  value: number;
  unit: "mm" | "deg" | "mm/m";
  std: number | null;
  U: number | null;
  k: number | null;
  dof: number | null;
  status: "identified" | "prior" | "fixed";
  prior_std: number | null;
  expected: number;
  with_drives?: number;
  data_share: number;
}
export interface OmittedPoses {
  poses: number;
  rigid_mm: number;
  with_drives_mm: number;
}
export interface SplineOfADrive {
  limb: number;
  unit: "deg" | "mm";
  centre: number;
  spacing: number;
  size?: number;
}
export interface Correlation {
  one: string;
  other: string;
  value: number;
}
export interface NullDirection {
  text: string;
  direction: number[];
}
export interface StageReport {
  name: "rough" | "fine";
  iterations: number;
  converged: boolean;
  rank: number;
  condition: number | null;
  residual_rms_mm: number;
}
export interface Region {
  low_mm: number[];
  high_mm: number[];
}
export interface ErrorSummary {
  max_abs_distance_mm: number | null;
  rms_distance_mm: number | null;
  max_volumetric_mm: number | null;
  max_volumetric_aligned_mm: number | null;
  rms_height_mm: number | null;
  rms_ball_bar_mm: number | null;
  rms_dial_mm: number | null;
  rms_joints_mm?: number;
  max_abs_rotation_deg: number | null;
  max_orientation_deg: number | null;
}
export interface DistanceResidual {
  from: string;
  to: string;
  distance_mm: number;
  before_mm: number;
  after_mm: number;
  excluded: boolean;
  rotation_deg?: number;
  rotation_before_deg?: number;
  rotation_after_deg?: number;
}
export interface HeightResidual {
  series: string;
  pose: string;
  height_mm: number;
  before_mm: number;
  after_mm: number;
  excluded: boolean;
}
export interface BallBarResidual {
  series: string;
  pose: string;
  ball_bar_mm: number;
  before_mm: number;
  after_mm: number;
  excluded: boolean;
}
export interface DialResidual {
  series: string;
  pose: string;
  dial_mm: number;
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
  orientation_before_deg?: Vector;
  orientation_after_deg?: Vector;
  rotation_before_deg?: number;
  rotation_after_deg?: number;
}
export interface Suspect {
  reading: string;
  statistic: number;
  chance: number;
  excluded: boolean;
}
export interface SeriesFrame {
  series: string;
  rotation: RotationMatrix;
  translation_mm: Vector;
  rotation_zero_deg: number | null;
  second_reflector_mm: Vector | null;
  body: BodyPlace | null;
}
export interface BodyPlace {
  rotation: RotationMatrix;
  translation_mm: Vector;
}
export interface Plane {
  series: string;
  z_mm: number;
  slope_x: number;
  slope_y: number;
}
export interface BallBar {
  series: string;
  x_mm: number;
  y_mm: number;
  z_mm: number;
  zero_mm?: number;
}
export interface Dial {
  series: string;
  zero_mm: number;
  direction_x: number;
  direction_y: number;
  direction_z: number;
}
export interface CalibrationOptions {
  distance_sigma_mm: number;
  point_sigma_mm: number;
  body_sigma_mm: number;
  height_sigma_mm: number;
  dial_angle_sigma_deg: number | null;
  rotation_sigma_deg: number;
  tracker?: TrackerNoise;
  distance_bias_sigma_mm: number;
  scale_sigma_ppm: number;
  rotation: "relative" | "absolute";
  reflectors: "plate" | "end-effector" | "end-effector-reversed";
  frame: "unknown" | "robot";
  body: "unknown" | "plate";
  limit_distance_mm: number | null;
  limit_aligned_mm: number | null;
  limit_rotation_deg: number | null;
  joint_sigma?: number;
  stage: "rough" | "fine" | "auto";
  method: "paper" | "best";
  tolerances?: HalfWidths;
  fixed: string[];
  free: string[];
  noise_is_known: boolean;
  exclude_outliers: boolean;
  outlier_chance: number;
  largest_chance: number;
  plane_slope_sigma_rad: number | null;
  plane_curvature_sigma_per_mm: number | null;
  common: CommonError[];
}
export interface TrackerNoise {
  transverse_mm: number;
  transverse_mm_per_m: number;
  radial_mm: number;
  radial_mm_per_m: number;
}
export interface CommonError {
  text: string;
  std_mm: number;
}
export interface InputFile {
  file: string;
  sha256: string;
}
export interface Printer {
  advice: "accept_new" | "keep_saved" | "accept_shift" | "check_input";
  rung: Rung;
  findings: string[];
  details: string[];
  ladder: PrinterRung[];
  saved: DeltaFit;
  firmware: DeltaFit;
  new: DeltaGeometry;
  bed: BedPoint[];
  print_radius_mm: number;
  noise_mm: ReadingNoise;
  excluded: string[];
  common_shift_mm: number;
  common_shift: CommonShift;
  uncheckable: string[];
  lines: string;
}
export interface PrinterRung {
  rung: Rung;
  geometry: DeltaGeometry;
  first_layer_mm: PrinterFigure;
  size_percent: PrinterFigure;
  chance_better: number;
  chance_size_worse: number;
  depth_mm: number | null;
  holds_radius: boolean;
  is_allowed: boolean;
}
export interface LinearDelta {
  tower_angle_deg: Vector;
  position_endstop_mm: Vector;
  delta_radius_mm: number;
  arm_length_mm: Vector;
}
export interface RotaryDelta {
  tower_angle_deg: Vector;
  position_endstop_mm: Vector;
  shoulder_radius_mm: number;
  shoulder_height_mm: Vector;
  upper_arm_length_mm: Vector;
  lower_arm_length_mm: Vector;
}
export interface PrinterFigure {
  value: number;
  low: number;
  high: number;
}
export interface DeltaFit {
  cost_mm2: number;
  rms_height_mm: number;
  rms_distance_mm: number;
  parameters: number;
  geometry: DeltaGeometry;
}
export interface BedPoint {
  x_mm: number;
  y_mm: number;
  saved_mm: number;
  new_mm: number;
}
export interface ReadingNoise {
  height: number;
  distance: number;
}
export interface CommonShift {
  is_stated: boolean;
  is_accepted: boolean;
  likely_causes: string[];
  position_endstop_mm: Vector;
}
export interface Validation {
  accepted: boolean | null;
  reasons: string[];
  before: ErrorSummary;
  after: ErrorSummary;
  iso9283: Iso9283;
  checks: LimitCheck[];
  poses: ValidatedPose[];
  readings: CheckedReading[];
  agreement: Agreement | null;
  notes: string[];
  assumed: Assumed;
}
export interface Iso9283 {
  max_AP_mm: number;
  max_RP_mm: number;
  max_AD_mm: number;
  max_RD_mm: number;
  poses: Iso9283Pose[];
}
export interface Iso9283Pose {
  pose: string;
  repeats: number;
  AP_mm: number;
  RP_mm: number;
  AD_mm: number;
  RD_mm: number;
  AP_deg?: number;
  RP_deg?: number;
}
export interface LimitCheck {
  quantity: string;
  error: number;
  U: number;
  at_least: number;
  k: number;
  limit: number;
  conformity: "conforming" | "not conforming" | "undecided";
}
export interface ValidatedPose {
  series: string;
  pose: string;
  before: PoseError;
  after: PoseError;
  predicted_U_mm?: Vector;
  predicted_U_deg?: number;
  predicted_U_tilt_deg?: Vector;
}
export interface PoseError {
  d_rho_mm: number;
  d_v_mm: number;
  d_phi_deg: number | null;
}
export interface CheckedReading {
  reading: string;
  before_mm: number;
  after_mm: number;
  sigma_mm: number;
  U_mm: number;
}
export interface Agreement {
  chi_square: number;
  dof: number;
  noise_dof: number | null;
  chance: number;
  contradicts: boolean;
}
export interface Sensitivity {
  quantity: string;
  poses: number;
  global: PerSource;
  global_error: PerSource;
  largest: PerSource;
  local?: PerSource;
  worst: WorstPose;
  contributors: Contributors;
  half_widths: HalfWidths;
  drawing: Drawing;
  assumed: Assumed;
}
export interface PerSource {
  [k: string]: number;
}
export interface WorstPose {
  x_mm: number;
  y_mm: number;
  z_mm: number;
  phi_deg: number;
  tilt_x_deg?: number;
  tilt_y_deg?: number;
  tilt_z_deg?: number;
  [k: string]: number | undefined;
}
export interface Contributor {
  name: string;
  share: number;
}
export interface Drawing {
  [k: string]: DrawingStatement;
}
export interface DrawingStatement {
  statement: string | null;
  grade: string | null;
  text: string;
}
export interface Allocation {
  status: "optimal" | "feasible" | "infeasible" | "not converged";
  reason: string;
  cost: number;
  tolerances?: TiltGroup;
  bound?: "sum-of-maxima" | "true-maximum";
  max_tilt_3sigma?: number;
  half_widths: HalfWidths;
  drawing: Drawing;
  requirements: RequirementOutcome[];
  failure?: Failure;
  failure_price?: number;
  assumed: Assumed;
}
export interface TiltGroup {
  rod_difference_over_c: number;
  width_difference_over_c: number;
  alpha03: number;
  beta03: number;
  alpha2: number;
  beta2: number;
}
export interface RequirementOutcome {
  quantity: string;
  criterion: "statistical" | "worst-case" | "yield";
  worst_pose: Pose;
  price: number;
  [k: string]: number | string | "statistical" | "worst-case" | "yield" | Pose;
}
export interface Pose {
  x_mm: number;
  y_mm: number;
  z_mm: number;
  phi_deg: number;
  tilt_x_deg?: number;
  tilt_y_deg?: number;
  tilt_z_deg?: number;
}
export interface Failure {
  status: "settled" | "impossible" | "unsettled";
  reason: string;
  linear: WeighedShare;
  check: WeighedShare;
  exact: WeighedShare | null;
  not_closed: number;
}
export interface WeighedShare {
  value: number;
  low: number;
  high: number;
  machines: number;
  effective: number;
}
export interface Analysis {
  model: "linear" | "exact";
  machines: number;
  converged: boolean;
  not_closed: number;
  confidence: number;
  requirements: [Requirement, ...Requirement[]];
  worst_case: number;
  rss_3sigma: number;
  monte_carlo_3sigma: number;
  monte_carlo_3sigma_interval: Interval;
  contributors: Contributors;
  yield: Proportion;
  dpmo: Proportion;
  failure: Failure;
  sobol?: SobolIndex[];
  linearity?: LinearityPoint[];
  half_widths: HalfWidths;
  drawing: Drawing;
  assumed: Assumed;
}
export interface Requirement {
  quantity: string;
  unit: "mm" | "deg" | "rad";
  limit: number;
  worst_case: number;
  worst_case_pose: Pose;
  rss_3sigma: number;
  rss_pose: Pose;
  monte_carlo_3sigma: number;
  monte_carlo_3sigma_interval: Interval;
  monte_carlo_pose: Pose;
  cpk: number | null;
  passed: number;
  contributors: Contributors;
  largest_on_a_machine: LargestOnAMachine;
  failure: Failure;
}
export interface LargestOnAMachine {
  p50: number;
  p90: number;
  p95: number;
  p99: number;
  p95_interval: Interval;
}
export interface Proportion {
  value: number;
  low: number;
  high: number;
}
export interface SobolIndex {
  name: string;
  first: number;
  first_interval: Interval;
  total: number;
  total_interval: Interval;
}
export interface LinearityPoint {
  factor: number;
  difference: number;
  not_closed: number;
}
export interface Yield {
  machines_asked: number;
  partial: boolean;
  machines: number;
  produced: number;
  unseen: number;
  fates: Fates;
  confidence: number;
  passed: number | null;
  yield: YieldOfMachines | null;
  dpmo: Defects | null;
  quantities: Quantities;
  min_yield?: number;
  assumed: Assumed;
  batch: Batch;
  inputs: InputFile[];
}
export interface Fates {
  accepted: number;
  rejected: number;
  not_identifiable: number;
  not_converged: number;
  does_not_close: number;
}
export interface YieldOfMachines {
  value: number | null;
  low: number;
  high: number;
  confidence: number;
}
export interface Defects {
  value: number | null;
  low: number;
  high: number;
}
export interface Quantities {
  distance_mm: BeforeAndAfter;
  volumetric_mm: BeforeAndAfter;
  volumetric_aligned_mm: BeforeAndAfter;
  rotation_deg: BeforeAndAfter | null;
  tilt_rad: BeforeAndAfter;
}
export interface BeforeAndAfter {
  before: Spread;
  after: Spread;
}
export interface Spread {
  mean: number | null;
  std: number | null;
  p50: number | null;
  p90: number | null;
  p95: number | null;
  p99: number | null;
  p99_73: number | null;
  p99_9: number | null;
  p95_interval: IntervalOverMachines;
  intervals: PercentileIntervals;
}
export interface PercentileIntervals {
  p50: IntervalOverMachines;
  p90: IntervalOverMachines;
  p95: IntervalOverMachines;
  p99: IntervalOverMachines;
  p99_73: IntervalOverMachines;
  p99_9: IntervalOverMachines;
}
export interface Batch {
  program: string;
  build: string;
  seed: number;
  robot: Robot;
  limb_azimuth_rad: number[];
  rotation_rad: Interval;
  robot_tolerances: ExactTolerances | null;
  tolerances: ExactTolerances;
  stations: Stations;
  validation: Stations;
  instrument: VirtualInstrument;
  calibration: CalibrationOptions;
  rotation_sigma_rad: number;
  priors: ExactTolerances | null;
  limits: BatchLimits;
  first_order: boolean;
}
export interface ExactTolerances {
  half_width: number[];
  distribution: "normal" | "uniform" | "truncated_normal";
  measured?: {
    [k: string]: number[];
  };
}
export interface Stations {
  count: number;
  sha256: string;
}
export interface VirtualInstrument {
  noise_mm: number;
  repeatability_mm: number;
  repeats: number;
  reads_rotation: boolean;
  rotation_noise_rad: number;
  rotation: [Vector, Vector, Vector];
  translation_mm: Vector;
  reads_orientation?: true;
  tracker?: TrackerNoise;
  second_reflector_mm?: Vector;
}
export interface BatchLimits {
  distance_mm?: number;
  volumetric_mm?: number;
  volumetric_aligned_mm?: number;
  rotation_rad?: number;
  tilt_rad?: number;
}
export interface Reproduction {
  paper: string;
  rule: string[];
  rows: Row[];
  counts: Counts;
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
  verdict: "reproduced" | "not contradicted" | "not reproduced" | "cannot be tested";
  reason: string;
}
export interface Counts {
  reproduced: number;
  not_contradicted: number;
  not_reproduced: number;
  cannot_be_tested: number;
}
export interface Figures {
  scene?: Scene;
  error_map?: ErrorMap;
  observability?: ObservabilityCurves;
  sigma_map?: SigmaMap;
  largest_on_a_machine?: RequirementHistogram[];
  largest_of_a_machine?: ErrorHistogram[];
}
export interface Scene {
  measured: boolean;
  poses: ScenePose[];
}
export interface ScenePose {
  pose: string;
  position_mm: Vector;
  rotation_deg: number;
  before_mm: Vector;
  after_mm: Vector | null;
  tilt_rad: [number, number] | null;
  tilt_deg?: Vector;
  normal?: Vector;
  limbs?: DrawnLimb[];
}
export interface DrawnLimb {
  base_mm: Vector;
  elbow_mm?: Vector;
  rods_mm: [Vector, Vector][];
}
export interface ErrorMap {
  radii_mm: number[];
  azimuths_deg: number[];
  layers_mm: number[];
  coverage_factor: number;
  points: ErrorMapPoint[];
}
export interface ErrorMapPoint {
  x_mm: number;
  y_mm: number;
  z_mm: number;
  distance_before_mm: number;
  distance_after_mm: number | null;
  position_before_mm: number;
  position_after_mm: number | null;
  rotation_before_deg?: number;
  rotation_after_deg?: number | null;
}
export interface ObservabilityCurves {
  rough: Curve;
  fine: Curve;
}
export interface Curve {
  n: number;
  curve: RoundedCurvePoint[];
}
export interface RoundedCurvePoint {
  n: number;
  O2: number;
  change: number;
}
export interface SigmaMap {
  radii_mm: number[];
  azimuths_deg: number[];
  layers_mm: number[];
  quantity: string;
  unit: "mm" | "deg" | "rad";
  points: SigmaMapPoint[];
}
export interface SigmaMapPoint {
  x_mm: number;
  y_mm: number;
  z_mm: number;
  value: number;
}
export interface RequirementHistogram {
  quantity: string;
  unit: "mm" | "deg" | "rad";
  limit: number;
  machines: Bins;
}
export interface Bins {
  bin_width: number;
  counts: number[];
  total: number;
}
export interface ErrorHistogram {
  quantity: string;
  limit?: number;
  before: Bins;
  after: Bins;
}
