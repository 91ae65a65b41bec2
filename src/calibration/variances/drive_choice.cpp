#include "drive_choice.hpp"

#include <cmath>
#include <map>
#include <vector>

#include "numerics/dense.hpp"

namespace paracal::detail {
namespace {

/// Rows of the readings of each pose; a reading from one pose to another is of the latter.
std::map<std::size_t, std::vector<Eigen::Index>> rows_of_poses(const LinearReadings& readings) {
  std::map<std::size_t, std::vector<Eigen::Index>> rows;
  for (std::size_t k = 0; k < readings.blocks.size(); ++k) {
    const ReadingBlock& one = readings.blocks[k];
    for (Eigen::Index row = 0; row < one.by_joint.rows(); ++row) {
      rows[one.station].push_back(readings.first[k] + row);
    }
  }
  return rows;
}

/// |e_k|^2 of each pose, over the noise with which readings entered; empty where a pose cannot be omitted.
std::optional<Eigen::VectorXd> squares_of_omitted(const VarianceTable::At& at,
                                                  const std::map<std::size_t, std::vector<Eigen::Index>>& rows) {
  constexpr double kNothing = 1e-9;  // of a row's own information: without it the pose is needed for the set-up
  if (!std::isfinite(at.cost)) return std::nullopt;
  Eigen::VectorXd squares(std::ssize(rows));
  Eigen::Index next = 0;
  for (const auto& [pose, places] : rows) {
    const Eigen::MatrixXd P = at.P(places, places);
    const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(P);
    if (eigenvalues.minCoeff() <= kNothing * eigenvalues.maxCoeff()) return std::nullopt;
    squares(next++) = cholesky_solution(P, at.z(places)).squaredNorm();
  }
  return squares;
}

/// The mean over the poses is above zero by more than it scatters.
bool stands_out(const Eigen::VectorXd& gains) {
  constexpr double kStandardErrors = 1.5;  // one in 15 by chance; more loses what small errors of drives gain
  const auto count = static_cast<double>(gains.size());
  const double mean = gains.mean(), squares = (gains.array() - mean).square().sum();
  return mean > kStandardErrors * std::sqrt(squares / ((count - 1.0) * count));
}

/// What cannot be seen beside the noise predicts nothing better.
bool is_hidden(const VarianceTable& table, const Eigen::VectorXd& u) {
  constexpr double kHidden = 0.05;  // of the squares of the noise
  const double noise = table.squares(u, {Spreads::noise, Spreads::stated_noise, Spreads::orientation_noise});
  return table.squares(u, {Spreads::drives}) < kHidden * noise;
}

}  // namespace

std::optional<OmittedPoses> omitted_poses(const VarianceTable& table, const VarianceTable::Mode& mode,
                                          double noise_mm) {
  constexpr std::size_t kFewest = 8;
  const auto rows = rows_of_poses(table.readings());
  if (rows.size() < kFewest || is_hidden(table, mode.u)) return std::nullopt;
  const auto with_drives = squares_of_omitted(table.at(mode.u, false), rows);
  const VarianceTable::Mode rigid = table.mode_without({Spreads::visits, Spreads::poses, Spreads::drives}, mode.u);
  const auto without = squares_of_omitted(table.at(rigid.u, false), rows);
  if (!with_drives || !without || !stands_out(*without - *with_drives)) return std::nullopt;
  const auto count = static_cast<double>(table.readings().y.size());
  return OmittedPoses{noise_mm * std::sqrt(without->sum() / count), noise_mm * std::sqrt(with_drives->sum() / count),
                      rows.size()};
}

}  // namespace paracal::detail
