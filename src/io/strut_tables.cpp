#include "strut_tables.hpp"

#include <fmt/format.h>

#include "json_parts.hpp"
#include "robot_tables.hpp"

namespace paracal::io {
namespace {

Eigen::Vector3d point_of(Section& limb, std::string_view key) {
  const std::vector<double> values = limb.numbers(key, 3);
  return {values[0], values[1], values[2]};
}

Strut strut_of(Section limb) {
  if (const std::string kind = limb.text("kind"); kind != "strut") {
    limb.fail(
        *limb.find("kind"),
        fmt::format("expected \"strut\" for {}, got \"{}\" (robots with arms or rails are described by [geometry])",
                    limb.key_path("kind"), kind));
  }
  Strut strut{point_of(limb, "base_joint_mm"), point_of(limb, "plate_joint_mm"), limb.number("length_at_zero_mm")};
  limb.refuse_others();
  return strut;
}

}  // namespace

bool define_limbs(const toml::table& document) {
  const toml::array* limbs = document["limb"].as_array();
  return !document.contains("geometry") && limbs != nullptr && !limbs->empty() && limbs->front().is_table();
}

Geometry limbs_geometry(Section& root) {
  std::vector<Section> limbs = root.tables("limb");
  std::vector<Strut> struts;
  struts.reserve(limbs.size());
  for (Section& limb : limbs) struts.push_back(strut_of(std::move(limb)));
  return strut_geometry(std::move(struts));
}

std::string struts_toml(const Geometry& geometry) {
  std::string text;
  for (const auto& [base, plate, length] : geometry.struts) {
    text +=
        fmt::format("\n[[limb]]\nkind = \"strut\"\nbase_joint_mm = {}\nplate_joint_mm = {}\nlength_at_zero_mm = {}\n",
                    array(base), array(plate), length);
  }
  return text;
}

Json struts_json(const Geometry& geometry) {
  Json limbs = Json::array();
  for (const auto& [base, plate, length] : geometry.struts) {
    limbs.push_back({{"kind", "strut"},
                     {"base_joint_mm", json_array(base)},
                     {"plate_joint_mm", json_array(plate)},
                     {"length_at_zero_mm", length}});
  }
  return limbs;
}

}  // namespace paracal::io
