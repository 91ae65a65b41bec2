#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "failure_fields.hpp"
#include "io/tables/names.hpp"
#include "paracal/batch/error_spread.hpp"
#include "paracal/batch/tally.hpp"
#include "paracal/io/json.hpp"
#include "paracal/units.hpp"
#include "paracal/version.hpp"

namespace paracal::io {
namespace {

/// To the last bit; to_json(Tolerances) is for reading and rounds.
Json exact(const std::optional<Tolerances>& tolerances, const Robot& robot) {
  if (!tolerances) return nullptr;
  Json json{{"half_width", Json::array()}, {"distribution", distribution_name(tolerances->distribution)}};
  for (const Source source : sources_of(robot.limbs())) {
    const std::vector<double>& measured = tolerances->measured[source];
    json["half_width"].push_back((*tolerances)[source]);
    if (!measured.empty()) json["measured"][std::string(name(source))] = json_array(measured);
  }
  return json;
}

/// Too many numbers to read: how many, and a hash that tells them apart.
Json digest(const std::vector<Station>& stations) {
  Json all = Json::array();
  for (const Station& station : stations) {
    Json row = json_array(station.commanded.position);
    row.push_back(station.commanded.rotation);
    if (!station.commanded.tilt.isZero(0.0)) row.push_back(json_array(station.commanded.tilt));
    if (station.believed) row.push_back(json_array(*station.believed));
    all.push_back(std::move(row));
  }
  return {{"count", stations.size()}, {"sha256", sha256(all.dump())}};
}

Json instrument_json(const VirtualInstrument& instrument) {
  Json json{{"noise_mm", instrument.noise},
            {"repeatability_mm", instrument.repeatability},
            {"repeats", instrument.repeats},
            {"reads_rotation", instrument.reads_rotation},
            {"rotation_noise_rad", instrument.rotation_noise},
            {"rotation", rows_json(instrument.frame.rotation)},
            {"translation_mm", json_array(instrument.frame.translation)}};
  if (instrument.reads_orientation) json["reads_orientation"] = true;
  if (instrument.tracker) json["tracker"] = to_json(*instrument.tracker);
  if (instrument.second) json["second_reflector_mm"] = json_array(*instrument.second);
  return json;
}

/// "tilt_rad", "distance_mm".
std::string key_of(ErrorKind kind, std::string_view angle_unit) {
  return fmt::format("{}_{}", name(kind), unit(kind) == Unit::mm ? "mm" : angle_unit);
}

constexpr std::array<std::pair<const char*, double>, 6> kPercentiles{
    {{"p50", 0.5}, {"p90", 0.9}, {"p95", 0.95}, {"p99", 0.99}, {"p99_73", 0.9973}, {"p99_9", 0.999}}};

Json limits_json(const PerErrorKind<std::optional<double>>& limits) {
  Json json = Json::object();
  for (const ErrorKind kind : kErrorKinds) {
    if (limits[kind]) json[key_of(kind, "rad")] = *limits[kind];
  }
  return json;
}

Json statistics(const ErrorSpread& spread, double factor, double confidence) {
  const auto [mean, std] = spread.moments();
  Json json{{"mean", factor * mean}, {"std", factor * std}};
  Json intervals;
  for (const auto& [key, share] : kPercentiles) {
    json[key] = factor * spread.quantile(share);
    intervals[key] = interval_json(spread.quantile_interval(share, confidence), factor);
  }
  json["p95_interval"] = intervals["p95"];
  json["intervals"] = std::move(intervals);
  return json;
}

/// Rotations are stated in deg, tilt in rad, as everywhere.
Json quantities_json(const Batch& batch, const Tally& tally, double confidence) {
  Json json;
  for (const ErrorKind kind : kErrorKinds) {
    const bool turned = kind == ErrorKind::rotation;
    Json& entry = json[key_of(kind, turned ? "deg" : "rad")];
    if (turned && !turns(batch.robot)) continue;
    const double factor = turned ? to_degrees(1.0) : 1.0;
    for (const bool after : {false, true}) {
      const ErrorSpread spread(tally, {.kind = kind, .after = after});
      entry[after ? "after" : "before"] = statistics(spread, factor, confidence);
    }
  }
  return json;
}

/// Null where no limits were stated: then nothing passes, and nothing fails.
Json passed_json(const Batch& batch, const Tally& tally, double confidence) {
  if (!has_limits(batch.plan)) return {{"passed", nullptr}, {"yield", nullptr}, {"dpmo", nullptr}};
  const Proportion share = yield(tally, confidence);
  const auto passed = tally.first_order && tally.produced() > 0
                          ? std::llround(share.value * static_cast<double>(tally.machines()))
                          : static_cast<std::int64_t>(tally.passed);
  Json json{{"passed", passed}, {"yield", to_json(share)}, {"dpmo", to_json(defects_per_million(share))}};
  json["yield"]["confidence"] = confidence;
  return json;
}

}  // namespace

Json to_json(const FailureShare& failures) { return stored(failures); }

Json to_json(const Proportion& proportion) { return stored(proportion); }

Json interval_json(const Interval& interval, double factor) {
  return Json::array({factor * interval.low, factor * interval.high});
}

Json to_json(const Batch& batch) {
  const auto& [robot, plan, seed, surrogate] = batch;
  return {{"program", fmt::format("paracal {}", version())},
          {"build", build()},
          {"seed", seed},
          {"robot", to_json(robot)},
          {"limb_azimuth_rad", json_array(robot.limbs(), azimuth_of)},
          {"rotation_rad", {robot.workspace().min_rotation, robot.workspace().max_rotation}},
          {"robot_tolerances", exact(robot.tolerances(), robot)},
          {"tolerances", exact(plan.tolerances, robot)},
          {"stations", digest(plan.stations)},
          {"validation", digest(plan.validation)},
          {"instrument", instrument_json(plan.instrument)},
          {"calibration", to_json(plan.calibration, robot.limbs())},
          {"rotation_sigma_rad", plan.calibration.noise.rotation},
          {"priors", exact(plan.calibration.tolerances, robot)},
          {"limits", limits_json(plan.limits)},
          {"first_order", surrogate != nullptr}};
}

Json to_json(const Batch& batch, const Tally& tally, double confidence) {
  Json json{{"machines", tally.machines()}, {"produced", tally.produced()}};
  json["unseen"] = unseen_share(tally, confidence);
  for (const Fate fate : kFates) json["fates"][std::string(name(fate))] = tally.of(fate);
  json["confidence"] = confidence;
  json.update(passed_json(batch, tally, confidence));
  json["quantities"] = quantities_json(batch, tally, confidence);
  return json;
}

}  // namespace paracal::io
