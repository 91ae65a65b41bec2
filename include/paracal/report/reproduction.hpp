#pragma once

#include <string>
#include <vector>

#include "paracal/calibration/calibration.hpp"
#include "paracal/io/published.hpp"

namespace paracal::report {

/// One published number beside ours. Unit: deg or mm.
struct ReproductionRow {
  std::string id;        ///< stable name for scripts, e.g. "table3.before.P1.d_rho"
  std::string quantity;  ///< in words
  std::string unit;
  double paper = 0.0;
  double ours = 0.0;
  double tolerance = 0.0;  ///< largest |ours - paper| that we call reproduced; docs/validation.md says why this much

  bool ok() const;
};

struct Reproduction {
  Calibration calibration;  ///< rough calibration from the published distances alone
  std::vector<ReproductionRow> rows;

  bool ok() const;
};

/// What can be computed again of [huang2016] from its own numbers: the encoder offsets from the six distances of Table
/// 3, and the whole of Table 3 'before' from the four published offsets.
Reproduction reproduce_huang2016(const io::PublishedHuang2016& published);

}  // namespace paracal::report
