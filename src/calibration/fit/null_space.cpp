#include "null_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "numerics/dense.hpp"
#include "paracal/calibration/identifiability.hpp"
#include "paracal/kinematics/error_model.hpp"
#include "paracal/mechanism/base_motion.hpp"
#include "sought.hpp"

namespace paracal {
namespace {

Eigen::VectorXd components(const SourceErrors& errors, const std::vector<SoughtSource>& parameters) {
  Eigen::VectorXd vector(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    vector(static_cast<Eigen::Index>(k)) = errors(parameters[k].limb, parameters[k].source);
  }
  return vector;
}

/// Every limb shifted by factor(limb) times a direction.
template <typename Factor>
SourceErrors moved_along(const Robot& robot, const Eigen::Vector3d& direction, Factor&& factor) {
  SourceErrors errors;
  for (std::size_t i = 0; i < robot.limb_count(); ++i) {
    shift_limb(robot, i, factor(robot.nominal().limbs[i]) * direction, errors);
  }
  return errors;
}

/// "e_x of limb 2 against rod_mean of limb 3": the largest parameters of a direction, three at most.
std::string describe(const Eigen::VectorXd& direction, const std::vector<SoughtSource>& parameters) {
  constexpr double kSmallest = 0.05;
  constexpr std::size_t kMost = 3;
  std::vector<std::size_t> main(parameters.size());
  std::iota(main.begin(), main.end(), std::size_t{0});
  const auto part = [&](std::size_t k) { return direction(static_cast<Eigen::Index>(k)); };
  std::erase_if(main, [&](std::size_t k) { return std::abs(part(k)) < kSmallest; });
  // What rounding makes unequal stays in the order of the parameters.
  const auto size = [&](std::size_t k) { return std::lround(std::abs(part(k)) / 0.01); };
  std::ranges::stable_sort(main, std::ranges::greater{}, size);
  const bool is_whole = main.size() <= kMost;
  main.resize(std::min(main.size(), kMost));
  std::string with, against;
  for (const std::size_t k : main) {
    std::string& side = part(k) * part(main.front()) > 0.0 ? with : against;
    side +=
        fmt::format("{}{} of limb {}", side.empty() ? "" : " and ", name(parameters[k].source), parameters[k].limb + 1);
  }
  return (is_whole ? "" : "mainly ") + with + (against.empty() ? "" : " against " + against);
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns, Eigen::Index count) {
  return detail::orthonormal_basis(columns).leftCols(count);
}

/// The base joint on a rail that leans shifts along it in more than one coordinate; of one along a coordinate, this
/// error has the effect of the joint zero and is not sought.
bool slides_on_its_rail(const Robot& robot, std::size_t limb) {
  const Actuator kind = robot.limbs()[limb].kind;
  if (!runs_on_rail(kind) || !has(kind, "e_x")) return false;
  return std::ranges::none_of(robot.parameters(),
                              [&](const Parameter& one) { return one.limb == limb && one.as_joint_zero != 0.0; });
}

/// A rail that leans by 90 deg lies along the axis of alpha0, which then turns it about itself.
bool is_turned_about_itself(const Robot& robot, std::size_t limb) {
  constexpr double kParallel = 1e-9;  // sine
  const Limb& rail = robot.nominal().limbs[limb];
  return runs_on_rail(rail.actuator) && has(rail.actuator, "e_x") &&
         as_eigen(rail.normal).cross(radial_of(robot.limbs()[limb])).norm() < kParallel;
}

}  // namespace

std::vector<GaugeMotion> gauge_motions(const Robot& robot) {
  std::vector<GaugeMotion> motions;
  motions.reserve(12);
  const auto alike = [](const Limb&) { return 1.0; };
  const std::array<std::string, 3> axes{"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    motions.push_back({fmt::format("the whole robot shifts along {}", axes[static_cast<std::size_t>(k)]),
                       moved_along(robot, Eigen::Vector3d::Unit(k), alike)});
  }
  if (robot.slide()) {
    const auto sign = [](const Limb& limb) { return limb.slide_sign; };
    motions.push_back({"the slide zero shifts", moved_along(robot, robot.slide()->axis, sign)});
    motions.push_back({"the base rotates about the slide axis", turned_base(robot, robot.slide()->axis)});
  }
  // Before turns of the base: about z none of alpha0 and beta0 turns such rails.
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    if (!is_turned_about_itself(robot, limb)) continue;
    const Limb& rail = robot.nominal().limbs[limb];
    SourceErrors errors;
    const Eigen::Vector3d radial = radial_of(robot.limbs()[limb]);
    shift_limb(robot, limb, rail.arm * radial.cross(as_eigen(rail.radial)), errors);  // its carriage stays
    errors(limb, "alpha0") += 1.0;
    motions.push_back({fmt::format("the rail of limb {} turns about itself", limb + 1), errors});
  }
  for (int k = 0; k < 3; ++k) {
    motions.push_back({fmt::format("the base rotates about {}", axes[static_cast<std::size_t>(k)]),
                       turned_base(robot, Eigen::Vector3d::Unit(k))});
  }
  for (std::size_t limb = 0; limb < robot.limb_count(); ++limb) {
    if (!slides_on_its_rail(robot, limb)) continue;
    SourceErrors errors;
    shift_limb(robot, limb, as_eigen(robot.nominal().limbs[limb].normal), errors);
    errors(limb, "theta_offset") -= 1.0;
    motions.push_back({fmt::format("limb {} shifts along its rail and its theta_offset back", limb + 1), errors});
  }
  for (int k = 0; !robot.is_level() && k < 3; ++k) {
    const std::string& axis = axes[static_cast<std::size_t>(k)];
    const Eigen::Vector3d along = Eigen::Vector3d::Unit(k), none = Eigen::Vector3d::Zero();
    motions.push_back({fmt::format("the plate's joints shift along {}", axis), moved_plate(robot, along, none)});
    motions.push_back({fmt::format("the plate's joints rotate about {}", axis), moved_plate(robot, none, along)});
  }
  return motions;
}

