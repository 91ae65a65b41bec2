#pragma once

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run_program.hpp"

namespace paracal::test {

/// The JSON object that a run printed; fails where there is anything else on standard output or a message.
nlohmann::json json_of(const ProgramResult& result, int exit_code = kDone);

/// What a page's program reads: the text of a file that --report left.
nlohmann::json data_in(const std::string& html);

testing::AssertionResult has_keys(const nlohmann::json& object, std::string_view keys);

/// A matrix in JSON: rows x columns finite numbers.
testing::AssertionResult is_matrix(const nlohmann::json& matrix, std::size_t rows, std::size_t columns);

}  // namespace paracal::test
