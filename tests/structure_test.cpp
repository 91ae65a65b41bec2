// Compares the dependencies in docs/design.md with the includes of the files.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/places.hpp"

namespace paracal::structure_test {
namespace {

const std::filesystem::path kRoot = test::source_folder();

using Arrows = std::map<std::string, std::set<std::string>>;

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// Modules, and which others each may use: "| `module/` | content | kinematics, mechanism |", or "all above".
Arrows promised_arrows() {
  const std::regex row("\\| `([a-z]+)/` \\|.*\\| ([a-z, ]*)\\|");
  Arrows arrows;
  std::set<std::string> above;
  for (const std::string& line : lines_of(kRoot / "docs/design.md")) {
    std::smatch found;
    if (!std::regex_match(line, found, row)) continue;
    const std::string room = found[1], may_use = found[2];
    std::set<std::string>& allowed = arrows[room];
    if (may_use.starts_with("all above")) allowed = above;
    for (const std::string& one : above) {
      if (may_use.find(one) != std::string::npos) allowed.insert(one);
    }
    above.insert(room);
  }
  return arrows;
}

/// Includes of other modules that the table does not allow: "FILE includes MODULE".
std::vector<std::string> forbidden(const Arrows& promised) {
  const std::regex include("#include \"(?:paracal/)?([a-z]+)/.*");
  std::vector<std::string> found;
  for (const auto& [room, allowed] : promised) {
    for (const auto& side : {kRoot / "include/paracal" / room, kRoot / "src" / room}) {
      if (!std::filesystem::is_directory(side)) continue;  // the page
      for (const auto& entry : std::filesystem::recursive_directory_iterator(side)) {
        for (const std::string& line : entry.is_regular_file() ? lines_of(entry.path()) : std::vector<std::string>()) {
          std::smatch other;
          if (!std::regex_match(line, other, include) || !promised.contains(other[1])) continue;
          if (other[1] == room || allowed.contains(other[1])) continue;
          found.push_back(fmt::format("{} includes {}", entry.path().lexically_relative(kRoot).string(), other.str(1)));
        }
      }
    }
  }
  return found;
}

TEST(Structure, ArrowsPointAsTheDesignSays) {
  Arrows promised = promised_arrows();
  ASSERT_THAT(promised, testing::Contains(testing::Key("calibration")));
  for (const auto& entry : std::filesystem::directory_iterator(kRoot / "src")) {
    const bool is_module = promised.contains(entry.path().filename());
    EXPECT_TRUE(is_module || !entry.is_directory()) << entry.path() << ": expected a module of docs/design.md";
  }
  EXPECT_THAT(promised["numerics"], testing::IsEmpty());
  EXPECT_THAT(forbidden(promised), testing::IsEmpty());
  // The test sees an arrow that is there.
  promised["calibration"].erase("kinematics");
  EXPECT_THAT(forbidden(promised), testing::Contains(testing::HasSubstr("src/calibration/fit/observation.cpp")));
}

/// Each unit that uses a decomposition of Eigen's compiles it again, for seconds to a minute: numerics/ compiles it
/// once. "FILE: LINE" of each use elsewhere.
std::vector<std::string> decompositions_outside_of(const std::string& allowed) {
  const std::regex use(
      R"(#include <Eigen/(SVD|QR|LU|Cholesky|Eigenvalues|Dense)>)"
      R"(|\b(LLT|LDLT|HouseholderQR|ColPivHouseholderQR|CompleteOrthogonalDecomposition|PartialPivLU|FullPivLU)<)"
      R"(|\b(JacobiSVD|BDCSVD|EigenSolver|SelfAdjointEigenSolver)<)"
      R"(|\.(llt|ldlt|lu|partialPivLu|fullPivLu|householderQr|colPivHouseholderQr|completeOrthogonalDecomposition)\()"
      R"(|\.(jacobiSvd|bdcSvd|eigenvalues|operatorNorm|operatorInverseSqrt)\()");
  std::vector<std::string> found;
  for (const char* const folder : {"src", "include", "apps", "python", "tests"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / folder)) {
      const std::string file = entry.path().lexically_relative(kRoot).string();
      if (!entry.is_regular_file() || !std::regex_search(file, std::regex("[.][ch]pp$")) || file.starts_with(allowed)) {
        continue;
      }
      for (const std::string& line : lines_of(entry.path())) {
        if (line.ends_with("/LU>") && file.starts_with("tests/")) continue;  // inverses of small matrices
        if (std::regex_search(line, use)) found.push_back(fmt::format("{}: {}", file, line));
      }
    }
  }
  return found;
}

TEST(Structure, DecompositionsAreInNumerics) {
  EXPECT_THAT(decompositions_outside_of("src/numerics/"), testing::IsEmpty());
  EXPECT_THAT(decompositions_outside_of("none"), testing::Contains(testing::HasSubstr("JacobiSVD")));
}

/// A folder that nobody overlooks at once is two folders.
TEST(Structure, NoFolderOfTheLibraryHasMoreThan40Files) {
  std::map<std::string, int> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "src")) {
    if (entry.is_regular_file()) ++files[entry.path().parent_path().lexically_relative(kRoot).string()];
  }
  EXPECT_GT(files["src/calibration/fit"], 20);
  for (const auto& [folder, count] : files) EXPECT_LE(count, 40) << folder;
}

