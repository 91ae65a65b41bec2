#include "long_job.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "launch.hpp"
#include "paracal/io/json.hpp"
#include "paracal/version.hpp"
#include "usage.hpp"

namespace paracal::app {
namespace {

jobs::Part part_of(const LongJobOptions& options, const jobs::Ranks& ranks) {
  if (options.part.empty()) return {};
  const std::size_t slash = options.part.find('/');
  const auto number = number_in<std::uint64_t>(std::string_view(options.part).substr(0, slash));
  const auto count = slash == std::string::npos
                         ? std::nullopt
                         : number_in<std::uint64_t>(std::string_view(options.part).substr(slash + 1));
  if (!number || !count || *number == 0 || *number > *count) {
    throw WrongUsage(fmt::format("--part: expected K/N with 1 <= K <= N, for example 3/10, got \"{}\"", options.part));
  }
  if (options.checkpoint.empty()) {
    throw WrongUsage("--part: expected --checkpoint DIR (a folder that all parts share), got none");
  }
  if (ranks.size() > 1) throw WrongUsage("--part: expected one process per part, got several MPI ranks");
  return {*number - 1, *count};
}

}  // namespace

void add_long_job_options(Command& command, LongJobOptions& options) {
  command.heading("Long jobs");
  command
      .add_option("--checkpoint", options.checkpoint,
                  "keep finished chunks in this folder; the same command later continues where it stopped")
      ->takes("FOLDER");
  command
      .add_option("--part", options.part,
                  "compute only every N-th chunk, starting with the K-th, as one job of an array; needs --checkpoint")
      ->takes("K/N");
}

void require_job(const LongJobOptions& options, bool is_long, std::string_view option) {
  if (is_long || (options.checkpoint.empty() && options.part.empty())) return;
  throw WrongUsage(fmt::format("{}: expected {} with it, got none; without it the job is short",
                               options.checkpoint.empty() ? "--part" : "--checkpoint", option));
}

io::Json description_of(const Session& session, const Robot& robot, const io::Json& files) {
  constexpr std::array kOfNoAccount{"--threads", "--checkpoint", "--part", "--out", "--report"};
  std::vector<std::string> words;
  for (std::size_t k = 0; k < session.words.size(); ++k) {
    const std::string& word = session.words[k];
    const std::string name = word.substr(0, word.find('='));
    const bool counts = std::ranges::find(kOfNoAccount, name) == kOfNoAccount.end();
    if (!counts && name == word) ++k;  // its value is the next word
    if (counts && name != "--json") words.push_back(word);
  }
  return {{"program", fmt::format("paracal {}", version())},
          {"build", build()},
          {"command", words},
          {"seed", session.seed()},
          {"robot", io::to_json(robot)},
          {"files", files}};
}

ShownJob::ShownJob(const LongJobOptions& options, Session& session, const io::Json& description)
    : part_(part_of(options, session.ranks())),
      line_("chunks"),
      job_(session.ranks(),
           {.checkpoint = options.checkpoint,
            .part = part_,
            .progress =
                [this, shows = session.ranks().number() == 0](std::uint64_t stage, std::uint64_t done,
                                                              std::uint64_t of) {
                  if (!shows) return;
                  if (std::exchange(stage_, stage) != stage) line_.begin(stage);
                  line_.show(done, of);
                },
            .warning =
                [this](const std::string& text) {
                  line_.clear();
                  std::fprintf(stderr, "%s: %s\n", Launch::name(), text.c_str());
                }},
           description) {}

std::string ShownJob::missing_parts() const {
  if (job_.left_to_others() == 0) return "";
  return fmt::format(
      "part {} of {} is done; {} chunks of other parts are missing. When all parts are done, run the command without "
      "--part to see the result.\n",
      part_.number + 1, part_.count, job_.left_to_others());
}

}  // namespace paracal::app
