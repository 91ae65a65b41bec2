#include "paracal/report/page.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "paracal/calibration/plan.hpp"
#include "paracal/error.hpp"
#include "paracal/kinematics/inverse.hpp"
#include "paracal/report/error_map.hpp"
#include "paracal/report/plots.hpp"
#include "paracal/report/scene.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/units.hpp"
#include "support/robots.hpp"

namespace paracal::report::page_test {
namespace {

using io::Json;
using testing::HasSubstr, testing::Not;

constexpr const char* kTemplate = "<script id=data>PARACAL_REPORT_DATA</script>";

/// What a browser finds between the tags.
std::string data_in(const std::string& html) {
  const std::size_t start = html.find('>') + 1;
  return html.substr(start, html.find('<', start) - start);
}

TEST(ReportPage, HoldsTheDataWhateverTheyHold) {
  const Json data{{"</script><script>alert(1)</script>", "<!--<script>"}, {"quote\"\\", "PARACAL_REPORT_DATA"}};
  const std::string html = page(kTemplate, data);
  EXPECT_EQ(Json::parse(data_in(html)), data);
  EXPECT_TRUE(html.ends_with("</script>"));
  EXPECT_EQ(std::ranges::count(html, '<'), 2);
}

TEST(ReportPage, ReplacesBytesThatAreNoText) {
  EXPECT_EQ(Json::parse(data_in(page(kTemplate, {{"file", "caf\xe9.csv"}})))["file"], "caf\xef\xbf\xbd.csv");
}

TEST(ReportPage, RefusesATemplateWithoutAPlace) { EXPECT_THROW((void)page("<p></p>", {}), Error); }

class ReportFigures : public test::EveryRobot {};
PARACAL_ON_EVERY_ROBOT(ReportFigures);
PARACAL_ON_HEXAPODS(ReportFigures);

Eigen::Vector3d vector_of(const Json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

TEST_P(ReportFigures, TheSceneClosesItsLimbs) {
  const std::vector<Station> stations = workspace_stations(robot);
  const Json drawn = scene(robot, predicted_arrows(robot, {}, stations), {});
  ASSERT_EQ(drawn.at("poses").size(), stations.size());
  EXPECT_FALSE(drawn.at("measured"));
  for (std::size_t k = 0; k < stations.size(); ++k) {
    const Json& pose = drawn["poses"][k];
    const Joints joints = inverse(robot.nominal(), stations[k].commanded).joints;
    EXPECT_LT(vector_of(pose.at("before_mm")).norm(), 1e-6);
    for (const Json& turned : pose.at("tilt_rad")) EXPECT_NEAR(turned.get<double>(), 0.0, 1e-9);
    ASSERT_EQ(pose.at("limbs").size(), robot.limb_count());
    for (std::size_t i = 0; i < robot.limb_count(); ++i) {
      const Json& limb = pose["limbs"][i];
      if (limb.contains("elbow_mm")) {
        const Eigen::Vector3d arm = vector_of(limb["elbow_mm"]) - vector_of(limb.at("base_mm"));
        EXPECT_NEAR(arm.norm(), sizes_of(robot.limbs()).arm, 0.01);
      }
      const double length = ends_at(robot.nominal().limbs[i], joints(static_cast<Eigen::Index>(i))).length[0];
      for (const Json& rod : limb.at("rods_mm")) {
        EXPECT_NEAR((vector_of(rod[1]) - vector_of(rod[0])).norm(), length, 0.01);
      }
    }
  }
}

/// The normal by which a tilted plate is drawn stands upright on the joints that are drawn.
TEST(ReportScene, ATiltedPlateIsDrawnSo) {
  const Robot robot = test::robot_named(test::hexapod_names().front());
  const Pose tilted{robot.workspace().centre(), 0.0, {0.1, -0.15, 0.05}};
  const Json pose = scene(robot, predicted_arrows(robot, {}, {{"one", tilted}}), {}).at("poses")[0];
  const Eigen::Vector3d normal = vector_of(pose.at("normal")), first = vector_of(pose["limbs"][0]["rods_mm"][0][1]);
  for (const Json& limb : pose.at("limbs")) {
    EXPECT_NEAR(normal.dot(vector_of(limb["rods_mm"][0][1]) - first), 0.0, 0.05);
  }
  EXPECT_LT(normal.z(), 0.99);
  EXPECT_NEAR(vector_of(pose.at("tilt_deg")).y(), to_degrees(-0.15), 1e-5);
}

TEST_P(ReportFigures, TheMapIsWhatThePosesSayOneByOne) {
  test::Random random(5);
  const SourceErrors errors = random.realistic_errors(robot);
  KnownErrors known{errors, {{0, "theta_offset"}, {1, "e_x"}}, Eigen::MatrixXd::Zero(2, 2)};
  known.covariance << 1e-6, 2e-5, 2e-5, 1e-2;
  const Json map = error_map(robot, known);
  const std::size_t layer = 1 + map.at("radii_mm").size() * map.at("azimuths_deg").size();
  ASSERT_EQ(map.at("points").size(), layer * map.at("layers_mm").size());

  const auto machine = differentiable(robot, errors);
  const auto jacobian_at = [&](const Eigen::Vector3d& position) {
    return pose_jacobian(machine, inverse(robot.nominal(), {position, 0.0}).joints, known.parameters);
  };
  const auto reached = [&](const Eigen::Vector3d& position) {
    return predict(robot, known, inverse(robot.nominal(), {position, 0.0}).joints).pose;
  };
  const Eigen::Vector3d home = robot.workspace().centre();
  for (const std::size_t k : {layer - 3, layer + 40, map["points"].size() - 1}) {
    const Json& point = map["points"][k];
    const Eigen::Vector3d place(point.at("x_mm").get<double>(), point.at("y_mm").get<double>(),
                                point.at("z_mm").get<double>());
    const Eigen::Vector3d way = reached(place).position - reached(home).position;
    EXPECT_NEAR(point.at("distance_before_mm").get<double>(), std::abs(way.norm() - (place - home).norm()), 1e-4);
    const Eigen::RowVectorXd row = way.normalized().transpose() * (jacobian_at(place) - jacobian_at(home)).topRows<3>();
    const double expanded = 2.0 * std::sqrt((row * known.covariance * row.transpose())(0));
    EXPECT_NEAR(point.at("distance_after_mm").get<double>(), expanded, 1e-3 * expanded);
  }
  EXPECT_EQ(map["points"][0].contains("rotation_before_deg"), robot.slide().has_value());
}

TEST_P(ReportFigures, TheMapHasNoAfterWithoutACovariance) {
  const Json map = error_map(robot, {});
  for (const Json& point : map.at("points")) {
    EXPECT_LT(point.at("position_before_mm").get<double>(), 1e-6);
    EXPECT_TRUE(point.at("distance_after_mm").is_null());
  }
}

TEST_P(ReportFigures, NoPointOfTheTiltMapIsBeyondTheWorst) {
  const Tolerances tolerances = tolerances_of(robot);
  const double worst = worst_spread(robot, {Quantity::tilt}, tolerances, Spread::statistical).value;
  const Json map = three_sigma_map(robot, {Quantity::tilt}, tolerances, 1.0);
  double largest = 0.0;
  for (const Json& point : map.at("points")) largest = std::max(largest, point.at("value").get<double>());
  EXPECT_LE(largest, 1.0001 * worst);
  EXPECT_GT(largest, (robot.workspace().max_tilt > 0.0 ? 0.75 : 0.95) * worst);  // the map is level
}

TEST(ReportHistogram, CountsEveryValueInItsBin) {
  Histogram values;
  for (int k = 1; k <= 1000; ++k) values.add(1e-3 * k);
  const Json bins = histogram(values, 1000.0);
  const double width = bins.at("bin_width");
  EXPECT_EQ(bins.at("total"), 1000);
  double sum = 0.0, mean = 0.0;
  for (std::size_t k = 0; k < bins.at("counts").size(); ++k) {
    const double count = bins["counts"][k];
    sum += count;
    mean += count * width * (static_cast<double>(k) + 0.5) / 1000.0;
    EXPECT_NEAR(count, 1000.0 / 40.0, 4.0) << k;
  }
  EXPECT_EQ(sum, 1000.0);
  EXPECT_NEAR(mean, 500.5, 3.0);
  EXPECT_EQ(histogram(Histogram(), 1.0).at("total"), 0);
}

}  // namespace
}  // namespace paracal::report::page_test
