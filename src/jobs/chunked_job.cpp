#include "chunked_job.hpp"

#include <fmt/format.h>

#include <utility>

namespace paracal::jobs {

ChunkedJob::ChunkedJob(Ranks& ranks, ChunkedJobOptions options, const io::Json& description)
    : ranks_(ranks), options_(std::move(options)), agreed_(description) {
  if (options_.checkpoint.empty()) return;
  checkpoint_.emplace(options_.checkpoint, description);
  agreed_ = checkpoint_->agreed();
}

bool ChunkedJob::run(JobStage& stage) {
  stage.clear();
  ++stages_;
  ranks_.begin();
  const std::uint64_t chunks = stage.last() - stage.first();
  const std::uint64_t left_before = left_to_others_;
  bool stopped = false;
  for (std::uint64_t k = ranks_.take(); k < chunks && !stopped; k = ranks_.take()) {
    if (options_.progress) options_.progress(stages_, k, chunks);
    ranks_.work([&] {
      const std::uint64_t left = left_to_others_;
      const std::optional<std::string> result = result_of(stage, stage.first() + k);
      if (result) stage.add(*result);
      stopped = !result && left_to_others_ == left;
    });
  }
  const bool complete = ranks_.all(!stopped && left_to_others_ == left_before);
  ranks_.add_up(stage);
  return complete;
}

std::optional<std::string> ChunkedJob::result_of(JobStage& stage, std::uint64_t chunk) {
  if (auto result = kept(stage, chunk)) return result;
  if (chunk % options_.part.count != options_.part.number) {
    ++left_to_others_;
    return std::nullopt;
  }
  std::optional<std::string> result = stage.compute(chunk);
  if (result && checkpoint_) checkpoint_->write(stage.name_of(chunk), *result);
  return result;
}

std::optional<std::string> ChunkedJob::kept(const JobStage& stage, std::uint64_t chunk) const {
  const std::string name = stage.name_of(chunk);
  if (!checkpoint_ || !checkpoint_->has(name)) return std::nullopt;
  try {
    std::string result = checkpoint_->read(name);
    stage.check(chunk, result);
    return result;
  } catch (const InputFileError&) {
    throw;
  } catch (const std::exception& damaged) {
    if (options_.warning) {
      options_.warning(
          fmt::format("{}: {}; this chunk is computed again", checkpoint_->file_of(name).string(), damaged.what()));
    }
    return std::nullopt;
  }
}

}  // namespace paracal::jobs
