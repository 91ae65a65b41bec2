#include "paracal/long_job.hpp"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "paracal/error.hpp"

namespace paracal {
namespace {

using Json = nlohmann::json;

/// Results by the number of their chunk: {"12": result}.
class EachOf : public JobStage {
 public:
  EachOf(std::string name, std::uint64_t first, std::uint64_t last,
         const std::function<std::optional<std::string>(std::uint64_t)>& compute,
         const std::function<void(std::uint64_t, const std::string&)>& check)
      : name_(std::move(name)), first_(first), last_(last), compute_(compute), check_(check) {}

  std::uint64_t first() const override { return first_; }
  std::uint64_t last() const override { return last_; }
  std::string name_of(std::uint64_t chunk) const override { return fmt::format("{}-{:06}", name_, chunk); }
  std::optional<std::string> compute(std::uint64_t chunk) override {
    const std::optional<std::string> result = compute_(chunk);
    if (!result) return std::nullopt;
    return fmt::format("{{\"{}\":{}}}", chunk, *result);
  }
  void check(std::uint64_t chunk, std::string_view result) const override {
    try {
      const Json json = Json::parse(result);
      if (json.size() == 1) return check_(chunk, json.at(std::to_string(chunk)).dump());
    } catch (const std::exception&) {  // has the words of a parser
    }
    throw Error(fmt::format("expected the result of chunk {}, got something else", chunk));
  }
  void add(std::string_view result) override {
    const Json chunks = Json::parse(result);
    for (const auto& [chunk, one] : chunks.items()) results_[std::stoull(chunk)] = one.dump();
  }
  std::string total() const override {
    std::string text;
    for (const auto& [chunk, one] : results_) text += fmt::format("{}\"{}\":{}", text.empty() ? "" : ",", chunk, one);
    return fmt::format("{{{}}}", text);
  }
  void clear() override { results_.clear(); }

  std::vector<std::string> in_order() const {
    std::vector<std::string> all;
    for (const auto& [chunk, one] : results_) all.push_back(one);
    return all;
  }

 private:
  std::string name_;
  std::uint64_t first_, last_;
  const std::function<std::optional<std::string>(std::uint64_t)>& compute_;
  const std::function<void(std::uint64_t, const std::string&)>& check_;
  std::map<std::uint64_t, std::string> results_;
};

}  // namespace

bool JobInMemory::run(JobStage& stage) {
  stage.clear();
  for (std::uint64_t chunk = stage.first(); chunk < stage.last(); ++chunk) {
    const std::optional<std::string> result = stage.compute(chunk);
    if (!result) return false;
    stage.add(*result);
  }
  return true;
}

std::optional<std::vector<std::string>> compute_each(
    LongJob& job, const std::string& name, std::uint64_t first, std::uint64_t last,
    const std::function<std::optional<std::string>(std::uint64_t)>& compute,
    const std::function<void(std::uint64_t, const std::string&)>& check) {
  EachOf stage(name, first, last, compute, check);
  if (!job.run(stage)) return std::nullopt;
  return stage.in_order();
}

}  // namespace paracal
