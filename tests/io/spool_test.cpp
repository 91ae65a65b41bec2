#include "paracal/io/spool.hpp"

#include <gmock/gmock.h>
#include <rapidcheck.h>

#include <cstdlib>
#include <filesystem>

#include "paracal/error.hpp"

namespace paracal::io::spool_test {
namespace {

std::string all_of(const Spool& spool) {
  std::string text;
  spool.read([&](std::string_view piece) { text += piece; });
  return text;
}

TEST(Spool, GivesBackWhatItGot) {
  const bool held = rc::check("texts of any length", [] {
    Spool spool;
    std::string expected;
    for (const int size : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 100'000))) {
      const std::string text(static_cast<std::size_t>(size), static_cast<char>('a' + size % 26));
      spool.write(text);
      expected += text;
    }
    RC_ASSERT(all_of(spool) == expected);
    RC_ASSERT(all_of(spool) == expected);  // as often as one likes
    spool.write("more");
    RC_ASSERT(all_of(spool) == expected + "more");
  });
  EXPECT_TRUE(held);
}

/// TMPDIR while it lives.
class TemporaryFolderIs {
 public:
  explicit TemporaryFolderIs(const std::filesystem::path& folder) { setenv("TMPDIR", folder.c_str(), 1); }
  ~TemporaryFolderIs() { before_.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", before_.c_str(), 1); }
  TemporaryFolderIs(const TemporaryFolderIs&) = delete;
  TemporaryFolderIs& operator=(const TemporaryFolderIs&) = delete;

 private:
  std::string before_ = std::getenv("TMPDIR") != nullptr ? std::getenv("TMPDIR") : "";
};

TEST(Spool, NobodySeesItsFile) {
  std::string name = std::filesystem::temp_directory_path() / "paracal-spool-XXXXXX";
  const std::filesystem::path folder = mkdtemp(name.data());
  {
    const TemporaryFolderIs here(folder);
    Spool spool;
    spool.write(std::string(1'000'000, 'x'));
    EXPECT_TRUE(std::filesystem::is_empty(folder));
    EXPECT_EQ(all_of(spool).size(), 1'000'000u);
  }
  std::filesystem::remove(folder);
}

TEST(Spool, WithoutAFolderItHoldsALittle) {
  const TemporaryFolderIs nowhere("/nowhere");
  Spool spool;
  spool.write("a little");
  EXPECT_EQ(all_of(spool), "a little");
  EXPECT_THAT([&] { spool.write(std::string(100'000, 'x')); },
              testing::ThrowsMessage<Error>(testing::StartsWith("/nowhere: cannot be written: ")));
}

}  // namespace
}  // namespace paracal::io::spool_test
