// Workspaces of every shape: what other code asks of them, their files, and the poses that are taken from them.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "paracal/calibration/plan.hpp"
#include "paracal/calibration/pose_selection.hpp"
#include "paracal/error.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/tolerance/requirement.hpp"
#include "paracal/tolerance/sensitivity.hpp"
#include "paracal/tolerance/workspace_samples.hpp"
#include "support/robots.hpp"

namespace paracal::workspace_test {
namespace {

using testing::HasSubstr;

constexpr double kTurn = 2.0 * std::numbers::pi, kExact = 1e-9;

class WorkspaceLaw : public test::EveryRobot {
 protected:
  const Workspace& workspace = robot.workspace();
};

TEST_P(WorkspaceLaw, ItsPlacesAreInsideAndTellTheirShares) {
  test::Random random(1);
  for (int k = 0; k < 2000; ++k) {
    const double azimuth = random.uniform(-0.5 * kTurn, 0.5 * kTurn), share = random.uniform(0.01, 1.0);
    const double depth = random.uniform(0.0, 1.0);
    const Eigen::Vector3d place = workspace.at(share, azimuth, depth), shares = workspace.shares_of(place);
    EXPECT_TRUE(workspace.contains(place, kExact)) << place.transpose();
    EXPECT_TRUE(workspace.bounds().contains(place)) << place.transpose();
    EXPECT_LE(place.norm(), workspace.farthest() + kExact);
    EXPECT_NEAR(shares[0], share, kExact);
    EXPECT_NEAR(std::remainder(shares[1] - azimuth, kTurn), 0.0, kExact);
    EXPECT_NEAR(shares[2], depth, kExact);
    EXPECT_FALSE(workspace.contains(workspace.at(1.001, azimuth, depth), 0.0)) << place.transpose();
  }
  EXPECT_EQ(workspace.at(0.0, 0.0, 0.5), workspace.centre());
  EXPECT_FALSE(workspace.contains(workspace.at(0.5, 0.0, -0.001), 0.0));
  EXPECT_FALSE(workspace.contains(workspace.at(0.5, 0.0, 1.001), 0.0));
}

/// In thin layers the square of the share and the azimuth spread evenly: mean and mean square of both coordinates.
TEST_P(WorkspaceLaw, SharesSpreadEvenlyOverALayer) {
  constexpr int kAcross = 200;
  const Eigen::Vector2d half(workspace.half_width(0), workspace.half_width(1));
  Eigen::Vector2d mean = Eigen::Vector2d::Zero(), square = mean;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const Eigen::Vector3d place =
          workspace.at(std::sqrt((i + 0.5) / kAcross), kTurn * (j + 0.5) / kAcross, 0.5) - workspace.centre();
      mean += place.head<2>().cwiseQuotient(half) / (kAcross * kAcross);
      square += place.head<2>().cwiseQuotient(half).cwiseAbs2() / (kAcross * kAcross);
    }
  }
  const double even = workspace.box ? 1.0 / 3.0 : 0.25;
  EXPECT_LT(mean.norm(), 1e-6);
  for (const double one : square) EXPECT_NEAR(one, even, 1e-3);
}

TEST_P(WorkspaceLaw, PlannedPosesStayInsideAndReachTheEdges) {
  const auto inside = [&](const std::vector<Station>& stations, double slack) {
    for (const Station& one : stations) EXPECT_TRUE(workspace.contains(one.commanded.position, slack)) << one.name;
  };
  constexpr double kRounded = 1e-6;
  inside(rough_stations(robot, 8), kRounded);
  inside(fine_stations(robot, 9), kRounded);
  inside(workspace_stations(robot), kRounded);
  inside(candidate_stations(robot, 500, 1), kExact);
  double outermost = 0.0;
  for (const Pose& pose : surface_poses(robot)) {
    EXPECT_TRUE(workspace.contains(pose.position, kRounded));
    outermost = std::max(outermost, workspace.shares_of(pose.position)[0]);
  }
  EXPECT_NEAR(outermost, 1.0, kExact);
  const Eigen::AlignedBox3d bounds = workspace.bounds();
  Eigen::AlignedBox3d reached;
  for (const Pose& pose : workspace.rim(8)) reached.extend(pose.position);
  EXPECT_TRUE(reached.isApprox(bounds, kExact)) << reached.min().transpose() << " to " << reached.max().transpose();
}