namespace {

/// Names of the gauge motions that a direction is a mixture of when the parameters not sought stay at zero; empty when
/// it is none: "the slide zero shifts and the whole robot shifts along y".
std::string as_mixture(const Robot& robot, const Eigen::VectorXd& direction,
                       const std::vector<SoughtSource>& parameters) {
  constexpr double kInside = 1e-5, kSmallestShare = 0.05;
  const std::vector<SoughtSource> all = detail::position_group(robot, {});
  const Eigen::VectorXd scale = detail::paper_scales(robot, all);
  const std::vector<GaugeMotion> motions = gauge_motions(robot);
  Eigen::MatrixXd columns(scale.size(), static_cast<Eigen::Index>(motions.size()));
  for (std::size_t k = 0; k < motions.size(); ++k) {
    columns.col(static_cast<Eigen::Index>(k)) = scale.cwiseProduct(components(motions[k].direction, all)).normalized();
  }
  const Eigen::VectorXd whole = scale.cwiseProduct(detail::among(direction, parameters, all)).normalized();
  const Eigen::VectorXd shares = detail::least_squares(columns, whole);
  if ((columns * shares - whole).norm() > kInside) return {};
  std::string text;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    if (std::abs(shares(static_cast<Eigen::Index>(k))) < kSmallestShare) continue;
    text += (text.empty() ? "" : " and ") + motions[k].text;
  }
  return text;
}

/// Parameters that are in the null space by themselves.
/// @param space  orthonormal columns.
std::vector<Eigen::Index> alone_in(const Eigen::MatrixXd& space) {
  constexpr double kOutside = 1e-6;
  std::vector<Eigen::Index> alone;
  for (Eigen::Index k = 0; k < space.rows(); ++k) {
    const Eigen::VectorXd inside = detail::product(space, space.row(k).transpose());
    if ((inside - Eigen::VectorXd::Unit(space.rows(), k)).norm() < kOutside) alone.push_back(k);
  }
  return alone;
}

/// By itself, as that of a rail whose carriage has its joints on it.
bool turns_rail_about_itself(const Robot& robot, const SoughtSource& one) {
  const bool alone = robot.nominal().limbs[one.limb].arm == 0.0;
  return alone && one.source == "alpha0" && is_turned_about_itself(robot, one.limb);
}

}  // namespace

