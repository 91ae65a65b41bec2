#include "observation.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <cmath>

namespace paracal::detail {
namespace {

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

}  // namespace

Observation::ByPlate Observation::setup_rows(const Group& group, const std::vector<StationState>& stations,
                                             const Eigen::VectorXd& unknowns, Eigen::MatrixXd& block) const {
  switch (group.kind) {
    case ReadingKind::point:
      return point_rows(group, stations[group.station], unknowns, block);
    case ReadingKind::distance:
      return distance_rows(group, stations, unknowns, block);
    case ReadingKind::height:
      break;
  }
  return height_rows(group, stations[group.station], unknowns, block);
}

void Observation::rows(const Group& group, const std::vector<StationState>& stations, const Eigen::VectorXd& unknowns,
                       Eigen::MatrixXd& block, Eigen::MatrixXd* by_joint) const {
  ByPlate by_plate = setup_rows(group, stations, unknowns, block);
  const double factor =
      std::sqrt(group.weight) / (group.stated ? components_.stated_noise : components_.unstated_noise);
  if (factor != 1.0) {
    block *= factor;
    by_plate *= factor;
  }
  const StationState& station = stations[group.station];
  auto sources = block.middleCols(nuisance_count_, source_count());
  sources.noalias() = by_plate * station.jacobian;
  if (group.is_distance()) {
    sources.noalias() -= by_plate * stations[distance(group).from].jacobian;
    if (components_.joint > 0.0) {
      block = widening(distance(group), stations, by_plate).cwiseSqrt().cwiseInverse().asDiagonal() * block;
    }
  }
  if (by_joint != nullptr) by_joint->noalias() = by_plate * station.by_joint;
}

/// Distances that share a station share how far its joints are off; here each has its own.
Eigen::VectorXd Observation::widening(const DistanceReading& reading, const std::vector<StationState>& stations,
                                      const ByPlate& by_plate) const {
  const double variance = components_.joint * components_.joint;
  return Eigen::VectorXd::Ones(by_plate.rows()) +
         variance * ((by_plate * stations[reading.to].by_joint).rowwise().squaredNorm() +
                     (by_plate * stations[reading.from].by_joint).rowwise().squaredNorm());
}

Observation::ByPlate Observation::distance_rows(const Group& group, const std::vector<StationState>& stations,
                                                const Eigen::VectorXd& unknowns, Eigen::MatrixXd& block) const {
  const DistanceReading& reading = distance(group);
  const StationState &from = stations[reading.from], &to = stations[reading.to];
  const Eigen::Vector3d between = to.plate.position - from.plate.position;
  const double sigma = sigma_of(reading), scale = distance_scale(unknowns);
  // A derivative kept at the nominal machine needs the direction there, too: otherwise turns of the whole robot, which
  // no distance sees, become weakly visible, and an undamped step along them is wild.
  const Eigen::Vector3d direction =
      nominal_.empty() ? between : nominal_[reading.to].plate.position - nominal_[reading.from].plate.position;
  const Eigen::Index residual = unknown_count();
  block.setZero(reading.rotation ? 2 : 1, residual + 1);
  ByPlate by_plate = ByPlate::Zero(block.rows(), 7);
  by_plate.block<1, 3>(0, 0) = scale * direction.normalized().transpose() / sigma;
  if (bias_ >= 0) block(0, bias_) = 1.0 / sigma;
  if (distance_scale_ >= 0) block(0, distance_scale_) = between.norm() / sigma;
  block(0, residual) = distance_residual(group, stations, unknowns) / sigma;
  if (!reading.rotation) return by_plate;
  by_plate(1, 3) = 1.0 / options_.noise.rotation;
  block(1, residual) = (to.rotation - from.rotation - *reading.rotation) / options_.noise.rotation;
  return by_plate;
}

Observation::ByPlate Observation::height_rows(const Group& group, const StationState& station,
                                              const Eigen::VectorXd& unknowns, Eigen::MatrixXd& block) const {
  const Eigen::Vector3d& r = station.plate.position;
  const Eigen::Vector3d of_plane = plane(group.series, unknowns);
  const double sigma = sigma_of(group);
  block.setZero(1, unknown_count() + 1);
  block.block<1, 3>(0, planes_[group.series]) << -1.0, -r.x(), -r.y();
  block(0, unknown_count()) = height_residual(group, station, unknowns);
  block /= sigma;
  ByPlate by_plate = ByPlate::Zero(1, 7);
  by_plate.leftCols<3>() = Eigen::RowVector3d(-of_plane(1), -of_plane(2), 1.0) / sigma;
  return by_plate;
}

Eigen::Vector3d Observation::plane(std::size_t series, const Eigen::VectorXd& unknowns) const {
  return unknowns.segment<3>(planes_[series]);
}

double Observation::height_residual(const Group& group, const StationState& station,
                                    const Eigen::VectorXd& unknowns) const {
  const Eigen::Vector3d& r = station.plate.position;
  return r.z() - plane(group.series, unknowns).dot(Eigen::Vector3d(1.0, r.x(), r.y())) - height(group).height;
}

std::optional<double> Observation::distance_bias(const Eigen::VectorXd& unknowns) const {
  return bias_ < 0 ? std::nullopt : std::optional(unknowns(bias_));
}

double Observation::distance_residual(const Group& group, const std::vector<StationState>& stations,
                                      const Eigen::VectorXd& unknowns) const {
  const DistanceReading& reading = distance(group);
  const double length = (stations[reading.to].plate.position - stations[reading.from].plate.position).norm();
  return distance_scale(unknowns) * length + distance_bias(unknowns).value_or(0.0) - reading.distance;
}

double Observation::series_scale(std::size_t series, const Eigen::VectorXd& unknowns) const {
  const Eigen::Index at = nuisance_[series].scale;
  return at < 0 ? 1.0 : 1.0 + unknowns(at);
}

double Observation::distance_scale(const Eigen::VectorXd& unknowns) const {
  return distance_scale_ < 0 ? 1.0 : 1.0 + unknowns(distance_scale_);
}

Eigen::Matrix3d Observation::whitening_of(const PointReading& reading, const Eigen::Vector3d& point) const {
  if (reading.sigma) return Eigen::Matrix3d::Identity() / *reading.sigma;
  if (options_.noise.tracker) return whitening(*options_.noise.tracker, point);
  return Eigen::Matrix3d::Identity() / options_.noise.point;
}

Observation::ByPlate Observation::point_rows(const Group& group, const StationState& station,
                                             const Eigen::VectorXd& unknowns, Eigen::MatrixXd& block) const {
  const PointReading& reading = point(group);
  const Nuisance& nuisance = nuisance_[group.series];
  const RigidMotion motion = frame(group.series, unknowns);
  const double scale = series_scale(group.series, unknowns);
  const Eigen::Index residual = unknown_count();
  block.setZero(3 + (reading.second ? 3 : 0) + (reading.rotation ? 1 : 0), residual + 1);
  ByPlate by_plate = ByPlate::Zero(block.rows(), 7);
  // One reflector: t + scale Q x, where x stands in the robot's frame.
  const auto reflector = [&](Eigen::Index row, const Eigen::Vector3d& x, const Eigen::Vector3d& read) {
    const Eigen::Matrix3d whiten = whitening_of(reading, read);
    const Eigen::Vector3d turned = motion.rotation * x;
    by_plate.block<3, 3>(row, 0) = scale * whiten * motion.rotation;
    block.block<3, 1>(row, residual) = whiten * (scale * turned + motion.translation - read);
    if (nuisance.scale >= 0) block.block<3, 1>(row, nuisance.scale) = whiten * turned;
    if (nuisance.frame < 0) return;
    // exp([w + dw]) v = exp([w]) v - [exp([w]) v] J_l(w) dw,  J_l = I + [w] / 2 to first order
    const Eigen::Matrix3d left =
        Eigen::Matrix3d::Identity() + 0.5 * cross(Eigen::Vector3d(unknowns.segment<3>(nuisance.frame)));
    block.block<3, 3>(row, nuisance.frame) = -scale * whiten * cross(turned) * left;
    block.block<3, 3>(row, nuisance.frame + 3) = whiten;
  };
  const Eigen::Vector3d& r = station.plate.position;
  reflector(0, r, reading.point);
  if (reading.second) {
    const Eigen::Matrix3d carried = carrier(station, options_.reflectors);
    const Eigen::Vector3d lever = carried * unknowns.segment<3>(nuisance.second);
    reflector(3, r + lever, *reading.second);
    const PlateRotation<double> plate = plate_rotation(station.plate.tilt);
    const Eigen::Matrix3d moves = by_plate.block<3, 3>(3, 0);
    by_plate.block<3, 3>(3, 4) = -moves * cross(lever) * plate.axes;
    by_plate.block<3, 1>(3, 3) = turns_per_phi(options_.reflectors) * (moves * plate.matrix.col(2).cross(lever));
    block.block<3, 3>(3, nuisance.second) = moves * carried;
  }
  if (!reading.rotation) return by_plate;
  const Eigen::Index row = block.rows() - 1;
  const double sigma = options_.noise.rotation;
  by_plate(row, 3) = 1.0 / sigma;
  if (nuisance.zero >= 0) block(row, nuisance.zero) = -1.0 / sigma;
  block(row, residual) =
      (station.rotation - rotation_zero(group.series, unknowns).value_or(0.0) - *reading.rotation) / sigma;
  return by_plate;
}

std::optional<double> Observation::rotation_zero(std::size_t series, const Eigen::VectorXd& unknowns) const {
  const Eigen::Index zero = nuisance_[series].zero;
  return zero < 0 ? std::nullopt : std::optional(unknowns(zero));
}

std::optional<Eigen::Vector3d> Observation::second_reflector(std::size_t series,
                                                             const Eigen::VectorXd& unknowns) const {
  const Eigen::Index second = nuisance_[series].second;
  if (second < 0) return std::nullopt;
  return Eigen::Vector3d(unknowns.segment<3>(second));
}

Eigen::Vector3d Observation::point_residual(const Group& group, const StationState& station,
                                            const Eigen::VectorXd& unknowns) const {
  const RigidMotion motion = frame(group.series, unknowns);
  return station.plate.position - motion.inverse()(point(group).point) / series_scale(group.series, unknowns);
}

std::optional<double> Observation::rotation_residual(const Group& group, const std::vector<StationState>& stations,
                                                     const Eigen::VectorXd& unknowns) const {
  if (group.is_height()) return std::nullopt;
  if (group.is_distance()) {
    const DistanceReading& reading = distance(group);
    if (!reading.rotation) return std::nullopt;
    return stations[reading.to].rotation - stations[reading.from].rotation - *reading.rotation;
  }
  const PointReading& reading = point(group);
  if (!reading.rotation) return std::nullopt;
  return stations[group.station].rotation - rotation_zero(group.series, unknowns).value_or(0.0) - *reading.rotation;
}

}  // namespace paracal::detail
