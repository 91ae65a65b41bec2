#pragma once

#include <string>

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
  jobs::ChunkedJob job_;
};

}  // namespace paracal::app
