#include "paracal/io/file.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "paracal/error.hpp"

namespace paracal::io {
namespace {

class Files : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
  }

  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("paracal-files-" + std::to_string(::getpid()));
};

TEST_F(Files, WhatIsWrittenReadsBack) {
  const std::string text("a\0b\n", 4);
  write_file(folder / "x", text);
  EXPECT_EQ(read_file(folder / "x").text, text);
  write_file(folder / "x", "shorter");
  EXPECT_EQ(read_file(folder / "x").text, "shorter");
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Files, AFailedWriteLeavesNothingBehind) {
  EXPECT_THROW(write_file(folder / "missing" / "x", "text"), Error);
  std::filesystem::create_directory(folder / "taken");
  EXPECT_THROW(write_file(folder / "taken", "text"), Error);
  EXPECT_EQ(entries(), 1u);
}

TEST_F(Files, MissingFileAndFolderAreNamed) {
  EXPECT_THAT([&] { read_file(folder / "none.csv"); },
              testing::ThrowsMessage<InputFileError>(testing::HasSubstr("none.csv: cannot be read")));
  EXPECT_THAT([&] { read_file(folder); }, testing::ThrowsMessage<InputFileError>(testing::HasSubstr("got a folder")));
}

TEST(Sha256, KnownDigest) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace paracal::io
