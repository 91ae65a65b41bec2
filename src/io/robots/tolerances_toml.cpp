#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/tables/names.hpp"
#include "paracal/error.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/tolerance/drawing_statement.hpp"
#include "robot_tables.hpp"

namespace paracal::io {
namespace {

constexpr std::string_view kGenerous = "generous";

/// Reads one table of tolerances.
class ToleranceTable {
 public:
  ToleranceTable(Section section, const Limbs& limbs)
      : section_(std::move(section)), limbs_(limbs), actuator_(actuator_of(limbs)) {}

  Tolerances read() && {
    for (const Source source : sources_of(limbs_)) tolerances_[source] = half_width(source);
    read_distribution();
    read_measured();
    read_generous();
    const std::string others = read_others();
    section_.refuse_others();
    settle(others);
    list_assumed(tolerances_, limbs_);
    return std::move(tolerances_);
  }

 private:
  std::string key(Source source) const { return file_key(source, actuator_); }

  /// Of what a part can be off, in the unit of the file.
  double limit(Source source) const { return to_file_unit(unit(source, actuator_), largest_error(limbs_, source)); }

  double half_width(Source source) {
    const toml::node* node = section_.find(key(source));
    if (node == nullptr) return 0.0;
    const Unit inside = unit(source, actuator_);
    const double value = node->is_string() ? to_file_unit(inside, drawn(source, *node))
                                           : section_.number(key(source), plausible::kFinite);
    if (value < 0.0 || value >= limit(source)) {
      section_.fail(*node, fmt::format("expected a half-width of at least 0 and below {:.4g} for {}, got {:g}",
                                       limit(source), section_.key_path(key(source)), value));
    }
    return from_file_unit(inside, value);
  }

  /// What a drawing says.
  double drawn(Source source, const toml::node& node) const {
    try {
      return half_width_of(**node.as_string(), drawn_feature(source, limbs_));
    } catch (const InvalidArgument& complaint) {
      section_.fail(node, fmt::format("{}: {}", section_.key_path(key(source)), complaint.what()));
    }
  }

  void read_distribution() {
    const toml::node* node = section_.find("distribution");
    if (node == nullptr) return;
    const std::string name = section_.text("distribution");
    const std::optional<Distribution> distribution = distribution_named(name);
    if (!distribution) {
      section_.fail(*node, fmt::format("expected {} for {}, got \"{}\"", distribution_names(),
                                       section_.key_path("distribution"), name));
    }
    tolerances_.distribution = *distribution;
  }

  void read_measured() {
    std::optional<Section> measured = section_.optional_table("measured");
    if (!measured) return;
    for (const Source source : sources_of(limbs_)) {
      if (measured->find(key(source)) == nullptr) continue;
      for (const double value : measured->numbers(key(source), plausible::kFinite)) {
        if (std::abs(value) >= limit(source)) {
          section_.fail(*measured->find(key(source)),
                        fmt::format("expected {} within {:.4g}, got {:g}", measured->key_path(key(source)),
                                    limit(source), value));
        }
        tolerances_.measured[source].push_back(from_file_unit(unit(source, actuator_), value));
      }
    }
    measured->refuse_others();
  }

  /// Keys whose values nobody states, as the program itself has written them.
  void read_generous() {
    const toml::node* node = section_.find(kGenerous);
    if (node == nullptr) return;
    for (const std::string& name : section_.texts(kGenerous)) {
      bool known = false;
      for (const Source source : sources_of(limbs_)) {
        if (key(source) != name) continue;
        tolerances_.origin[source] = Origin::generous;
        known = true;
      }
      if (!known) {
        section_.fail(
            *node, fmt::format("expected names of tolerances for {}, got \"{}\"", section_.key_path(kGenerous), name));
      }
    }
  }

  bool is_open(Source source) { return section_.find(key(source)) == nullptr && tolerances_.measured[source].empty(); }

  /// Empty where the table does not say.
  std::string read_others() {
    const toml::node* node = section_.find("others");
    if (node == nullptr) return "";
    std::string others = section_.text("others");
    if (others == "exact" || others == kGenerous) return others;
    section_.fail(*node, fmt::format("expected \"exact\" or \"{}\" for {}, got \"{}\"", kGenerous,
                                     section_.key_path("others"), others));
  }

