// Results of calibrations of machines that differ from the model: the table of docs/judgement.md.
//
//   [mpirun -n RANKS] paracal-judgement-benchmark [MACHINES [SCENARIO [ROBOT [notes]]]]

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "jobs/chunked_job.hpp"
#include "launch.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "support/robots.hpp"
#include "support/virtual_machines.hpp"
#include "support/worlds.hpp"

namespace {

using namespace paracal;
using namespace paracal::test;

double median(const std::vector<double>& values) { return values.empty() ? 0.0 : quantile(values, 0.5); }

void print(const World& world, const Judgement& all, double ms) {
  const auto share = [](int part, int of) { return of == 0 ? 0.0 : 100.0 * part / of; };
  fmt::print(
      "| {:<31} | {:>5.1f} | {:>5.1f} | {:>5.1f} | {:>5.1f} | {:>5.1f} | {:>6.3f} | {:>6.3f} | {:>5.1f} {:>5.1f} "
      "{:>5.1f} | "
      "{:>5.1f} {:>5.1f} {:>5.1f} | {:>5.2f} | {:>5.2f} | {:>5.0f} |\n",
      world.name, share(all.accepted, all.machines), share(all.noted, all.accepted), 100.0 * all.error_coverage(),
      100.0 * all.distance_coverage(), share(all.visits_held, all.distances), median(all.largest_distance_error),
      median(all.largest_U), share(all.use_exceeded[0], all.accepted), share(all.use_exceeded[1], all.accepted),
      share(all.use_exceeded[2], all.accepted), share(all.visit_exceeded[0], all.accepted),
      share(all.visit_exceeded[1], all.accepted), share(all.visit_exceeded[2], all.accepted), median(all.U_over_oracle),
      median(all.use_over_oracle), ms);
}

// ---- a world in chunks of machines, which any rank computes

constexpr int kChunk = 4;

nlohmann::json as_json(const Judgement& one) {
  return {{"counts",
           {one.machines, one.accepted, one.noted, one.errors, one.errors_held, one.distances, one.distances_held,
            one.visits_held, one.use_exceeded[0], one.use_exceeded[1], one.use_exceeded[2], one.visit_exceeded[0],
            one.visit_exceeded[1], one.visit_exceeded[2]}},
          {"largest_distance_error", one.largest_distance_error},
          {"largest_U", one.largest_U},
          {"U_over_oracle", one.U_over_oracle},
          {"use_over_oracle", one.use_over_oracle},
          {"notes", one.notes}};
}

void add(const nlohmann::json& json, Judgement& all) {
  const std::array counts{&all.machines,          &all.accepted,         &all.noted,           &all.errors,
                          &all.errors_held,       &all.distances,        &all.distances_held,  &all.visits_held,
                          &all.use_exceeded[0],   &all.use_exceeded[1],  &all.use_exceeded[2], &all.visit_exceeded[0],
                          &all.visit_exceeded[1], &all.visit_exceeded[2]};
  for (std::size_t k = 0; k < counts.size(); ++k) *counts[k] += json.at("counts").at(k).get<int>();
  const auto append = [&](auto& values, const char* key) {
    for (const auto& value : json.at(key)) values.push_back(value);
  };
  append(all.largest_distance_error, "largest_distance_error");
  append(all.largest_U, "largest_U");
  append(all.U_over_oracle, "U_over_oracle");
  append(all.use_over_oracle, "use_over_oracle");
  append(all.notes, "notes");
}

Judgement judged(LongJob& job, const Bench& bench, const World& world, int machines) {
  const auto chunks = static_cast<std::uint64_t>((machines + kChunk - 1) / kChunk);
  Judgement all;
  const auto compute = [&](std::uint64_t chunk) {
    const int first = kChunk * static_cast<int>(chunk);
    return std::optional(as_json(judge_world(bench, world, first, std::min(kChunk, machines - first), true)).dump());
  };
  const auto check = [](std::uint64_t, const std::string& text) {
    Judgement unused;
    add(nlohmann::json::parse(text), unused);
  };
  const auto results = compute_each(job, "judgement", 0, chunks, compute, check);
  for (const std::string& result : results.value()) add(nlohmann::json::parse(result), all);
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  app::Launch launch(argc, argv);
  jobs::ChunkedJob job(launch.ranks(), {}, {});
  if (launch.ranks().number() != 0) (void)std::freopen("/dev/null", "w", stdout);
  const int machines = argc > 1 ? std::atoi(argv[1]) : 200;
  const std::string_view wanted = argc > 2 ? argv[2] : "";
  const std::string_view wanted_robot = argc > 3 ? argv[3] : "";
  const bool show_notes = argc > 4;
  std::vector<std::string_view> names = catalogue::names();
  names.insert(names.end(), template_names().begin(), template_names().end());
  for (const std::string_view name : names) {
    if (name.find(wanted_robot) == std::string::npos) continue;
    const Robot robot = robot_named(name);
    const Bench bench = bench_of(robot);
    fmt::print("\n{}, {} machines per scenario\n\n", robot.name(), machines);
    fmt::print(
        "| scenario                        | accepted, % | with a note, % | errors covered, % | distances covered, % | "
        "of a "
        "visit, % | largest error of a distance, mm | largest U, mm | above U in the workspace (distance, aligned, "
        "rotation), "
        "% | of a visit, % | U / ideal U | of a visit | ms |\n"
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const World& world : wrong_worlds()) {
      if (!wanted.empty() && world.name.find(wanted) == std::string::npos) continue;
      const auto start = std::chrono::steady_clock::now();
      const Judgement all = judged(job, bench, world, machines);
      const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
      print(world, all, took.count() / machines);
      if (show_notes) {
        for (const std::string& note : all.notes) fmt::print("    {}\n", note);
      }
      std::fflush(stdout);
    }
  }
}
