// Are the tolerances good? An analysis, an allocation, sensitivities.
import type { Allocation, Analysis, Sensitivity } from "../data";
import { digits, exact, milli, percent, withUncertainty } from "../numbers";
import { strings } from "../strings";
import { assumptions, card, unitOf, type Verdict } from "./card";

const text = strings.verdict;

export function ofAnalysis(analysis: Analysis): Verdict {
  const { yield: share, requirements } = analysis;
  const kept = requirements.every((one) => one.monte_carlo_3sigma <= one.limit);
  return {
    yes: analysis.converged && kept,
    says: !analysis.converged ? text.no.converged : kept ? text.yes.analysis : text.no.analysis,
    sentence: `${text.yield}: ${percent(share.value, 4)}. ${text.simulated(String(analysis.machines), analysis.model)}`,
    cards: [
      card(text.yield, [percent(share.value, 4)], [text.interval(percent(share.low, 4), percent(share.high, 4), analysis.confidence)]),
      ...requirements.map((one) => {
        const { scale, unit } = milli(one.unit), [low, high] = one.monte_carlo_3sigma_interval;
        return card(text.threeSigma(one.quantity), [withUncertainty(scale * one.monte_carlo_3sigma, (scale * (high - low)) / 2), unitOf(unit)], [
          text.limit(`${digits(scale * one.limit)} ${unit}`, digits(one.cpk)),
          text.worstCase(`${digits(scale * one.worst_case)} ${unit}`),
        ]);
      }),
    ],
    notes: assumptions(analysis.assumed),
  };
}

export function ofAllocation(allocation: Allocation): Verdict {
  const found = allocation.reason === "";
  const requirements = allocation.requirements.map((one) => {
    const key = Object.keys(one).find((name) => name.startsWith("worst_") && name !== "worst_pose")!;
    const { scale, unit } = milli(key.slice("worst_".length));
    const [worst, limit] = [one[key], one[key.replace("worst", "limit")]] as [number, number];
    return card(text.largest(one.quantity, one.criterion), [digits(scale * worst), unitOf(unit)], [text.allocated(`${digits(scale * limit)} ${unit}`)]);
  });
  return {
    yes: found,
    says: found ? text.yes.allocation : `${text.no.allocation}: ${allocation.status}`,
    sentence: allocation.max_tilt_3sigma === undefined ? allocation.status : text.allocation(digits(1e3 * allocation.max_tilt_3sigma)),
    reasons: found ? [] : [allocation.reason],
    cards: [...requirements, card(text.cost, [digits(allocation.cost, 4)])],
    notes: assumptions(allocation.assumed),
  };
}

export function ofSensitivity({ quantity, poses, worst, assumed }: Sensitivity): Verdict {
  const key = Object.keys(worst).find((name) => name.startsWith("three_sigma_"))!;
  const { scale, unit } = milli(key.slice(key.lastIndexOf("_") + 1));
  const whole = (key: string) => exact(Math.round(worst[key]!));
  const [x, y, z] = ["x_mm", "y_mm", "z_mm"].map(whole) as [string, string, string];
  const tilted = "tilt_x_deg" in worst ? `, ${strings.robot.tiltedBy(["tilt_x_deg", "tilt_y_deg", "tilt_z_deg"].map(whole))}` : "";
  return {
    yes: null,
    says: text.yes.sensitivity,
    sentence: text.sensitivity(quantity, poses),
    cards: [card(text.worst, [digits(scale * worst[key]!), unitOf(unit)], [text.at(x, y, z) + tilted])],
    notes: assumptions(assumed),
  };
}
