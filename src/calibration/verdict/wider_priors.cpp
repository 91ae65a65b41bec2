// Priors that may be wider than the tolerances say: of groups of errors, of one kind, of one joint centre, of one
// error.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/plan/prior_promise.hpp"
#include "component_candidates.hpp"

namespace paracal::detail {
namespace {

class PriorCandidates {
 public:
  PriorCandidates(const StageFit& fit, std::vector<ComponentCandidate>& all) : fit_(fit), promise_(fit), all_(all) {}

  void add() {
    add_groups();
    add_kinds();
    add_joint_centres();
    add_ones();
  }

 private:
  using Places = std::vector<std::size_t>;

  const Robot& robot() const { return fit_.observation().robot(); }
  const std::vector<SoughtSource>& sought() const { return fit_.observation().sought(); }

  template <typename Chosen>
  Places places(Chosen&& chosen) const {
    Places list;
    for (std::size_t k = 0; k < sought().size(); ++k) {
      if (sought()[k].prior_std && chosen(sought()[k])) list.push_back(k);
    }
    return list;
  }

  void add_groups() {
    const double price = 2.0 * std::log(3.0);
    add_several(ComponentFamily::group, "all errors are", price, places([](const SoughtSource&) { return true; }));
    add_several(ComponentFamily::group, "the errors of the position group are", price,
                places([](const SoughtSource& one) { return !tilts_plate(one.source); }));
    add_several(ComponentFamily::group, "the errors of the tilt group are", price,
                places([](const SoughtSource& one) { return tilts_plate(one.source); }));
  }

  void add_kinds() {
    const double price = 2.0 * std::log(static_cast<double>(kMostSources));
    for (const Source source : sources_of(robot().geometry())) {
      add_several(ComponentFamily::kind, fmt::format("{} is, on all limbs,", name(source)), price,
                  places([source](const SoughtSource& one) { return one.source == source; }));
    }
  }

  /// A bracket that is mounted elsewhere is off in more than one coordinate.
  void add_joint_centres() {
    const std::vector<Actuator> kinds = kinds_of(robot().geometry());
    const auto with_plate_joints = std::ranges::count_if(kinds, on_single_rods);
    const double price = 2.0 * std::log(static_cast<double>(kinds.size()) + static_cast<double>(with_plate_joints));
    for (std::size_t limb = 0; limb < kinds.size(); ++limb) {
      add_joint_centre(limb, {"e_x", "e_y", "e_z", "base_x", "base_y", "base_z", "normal", "across"}, price);
      if (on_single_rods(kinds[limb])) add_joint_centre(limb, {"plate_x", "plate_y", "plate_z"}, price);
    }
  }

  void add_joint_centre(std::size_t limb, const std::vector<Source>& coordinates, double price) {
    const Places list = places([&](const SoughtSource& one) {
      return one.limb == limb && std::ranges::find(coordinates, one.source) != coordinates.end();
    });
    if (list.size() < 2) return;
    std::string names;
    for (const std::size_t k : list) names += fmt::format("{}{}", names.empty() ? "" : ", ", name_of(k));
    const std::string subject = fmt::format("{} of limb {}", names, limb + 1);
    add_several(ComponentFamily::in_limb, subject + " are", price, list, subject);
  }

  void add_ones() {
    const double price = 2.0 * std::log(static_cast<double>(std::max<std::size_t>(sought().size(), 1)));
    for (std::size_t k = 0; k < sought().size(); ++k) {
      if (!sought()[k].prior_std) continue;
      const std::string subject = fmt::format("{} of limb {}", name_of(k), sought()[k].limb + 1);
      add_prior(ComponentFamily::one, subject, price, {k}, [subject](const StageFit&, double size) {
        return fmt::format(
            "{} is {:.1f} standard deviations of its tolerance away from nominal: check the part and the tolerance",
            subject, size);
      });
    }
  }

  std::string_view name_of(std::size_t place) const { return name(sought()[place].source); }

  void add_several(ComponentFamily family, const std::string& whose, double price, Places list,
                   std::string subject = {}) {
    add_prior(family, std::move(subject), price, std::move(list), [whose](const StageFit&, double size) {
      return fmt::format("{} {:.1f} times as large as the tolerances: check them", whose, size);
    });
  }

  void add_prior(ComponentFamily family, std::string subject, double price, Places list,
                 std::function<std::string(const StageFit&, double)> say) {
    if (list.empty() || fit_.widened(list)) return;
    const PriorPromise::Drop drop = promise_.of(list, price + kWorthTrying);
    all_.push_back({.family = family,
                    .subject = std::move(subject),
                    .promised = drop.drop,
                    .price = price,
                    .begin = [list, start = drop.factor](StageFit& fit) { fit.seek_wider_priors(list, start); },
                    .size = [list](const StageFit& fit) { return fit.widened(list).value_or(1.0); },
                    .say = std::move(say)});
  }

  const StageFit& fit_;
  PriorPromise promise_;
  std::vector<ComponentCandidate>& all_;
};

}  // namespace

void add_prior_candidates(const StageFit& fit, std::vector<ComponentCandidate>& all) {
  if (has_priors(fit.observation())) PriorCandidates(fit, all).add();
}

}  // namespace paracal::detail
