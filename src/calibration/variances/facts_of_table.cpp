// What single facts that are otherwise than stated add to a table of variances.

#include <cmath>
#include <numeric>

#include "variance_table.hpp"

namespace paracal::detail {
namespace {

VarianceTerm of_pose(const LinearReadings& readings, std::size_t pose, double size) {
  VarianceTerm term{Spreads::noise, -1, Eigen::VectorXd::Zero(readings.y.size())};
  for (std::size_t k = 0; k < readings.blocks.size(); ++k) {
    const ReadingBlock& one = readings.blocks[k];
    if (one.station != pose && one.from != pose) continue;
    term.diagonal.segment(readings.first[k], one.by_joint.rows()).setConstant(size * size);
  }
  return term;
}

VarianceTerm of_effect(const Eigen::MatrixXd& effect, double size) {
  VarianceTerm term{Spreads::noise};
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(effect.rows()));
  std::iota(rows.begin(), rows.end(), Eigen::Index{0});
  for (const auto& column : effect.colwise()) term.columns.add(rows, size * column);
  return term;
}

}  // namespace

void VarianceTable::add_effect(const Eigen::MatrixXd& effect, double size) {
  fixed_.push_back(of_effect(effect, size));
}

void VarianceTable::take_scatter(const std::vector<Eigen::MatrixXd>& of_blocks) {
  std::size_t next = 0;
  for (std::size_t k = 0; k < readings_->blocks.size(); ++k) {
    if (readings_->blocks[k].visits >= 2.0) visits_[next++].squares = of_blocks[k];
  }
}

VarianceTable VarianceTable::with(const std::vector<const Fact*>& facts) const {
  VarianceTable other = *this;
  for (const Fact* fact : facts) {
    if (fact->pose) {
      other.fixed_.push_back(of_pose(*readings_, *fact->pose, fact->size));
    } else if (fact->mount) {
      other.fixed_.push_back(of_effect(fact->effect, fact->size));
    } else if (fact->series) {
      other.add_series_noise(*fact->series, fact->size);
    } else {
      const std::vector<Eigen::Index> places(fact->errors.begin(), fact->errors.end());
      const Eigen::VectorXd more =
          (fact->size * fact->size - 1.0) * Eigen::MatrixXd(readings_->prior(places, places)).diagonal();
      other.fixed_.push_back(term_of_errors(Spreads::positions, places, more.asDiagonal()));
    }
  }
  return other;
}

void VarianceTable::add_series_noise(std::size_t series, double size) {
  series_size_ = size;
  VarianceTerm term{Spreads::series_noise, static_cast<Eigen::Index>(series),
                    Eigen::VectorXd::Zero(readings_->y.size())};
  for (std::size_t k = 0; k < readings_->blocks.size(); ++k) {
    const ReadingBlock& one = readings_->blocks[k];
    if (one.series == series && one.stated) {
      term.diagonal.segment(readings_->first[k], one.by_joint.rows()).setConstant(1.0 / one.visits);
    }
  }
  for (Visits& one : visits_) {
    for (Eigen::Index row = 0; one.series == series && row < one.squares.rows(); ++row) {
      one.joints.emplace_back(terms_.size(), Eigen::VectorXd::Unit(one.squares.rows(), row));
    }
  }
  terms_.push_back(std::move(term));
}

}  // namespace paracal::detail
