#pragma once

// Private to calibration and program: parameters in words, a row a limb.

#include <string>
#include <vector>

namespace paracal::detail {

struct ParameterCell {
  std::string row, column, text;
};

/// Rows and columns in the order in which they first come. Where there is no cell, "fixed". A table wider than 120
/// characters is broken into blocks of columns.
std::string parameter_table(const std::vector<ParameterCell>& cells);

/// "limb 1": the row of a limb, which counts from 0.
std::string limb_row(std::size_t limb);

/// Two digits, and whole numbers of many: "0.017", "301".
std::string two_digits(double value);

/// Decimals that show two digits of an uncertainty.
int decimals_of(double uncertainty);

}  // namespace paracal::detail