TEST(Structure, OneHeaderShowsTheLibraryForJson) {
  std::vector<std::string> showing;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "include")) {
    if (!entry.is_regular_file()) continue;
    const std::vector<std::string> lines = lines_of(entry.path());
    const bool shows =
        std::ranges::any_of(lines, [](const std::string& line) { return line.find("<nlohmann") != std::string::npos; });
    if (shows) showing.push_back(entry.path().filename());
  }
  EXPECT_THAT(showing, testing::ElementsAre("json.hpp"));
}

/// The headers that a header includes, directly or not, and itself, by paths below include/.
void add_brought(const std::string& header, std::set<std::string>& brought) {
  if (!brought.insert(header).second) return;
  const std::regex include("#include \"(paracal/.*)\".*");
  for (const std::string& line : lines_of(kRoot / "include" / header)) {
    std::smatch other;
    if (std::regex_match(line, other, include)) add_brought(other[1], brought);
  }
}

TEST(Structure, OneHeaderHoldsTheWholeLibrary) {
  std::set<std::string> whole;
  add_brought("paracal/paracal.hpp", whole);
  EXPECT_FALSE(whole.contains("paracal/io/json.hpp"));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kRoot / "include")) {
    if (!entry.is_regular_file()) continue;
    const std::string header = entry.path().lexically_relative(kRoot / "include");
    std::set<std::string> brought;
    add_brought(header, brought);
    const bool is_apart = brought.contains("paracal/io/json.hpp") || header.ends_with("_impl.hpp");
    EXPECT_EQ(whole.contains(header), !is_apart) << header;
  }
}

/// tools/mutations.sh changes one expression at a time, so each must occur once in its file. Move them with the code.
TEST(Structure, MutationsStandInTheirFiles) {
  std::string file, text;
  int mutations = 0;
  for (const std::string& line : lines_of(kRoot / "tools/mutations.txt")) {
    if (line.empty() || line.starts_with('#')) continue;
    if (!line.starts_with(' ')) {
      file = line.substr(0, line.find(' '));
      std::ifstream in(kRoot / file);
      text.assign(std::istreambuf_iterator<char>(in), {});
      EXPECT_FALSE(text.empty()) << file;
      continue;
    }
    const std::string expression = line.substr(2, line.find(" => ") - 2);
    const std::size_t first = text.find(expression);
    EXPECT_NE(first, std::string::npos) << file << ": " << expression;
    EXPECT_EQ(text.find(expression, first + 1), std::string::npos) << file << ": " << expression;
    EXPECT_FALSE(expression.starts_with("if ")) << file << ": no expression: " << expression;
    ++mutations;
  }
  EXPECT_GT(mutations, 300);
}

}  // namespace
}  // namespace paracal::structure_test
