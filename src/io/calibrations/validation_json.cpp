#include <cmath>

#include "paracal/io/json.hpp"
#include "paracal/units.hpp"

namespace paracal::io {
namespace {

Json criteria_json(const PoseCriteria& one) {
  Json json{{"pose", one.pose}, {"repeats", one.repeats}, {"AP_mm", one.AP},
            {"RP_mm", one.RP},  {"AD_mm", one.AD},        {"RD_mm", one.RD}};
  if (!one.AP_rotation) return json;
  json["AP_deg"] = to_degrees(*one.AP_rotation);
  json["RP_deg"] = to_degrees(*one.RP_rotation);
  return json;
}

Json iso_json(const Iso9283& iso) {
  return {{"max_AP_mm", iso.max_AP},
          {"max_RP_mm", iso.max_RP},
          {"max_AD_mm", iso.max_AD},
          {"max_RD_mm", iso.max_RD},
          {"poses", json_array(iso.poses, criteria_json)}};
}

/// Each pose against the first of its series.
Json poses_json(const Validation& validation) {
  Json json = Json::array();
  const ValidatedPose* home = nullptr;
  for (const ValidatedPose& one : validation.poses) {
    if (!home || home->series != one.series) home = &one;
    const PoseError before = error_relative_to(home->before, one.before),
                    after = error_relative_to(home->after, one.after);
    const auto error = [&](const PoseError& e) {
      Json json_error{{"d_rho_mm", e.distance}, {"d_v_mm", e.volumetric}, {"d_phi_deg", nullptr}};
      if (one.rotation) json_error["d_phi_deg"] = to_degrees(e.rotation);
      return json_error;
    };
    json.push_back({{"series", one.series}, {"pose", one.pose}, {"before", error(before)}, {"after", error(after)}});
    if (!one.covariance) continue;
    const auto U = [&](Eigen::Index k) { return kCoverageFactor * std::sqrt((*one.covariance)(k, k)); };
    json.back()["predicted_U_mm"] = {U(0), U(1), U(2)};
    if (one.covariance->rows() == 4) {
      json.back()["predicted_U_deg"] = to_degrees(U(3));
    } else {
      json.back()["predicted_U_tilt_deg"] = {to_degrees(U(3)), to_degrees(U(4)), to_degrees(U(5))};
    }
  }
  return json;
}

Json agreement_json(const Validation& validation) {
  if (!validation.agreement) return nullptr;
  const Agreement& agreement = *validation.agreement;
  return {{"chi_square", agreement.chi_square},
          {"dof", agreement.freedom},
          {"noise_dof", std::isfinite(agreement.noise_dof) ? Json(agreement.noise_dof) : Json(nullptr)},
          {"chance", agreement.chance},
          {"contradicts", agreement.contradicts()}};
}

Json reading_json(const CheckedReading& one) {
  return {{"reading", one.text},
          {"before_mm", one.before},
          {"after_mm", one.after},
          {"sigma_mm", one.sigma},
          {"U_mm", one.U}};
}

Json check_json(const LimitCheck& check) {
  return {{"quantity", check.quantity},          {"error", check.error}, {"U", check.uncertainty},
          {"at_least", check.at_least},          {"k", check.coverage},  {"limit", check.limit},
          {"conformity", name(check.conformity)}};
}

}  // namespace

Json to_json(const Validation& validation) {
  return {{"accepted", validation.accepted},
          {"reasons", validation.reasons},
          {"before", to_json(validation.before)},
          {"after", to_json(validation.after)},
          {"iso9283", iso_json(validation.iso9283)},
          {"checks", json_array(validation.checks, check_json)},
          {"poses", poses_json(validation)},
          {"readings", json_array(validation.readings, reading_json)},
          {"agreement", agreement_json(validation)},
          {"notes", validation.notes},
          {"assumed", validation.assumed}};
}

}  // namespace paracal::io
