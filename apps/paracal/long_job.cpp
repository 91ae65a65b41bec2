#include "long_job.hpp"

#include <fmt/format.h>

#include <cstdio>

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
    throw WrongUsage(fmt::format("--part: expected K/N with 1 <= K <= N, as 3/10, got \"{}\"", options.part));
  }
  if (options.checkpoint.empty()) {
    throw WrongUsage("--part: expected --checkpoint DIR, a folder that all parts see, got none");
  }
  if (ranks.size() > 1) throw WrongUsage("--part: expected one process a part, got several ranks of MPI");
  return {*number - 1, *count};
}

}  // namespace

void add_long_job_options(Command& command, LongJobOptions& options) {
  const std::string heading = "Long jobs";
  command
      .add_option("--checkpoint", options.checkpoint,
                  "folder that keeps finished chunks: the same command again goes on where it stopped")
      ->group(heading);
  command
      .add_option("--part", options.part,
                  "K/N: compute every N-th chunk alone, beginning with the K-th, as one of an array of jobs; needs "
                  "--checkpoint")
      ->group(heading);
}

ShownJob::ShownJob(const LongJobOptions& options, Session& session, const io::Json& description)
    : part_(part_of(options, session.ranks())),
      line_("chunks", 0),
      job_(session.ranks(),
           {.checkpoint = options.checkpoint,
            .part = part_,
            .progress =
                [this, shows = session.ranks().number() == 0](std::uint64_t done, std::uint64_t of) {
                  if (!shows) return;
                  line_.expect(of);
                  line_.show(done);
                },
            .warning =
                [this](const std::string& text) {
                  line_.clear();
                  std::fprintf(stderr, "paracal: %s\n", text.c_str());
                }},
           description) {}

std::string ShownJob::missing_parts() const {
  if (job_.left_to_others() == 0) return "";
  return fmt::format(
      "part {} of {} is done; {} chunks of other parts are not there yet. When all parts have ended, the same command "
      "without --part shows the result.\n",
      part_.number + 1, part_.count, job_.left_to_others());
}

}  // namespace paracal::app
