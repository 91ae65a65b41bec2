#include "json_checks.hpp"

namespace paracal::test {

using nlohmann::json;

json json_of(const ProgramResult& result, int exit_code) {
  EXPECT_EQ(result.exit_code, exit_code);
  EXPECT_THAT(result.err, testing::IsEmpty());
  json object = json::parse(result.out, nullptr, false);
  EXPECT_TRUE(object.is_object()) << result.out;
  return object;
}

json data_in(const std::string& html) {
  const std::string start = R"(<script type="application/json" id="data">)";
  const std::size_t first = html.find(start) + start.size();
  return json::parse(html.substr(first, html.find("</script>", first) - first));
}

testing::AssertionResult has_keys(const json& object, std::string_view keys) {
  for (const std::string& key : words(keys)) {
    if (!object.contains(key))
      return testing::AssertionFailure() << "no " << key << " in " << object.dump().substr(0, 300);
  }
  return testing::AssertionSuccess();
}

testing::AssertionResult is_matrix(const json& matrix, std::size_t rows, std::size_t columns) {
  if (matrix.size() != rows) return testing::AssertionFailure() << matrix.size() << " rows, expected " << rows;
  for (const json& row : matrix) {
    if (row.size() != columns) return testing::AssertionFailure() << row.size() << " columns, expected " << columns;
    for (const json& number : row) {
      if (!number.is_number()) return testing::AssertionFailure() << number << " is no number";
    }
  }
  return testing::AssertionSuccess();
}

}  // namespace paracal::test
