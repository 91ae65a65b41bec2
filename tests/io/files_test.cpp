#include "paracal/io/file.hpp"

#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "paracal/error.hpp"
#include "paracal/io/signals_wait.hpp"
#include "paracal/io/store.hpp"

namespace paracal::io::files_test {
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

volatile std::sig_atomic_t interrupts = 0, terminations = 0;

extern "C" void count_signal(int signal) {
  if (signal == SIGINT) interrupts = interrupts + 1;
  if (signal == SIGTERM) terminations = terminations + 1;
}

/// None is lost, none comes twice, and what is to be ignored still is.
TEST(SignalsWait, TheyComeAfterwards) {
  interrupts = 0;
  terminations = 0;
  const auto interrupted = std::signal(SIGINT, count_signal), terminated = std::signal(SIGTERM, count_signal);
  const auto hung_up = std::signal(SIGHUP, SIG_IGN);
  {
    const SignalsWait outer;
    {
      const SignalsWait inner;
      for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::raise(signal);
    }
    EXPECT_EQ(interrupts + terminations, 0);
  }
  EXPECT_EQ(interrupts, 1);
  EXPECT_EQ(terminations, 1);
  std::raise(SIGINT);
  EXPECT_EQ(interrupts, 2);
  EXPECT_EQ(std::signal(SIGHUP, hung_up), SIG_IGN);
  std::signal(SIGINT, interrupted);
  std::signal(SIGTERM, terminated);
}

TEST(SignalsWaitDeathTest, OneThatEndsTheProcessEndsIt) {
  EXPECT_EXIT(
      {
        const SignalsWait whole;
        std::raise(SIGTERM);
      },
      testing::KilledBySignal(SIGTERM), "");
}

TEST(Sha256, KnownDigest) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace paracal::io::files_test