/// Against the midpoints of a fine Cartesian grid, which knows the shape by contains() alone.
TEST_P(WorkspaceLaw, MeansOverTheVolumeAgreeWithAGrid) {
  const auto what = [](const Eigen::Vector3d& p) {
    return Eigen::Vector4d(p.x() / 100.0, p.y() / 100.0, p.z() / 100.0, std::hypot(p.x(), p.y() - p.z()) / 100.0);
  };
  Eigen::Vector4d mean = Eigen::Vector4d::Zero(), sum = mean;
  double weights = 0.0;
  for (const auto& [pose, weight] : volume_rule(robot, 1, false)) {
    mean += weight * what(pose.position);
    weights += weight;
  }
  constexpr int kAcross = 120;
  int count = 0;
  const Eigen::AlignedBox3d bounds = workspace.bounds();
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      for (int k = 0; k < kAcross; ++k) {
        const Eigen::Vector3d shares = (Eigen::Vector3d(i, j, k).array() + 0.5) / kAcross;
        const Eigen::Vector3d place = bounds.min() + shares.cwiseProduct(bounds.sizes());
        if (!workspace.contains(place, 0.0)) continue;
        sum += what(place);
        ++count;
      }
    }
  }
  EXPECT_NEAR(weights, 1.0, 1e-12);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(mean[k], sum[k] / count, 2e-3) << k;
}

INSTANTIATE_TEST_SUITE_P(Shapes, WorkspaceLaw, ::testing::Values(std::string_view("rotary_delta"), "boxed", "levelled"),
                         test::robot_name);

/// Exact for polynomials, over each part of the wall.
TEST(BoxWorkspace, MomentsAreThoseOfABox) {
  const Robot robot = test::robot_named("boxed");
  const auto& [x, y, z] = *robot.workspace().box;
  const auto second = [](const std::array<double, 2>& of) {
    return (of[0] * of[0] + of[0] * of[1] + of[1] * of[1]) / 3.0;
  };
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  double product = 0.0;
  for (const auto& [pose, weight] : volume_rule(robot, 0, false)) {
    squares += weight * pose.position.cwiseAbs2();
    product += weight * pose.position.x() * pose.position.y();
  }
  EXPECT_NEAR(squares.x(), second(x), 1e-6);
  EXPECT_NEAR(squares.y(), second(y), 1e-6);
  EXPECT_NEAR(squares.z(), second(z), 1e-6);
  EXPECT_NEAR(product, 0.25 * (x[0] + x[1]) * (y[0] + y[1]), 1e-6);
}

TEST(BoxWorkspace, CartesianGridFillsIt) { EXPECT_EQ(cartesian_grid(test::robot_named("boxed"), 5, 3).size(), 75U); }

/// No pose of a dense grid of the box is worse, and the search ends on its wall.
TEST(BoxWorkspace, TheWorstPoseIsFound) {
  const Robot robot = test::robot_named("boxed");
  const ValueAtPose worst = worst_spread(robot, {Quantity::tilt}, tolerances_of(robot), Spread::statistical);
  const LinearModel model(robot);
  const auto& [x, y, z] = *robot.workspace().box;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      for (int k = 0; k <= 4; ++k) {
        const Pose pose{
            {std::lerp(x[0], x[1], i / 20.0), std::lerp(y[0], y[1], j / 20.0), std::lerp(z[0], z[1], k / 4.0)}};
        EXPECT_LE(spread_at(robot, model.rows(pose, {Quantity::tilt}), tolerances_of(robot), Spread::statistical),
                  worst.value * (1.0 + 1e-4));
      }
    }
  }
}

std::string with_workspace(const std::string& lines) {
  std::string text = io::robot_toml(catalogue::rotary_delta());
  const std::size_t from = text.find("radius_mm", text.find("[workspace]")), end = text.find("rotation_deg", from);
  return text.replace(from, end - from, lines);
}

const std::string kBox = "x_mm = [-100.1, 200.7]\ny_mm = [-50, 250]\nz_mm = [-1000.3, -800.1]\n";
const std::string kLevels = "heights_mm = [-800.1, -900, -1000.3]\nradii_mm = [300.7, 450, 100]\n";

TEST(WorkspaceFile, EachShapeIsWrittenAsItWasRead) {
  for (const std::string& shape : {kBox, kLevels}) {
    const Robot robot = io::read_robot({"r.toml", with_workspace(shape)});
    const std::string again = io::robot_toml(robot);
    EXPECT_THAT(again, HasSubstr("[workspace]\n" + shape));
    EXPECT_EQ(io::robot_toml(io::read_robot({"r.toml", again})), again);
    EXPECT_EQ(io::to_json(robot).at("workspace").contains("radius_mm"), false);
  }
  const Workspace box = io::read_robot({"r.toml", with_workspace(kBox)}).workspace();
  EXPECT_TRUE(box.centre().isApprox(Eigen::Vector3d(50.3, 100.0, -900.2), 1e-12)) << box.centre().transpose();
}

