#pragma once

#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/io/published.hpp"

namespace paracal::report {

/// One published number beside ours.
struct ReproductionRow {
  std::string id;        ///< stable name for scripts, e.g. "table3.before.P1.d_rho"
  std::string quantity;  ///< in words
  std::string unit;      ///< deg, mm, points, or 1
  double paper = 0.0;
  double ours = 0.0;
  double tolerance = 0.0;  ///< largest |ours - paper| that we call reproduced; docs/paper-slips.md says why this much

  bool ok() const;
};

struct Reproduction {
  Calibration calibration;  ///< rough calibration from the published distances alone
  std::vector<ReproductionRow> rows;

  bool ok() const;
};

/// What can be computed again of [huang2016] from its own numbers: the encoder offsets from the six distances of Table
/// 3, Table 3 from the four published offsets, the numbers of points of Figures 7 and 8, Table 5 'before' from Table 4,
/// and Table 4, Table 5 'after' and Figure 9 on virtual twins of the machine (Table 4's errors, Table 2's tilt errors)
/// calibrated as the paper does.
Reproduction reproduce_huang2016(const io::PublishedHuang2016& published);

}  // namespace paracal::report
