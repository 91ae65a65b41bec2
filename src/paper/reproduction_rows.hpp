#pragma once

// Private to report: the rows of a reproduction, table by table.

#include <string>
#include <utility>
#include <vector>

#include "reproduction.hpp"

namespace paracal::report::detail {

using Rows = std::vector<ReproductionRow>;

/// One table of the paper. `cause` is what we know of why its numbers may not come out, and stays with those that
/// do not.
class Table {
 public:
  Table(Rows& rows, std::string name, std::string cause = {})
      : rows_(rows), name_(std::move(name)), cause_(std::move(cause)) {}

  void add(std::string id, std::string quantity, std::string unit, double paper, double ours, Judgement judgement) {
    rows_.push_back(
        {std::move(id), name_, std::move(quantity), std::move(unit), paper, ours, std::move(judgement), {}});
    if (rows_.back().judgement.finding == Finding::not_reproduced) rows_.back().cause = cause_;
  }
  /// @param allowed  what print and readings allow.
  void add(std::string id, std::string quantity, std::string unit, double paper, double ours, double allowed) {
    add(std::move(id), std::move(quantity), std::move(unit), paper, ours, judge(paper, ours, allowed));
  }

 private:
  Rows& rows_;
  std::string name_, cause_;
};

/// Tables 4 and 5, Figure 9 and the tilt of Figure 6 beside virtual twins of the published machine.
void add_twins(const Robot& robot, const io::PublishedHuang2016& published, unsigned threads, Rows& rows);

}  // namespace paracal::report::detail
