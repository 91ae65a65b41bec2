// Files that the program reads whole: what they may be and hold.

#include "io/files/stored.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>

#include "io/robots/section.hpp"
#include "paracal/error.hpp"
#include "paracal/interruption.hpp"
#include "paracal/io/store.hpp"

namespace paracal::io::stored_test {
namespace {

using testing::HasSubstr, testing::ThrowsMessage;

class Stored : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder);
    ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("paracal-stored-" + std::to_string(getpid()));
};

std::string repeated(std::string_view part, std::size_t times) {
  std::string text;
  for (std::size_t k = 0; k < times; ++k) text += part;
  return text;
}

TEST_F(Stored, IsARegularFile) {
  write_file(folder / "file", "text");
  std::filesystem::create_symlink("file", folder / "link");
  EXPECT_EQ(read_stored(folder / "link").text, "text");
  const auto is_refused = ThrowsMessage<InputFileError>(HasSubstr("expected a regular file, got a pipe or device"));
  EXPECT_THAT([&] { read_stored(folder / "pipe"); }, is_refused);
  EXPECT_THAT([&] { read_stored("/dev/zero"); }, is_refused);
  EXPECT_THAT([&] { stored_bytes("/dev/zero"); }, is_refused);
  EXPECT_THAT([&] { read_stored(folder); }, ThrowsMessage<InputFileError>(HasSubstr("got a folder")));
}

/// A table may come from a pipe, to which nobody may ever write.
TEST_F(Stored, AWaitForAPipeCanBeEnded) {
  struct Ended {};
  const auto begun = std::chrono::steady_clock::now();
  const Interruptible soon([&] {
    if (std::chrono::steady_clock::now() - begun > std::chrono::milliseconds(60)) throw Ended();
  });
  EXPECT_THROW(read_file(folder / "pipe"), Ended);
  const auto stream = open_file(folder / "pipe");
  char first = '\0';
  EXPECT_THROW(stream->read(&first, 1), Ended);
}

TEST(StoredJson, SaysEachKeyOnce) {
  EXPECT_THAT(
      [] {
        (void)parse_json({"f", "{\"a\": {\"b\": 1},\n \"c\": {\"b\": 2},\n \"a\": 3}"});
      },
      ThrowsMessage<InputFileError>("f:3: expected each key once, got \"a\" again; remove one of them"));
  EXPECT_EQ(parse_json({"f", R"({"a": [1, -2, 1.5, true, null, "t", {}], "b": {"a": []}})"}).dump(),
            R"({"a":[1,-2,1.5,true,null,"t",{}],"b":{"a":[]}})");
}

TEST(StoredJson, IsRefusedWithItsLine) {
  for (const auto& [text, complaint] : {std::pair{"", "f:1: expected JSON, got an empty file"},
                                        {"\n \n", "expected JSON, got an empty file"},
                                        {"{\n\"a\": }", "f:2: expected JSON, got something else"},
                                        {"[1,\n1e999]", "f:2: expected numbers below 1e309, got 1e999"}}) {
    EXPECT_THAT(([&, text = std::string(text)] {
                  (void)parse_json({"f", text});
                }),
                ThrowsMessage<InputFileError>(HasSubstr(complaint)));
  }
}

/// Of a text as long, and of one that costs no more than others: a long list of numbers.
TEST(StoredJson, TakesMemoryAsItsText) {
  const auto parsed = [](const std::string& text) { return parse_json({"f", text}).size(); };
  const auto is_refused = ThrowsMessage<InputFileError>(HasSubstr("expected fewer values in a file of this length"));
  EXPECT_THAT([&] { parsed("[" + repeated("{},", 300'000) + "0]"); }, is_refused);
  EXPECT_THAT([&] { parsed("[" + repeated("0,", 600'000) + "0]"); }, is_refused);
  EXPECT_EQ(parsed("[" + repeated("0.12345678,", 600'000) + "0]"), 600'001U);
  std::string keys;
  for (int k = 0; k < 257; ++k) keys += "\"" + std::to_string(k) + "\":0,";
  EXPECT_THAT([&] { parsed("{" + keys + "\"a\":0}"); },
              ThrowsMessage<InputFileError>(HasSubstr("expected at most 256 keys in an object")));
}

TEST(StoredToml, IsShort) {
  EXPECT_THAT(
      [] {
        (void)parse_toml({"f", repeated("a = 1\n", 200'000)});
      },
      ThrowsMessage<InputFileError>("f: expected at most 1 MiB of TOML, got more"));
  EXPECT_EQ(parse_toml({"f", "# " + std::string(1'000'000, 'x') + "\na = 1\n"}).size(), 1U);
}

TEST(StoredToml, IsNotNestedWithoutEnd) {
  const auto nested = [](std::size_t levels) {
    return parse_toml({"f", "a = 1\nb = " + repeated("[", levels) + repeated("]", levels) + "\n"}).size();
  };
  EXPECT_EQ(nested(64), 2U);
  EXPECT_THAT([&] { nested(65); },
              ThrowsMessage<InputFileError>("f:2: expected at most 64 levels of nesting, got more"));
  EXPECT_EQ(parse_toml({"f", repeated("[[a]]\nb = [[1], {c = 1}]\n", 100)}).size(), 1U);
}

}  // namespace
}  // namespace paracal::io::stored_test
