#include "paracal/error.hpp"

#include <fmt/format.h>

namespace paracal {

InputFileError::InputFileError(const std::string& file, int line, const std::string& complaint)
    : Error(line > 0 ? fmt::format("{}:{}: {}", file, line, complaint) : fmt::format("{}: {}", file, complaint)) {}

}  // namespace paracal