TEST(WorkspaceFile, NonsenseIsRefused) {
  const auto refused = [](const std::string& lines, const std::string& complaint) {
    EXPECT_THAT(
        [&] {
          io::read_robot({"r.toml", with_workspace(lines)});
        },
        testing::ThrowsMessage<InputFileError>(HasSubstr(complaint)))
        << lines;
  };
  const std::string z = "z_mm = [-1000, -800]\n", xz = "x_mm = [-100, 100]\n" + z;
  refused(kBox + "radius_mm = 3\n", "got workspace.radius_mm and workspace.x_mm; remove one");
  refused(kLevels + "z_mm = [-900, -800]\n", "got workspace.z_mm and workspace.heights_mm; remove one");
  refused("y_mm = [-1, 1]\n" + z, "workspace.x_mm");
  refused(xz, "workspace.y_mm");
  refused(xz + "y_mm = [1, 2, 3]\n", "r.toml:15: expected [smallest, largest] for workspace.y_mm, got 3 numbers");
  refused(xz + "y_mm = [50, 50]\n", "workspace.y_mm: expected [smallest, largest], got [50, 50] mm");
  refused(xz + "y_mm = [50, -50]\n", "workspace.y_mm: expected [smallest, largest], got [50, -50] mm");
  refused("x_mm = [0, 1]\ny_mm = [0, 1]\nz_mm = [-800, -900]\n", "workspace.z_mm: expected [smallest, largest]");
  refused("x_mm = [0, 9]\ny_mm = [0, 9]\nz_mm = [-800, -800]\n", "workspace.z_mm: expected a length above 0 mm");
  refused("x_mm = [0, 9]\ny_mm = [0, 9]\nz_mm = [-800, 5]\n",
          "r.toml:15: workspace.z_mm: expected a depth below the base");
  refused("heights_mm = [-900, -800]\nradii_mm = [9, 9]\n",
          "workspace.heights_mm: expected heights from the top down, got -800 after -900");
  refused("heights_mm = [-800, -900]\nradii_mm = [9]\n", "workspace.radii_mm");
  refused("heights_mm = [-800, -900]\nradii_mm = [9, 0]\n",
          "workspace.radii_mm: expected a length above 0 mm, got 0 mm");
  refused("heights_mm = [-800]\nradii_mm = [9]\n", "r.toml:13: expected at least 2 numbers for workspace.heights_mm");
  refused("heights_mm = []\nradii_mm = []\n", "expected at least 2 numbers for workspace.heights_mm");
}

/// A box that grows along x until its first place is out of reach: a corner.
TEST(WorkspaceFile, CornerOutOfReachIsNamed) {
  std::string complaint;
  int x = 100;
  for (; complaint.empty() && x < 600; x += 5) {
    const std::string box = fmt::format("x_mm = [-100, {}]\ny_mm = [-100, 600]\nz_mm = [-1050, -800]\n", x);
    try {
      io::read_robot({"r.toml", with_workspace(box)});
    } catch (const InputFileError& error) {
      complaint = error.what();
    }
  }
  EXPECT_THAT(complaint, HasSubstr(fmt::format("cannot reach ({}, 600, -1050) mm", x - 5)));
  EXPECT_GT(x, 105);
}

TEST(WorkspaceFile, PlatesInAPlaneMayHaveARectangle) {
  std::string text(io::robot_template("five-bar").text);
  const std::size_t from = text.find("radius_mm", text.find("[workspace]")), end = text.find('\n', from);
  const Workspace disk = test::robot_named("five-bar").workspace();
  const double half = 0.5 * disk.radius;
  text.replace(from, end - from, fmt::format("x_mm = [{}, {}]\ny_mm = [{}, {}]", -half, half, -half, 0.5 * half));
  const Robot robot = io::read_robot({"r.toml", text});
  EXPECT_TRUE(robot.workspace().is_flat());
  EXPECT_EQ(robot.workspace().centre(), Eigen::Vector3d(0.0, -0.25 * half, 0.0));
  for (const Station& one : candidate_stations(robot, 100, 1)) EXPECT_EQ(one.commanded.position.z(), 0.0);
}

}  // namespace
}  // namespace paracal::workspace_test
