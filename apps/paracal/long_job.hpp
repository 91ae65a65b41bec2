#pragma once

#include <string>
#include <string_view>

#include "arguments.hpp"
#include "jobs/chunked_job.hpp"
#include "progress_line.hpp"
#include "session.hpp"

namespace paracal::app {

/// Options that all long jobs share.
struct LongJobOptions {
  std::string checkpoint, part;
};

void add_long_job_options(Command& command, LongJobOptions& options);

/// @throws WrongUsage for options of a long job where the command is none.
void require_job(const LongJobOptions& options, bool is_long, std::string_view option);

/// What decides the results of a command: its words but for those that say who computes and where results go, robot
/// and seed, and what its files say.
io::Json description_of(const Session& session, const Robot& robot, const io::Json& files);

/// A long job on the ranks of this program; a line on standard error shows how far it is.
class ShownJob : public LongJob {
 public:
  /// @param description  what decides the results.
  ShownJob(const LongJobOptions& options, Session& session, const io::Json& description);

  const io::Json& agreed() const { return job_.agreed(); }
  /// "part 2 of 4: done; 12 chunks of other parts are not there yet", where that is why something is missing.
  std::string missing_parts() const;

  bool run(JobStage& stage) override { return job_.run(stage); }

 private:
  jobs::Part part_;
  ProgressLine line_;
  std::uint64_t stage_ = 0;
  jobs::ChunkedJob job_;
};

}  // namespace paracal::app