  /// Gives a half-width to all that the table does not list.
  void settle(const std::string& others) {
    const Tolerances generous = generous_tolerances(limbs_);
    std::string missing;
    for (const Source source : sources_of(limbs_)) {
      if (!is_open(source)) continue;
      tolerances_.origin[source] = others == kGenerous ? Origin::generous : Origin::exact;
      if (others == kGenerous) tolerances_[source] = generous[source];
      if (!is_leading(source)) continue;  // the key of the first
      missing.append(missing.empty() ? "" : ", ").append(key(source));
    }
    if (!others.empty() || missing.empty()) return;
    section_.fail(
        fmt::format("expected every tolerance, or {0} = \"exact\" (zero for the others) or {0} = \"{2}\" "
                    "(default tolerances for the others); got no {0} and no {1}",
                    section_.key_path("others"), missing, kGenerous));
  }

  Section section_;
  const Limbs& limbs_;
  Actuator actuator_;
  Tolerances tolerances_;
};

}  // namespace

Tolerances tolerances_of(Section section, const Limbs& limbs) {
  return ToleranceTable(std::move(section), limbs).read();
}

namespace {

/// A line a listed source, with what `remark` says of it behind the longest of them.
std::string half_widths_toml(const Tolerances& tolerances, const Limbs& limbs, const auto& remark) {
  std::vector<std::pair<std::string, std::string>> lines;
  std::size_t longest = 0;
  for (const Source source : listed_tolerances(tolerances, limbs)) {
    const double value = tidy(to_file_unit(unit(source, actuator_of(limbs)), tolerances[source]));
    lines.emplace_back(fmt::format("{} = {}", file_key(source, actuator_of(limbs)), value), remark(source));
    longest = std::max(longest, lines.back().first.size());
  }
  std::string text;
  for (const auto& [line, said] : lines) {
    text += said.empty() ? line + "\n" : fmt::format("{:<{}}  # {}\n", line, longest, said);
  }
  return text;
}

std::string tolerances_toml(const Tolerances& tolerances, const Limbs& limbs, const auto& remark) {
  std::string text = "[tolerances]  # half-widths, 3 sigma\n" + half_widths_toml(tolerances, limbs, remark);
  std::string measured;
  for (const Source source : listed_tolerances(tolerances, limbs)) {
    std::vector<double> values;
    for (const double value : tolerances.measured[source]) {
      values.push_back(tidy(to_file_unit(unit(source, actuator_of(limbs)), value)));
    }
    if (!values.empty()) measured += fmt::format("{} = {}\n", file_key(source, actuator_of(limbs)), array(values));
  }
  if (listed_tolerances(tolerances, limbs).size() < leading_sources(limbs).size()) text += "others = \"exact\"\n";
  const std::vector<std::string> generous = generous_keys(tolerances, limbs);
  if (!generous.empty()) {
    text += fmt::format("{} = [\"{}\"]  # default tolerances: state yours\n", kGenerous, fmt::join(generous, "\", \""));
  }
  text += fmt::format("distribution = \"{}\"\n", distribution_name(tolerances.distribution));
  if (!measured.empty()) text += "\n[tolerances.measured]  # errors of built parts\n" + measured;
  return text;
}

}  // namespace

std::string tolerances_toml(const Tolerances& tolerances, const Limbs& limbs) {
  return tolerances_toml(tolerances, limbs, [](Source) { return std::string(); });
}

std::string tolerances_toml(const Tolerances& tolerances, const Robot& robot) {
  return tolerances_toml(tolerances, robot.limbs(), [&](Source source) {
    return on_a_drawing(tolerances, source, robot).value_or(DrawingStatement()).text;
  });
}

Tolerances read_tolerances(const TextFile& file, const Robot& robot) {
  const toml::table document = parse_toml(file);
  Section root(file.name, "", document);
  if (root.find("tolerances") == nullptr) return tolerances_of(root, robot.limbs());
  // The table may stand in a robot file.
  for (const char* key : {"name", "geometry", "plate", "limb", "workspace", "controller", "joints", "error"}) {
    (void)root.find(key);
  }
  root.refuse_others();
  return tolerances_of(root.table("tolerances"), robot.limbs());
}

}  // namespace paracal::io
