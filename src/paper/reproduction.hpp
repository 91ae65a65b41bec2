#pragma once

#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "published.hpp"
#include "reproduction_rule.hpp"

namespace paracal::report {

/// One published number and ours.
struct ReproductionRow {
  std::string id;        ///< stable name for scripts, e.g. "table3.before.P1.d_rho"
  std::string table;     ///< of the paper, in words: rows of one table stand together
  std::string quantity;  ///< in words
  std::string unit;      ///< deg, mm, points, or 1
  double paper = 0.0;
  double ours = 0.0;
  Judgement judgement = {};
  std::string cause = {};  ///< why numbers are not reproduced, if known; the same for a whole table

  bool ok() const { return judgement.finding == Finding::reproduced; }
};

struct Reproduction {
  Calibration calibration;  ///< rough calibration from the published distances alone
  std::vector<ReproductionRow> rows;

  std::size_t count(Finding finding) const;
};

/// Results of [huang2016] that can be computed from its own numbers: encoder offsets from the six distances of Table
/// 3; Table 3 from the published offsets; Table 2; the numbers of points of Figures 7 and 8. Twins (simulated machines
/// with the errors of Table 4 and the tilt errors of Table 2) give the tilt, Figures 6 and 9, and Tables 4 and 5 with
/// the paper's calibration. The rule is in reproduction_rule.hpp.
/// @param threads  0: all; the numbers are the same.
Reproduction reproduce_huang2016(const io::PublishedHuang2016& published, unsigned threads = 0);

}  // namespace paracal::report