namespace detail {

std::string undetermined_lines(const std::vector<NullDirection>& null_space) {
  constexpr std::size_t kMost = 5;
  const std::size_t shown = std::min(null_space.size(), kMost), further = null_space.size() - shown;
  std::string text;
  for (std::size_t k = 0; k < shown; ++k) {
    text += fmt::format("  not determined by these measurements: {}\n", null_space[k].text);
  }
  if (further == 0) return text;
  return text + fmt::format("  and {} further {} of parameters (--json lists all under null_space)\n", further,
                            further == 1 ? "combination" : "combinations");
}

std::vector<NullDirection> in_words(const Robot& robot, const Eigen::MatrixXd& null_space,
                                    const std::vector<SoughtSource>& parameters) {
  constexpr double kInside = 1e-5, kNew = 0.1;
  const Eigen::VectorXd scale = paper_scales(robot, parameters);
  std::vector<NullDirection> directions;
  if (null_space.cols() == 0) return directions;
  const auto add = [&](std::string motion, const Eigen::VectorXd& scaled) {
    const Eigen::VectorXd direction = scaled.cwiseQuotient(scale).normalized();
    if (!motion.empty()) return directions.push_back({std::move(motion), direction, true});
    const std::string mixture = as_mixture(robot, direction, parameters);
    const std::string sum = describe(direction, parameters);
    directions.push_back({mixture.empty() ? sum : mixture + ": " + sum, direction, !mixture.empty()});
  };
  const Eigen::MatrixXd all = orthonormal(scale.asDiagonal() * null_space, null_space.cols());
  const std::vector<SoughtSource> group = position_group(robot, {});
  const std::vector<Eigen::Index> alone = alone_in(all);
  Eigen::MatrixXd explained = Eigen::MatrixXd::Identity(all.rows(), all.rows())(Eigen::all, alone);
  for (GaugeMotion& motion : gauge_motions(robot)) {
    const Eigen::VectorXd part = scale.cwiseProduct(components(motion.direction, parameters));
    const Eigen::VectorXd whole = paper_scales(robot, group).cwiseProduct(components(motion.direction, group));
    if (part.norm() < (1.0 - kInside) * whole.norm()) continue;  // the robot would not move as a whole
    const Eigen::VectorXd scaled = part.normalized();
    const Eigen::VectorXd fresh = scaled - detail::product(explained, detail::product(explained.transpose(), scaled));
    if ((scaled - detail::product(all, detail::product(all.transpose(), scaled))).norm() > kInside ||
        fresh.norm() < kNew)
      continue;
    explained.conservativeResize(Eigen::NoChange, explained.cols() + 1);
    explained.rightCols<1>() = fresh.normalized();
    add(std::move(motion.text), scaled);
  }
  for (const Eigen::Index k : alone) {
    const SoughtSource& one = parameters[static_cast<std::size_t>(k)];
    const bool never = turns_rail_about_itself(robot, one);
    directions.push_back({fmt::format("{} of limb {} ({})", name(one.source), one.limb + 1,
                                      never ? "it turns the rail about itself" : "it changes none of these readings"),
                          Eigen::VectorXd::Unit(all.rows(), k), never});
  }
  const Eigen::MatrixXd rest = orthonormal(
      all - detail::product(explained, detail::product(explained.transpose(), all)), all.cols() - explained.cols());
  for (const auto& column : rest.colwise()) add({}, column);
  return directions;
}

Eigen::VectorXd paper_scales(const Robot& robot, const std::vector<SoughtSource>& parameters) {
  Eigen::VectorXd scale(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    scale(static_cast<Eigen::Index>(k)) = robot.parameter(parameters[k].limb, parameters[k].source).lever;
  }
  return scale;
}

Eigen::VectorXd among(const Eigen::VectorXd& direction, const std::vector<SoughtSource>& of,
                      const std::vector<SoughtSource>& others) {
  Eigen::VectorXd placed = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(others.size()));
  for (std::size_t k = 0; k < of.size(); ++k) {
    const auto same = std::ranges::find_if(others, [&](const auto& one) { return is_same_error(one, of[k]); });
    if (same != others.end()) placed(same - others.begin()) = direction(static_cast<Eigen::Index>(k));
  }
  return placed;
}

}  // namespace detail
}  // namespace paracal
