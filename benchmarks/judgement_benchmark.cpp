// What a calibration says of machines whose truth the model does not hold: the table of docs/judgement.md.
//
//   paracal-judgement-benchmark [MACHINES [WORLD [ROBOT [notes]]]]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>

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
      "| {:<31} | {:>5.1f} | {:>5.1f} | {:>5.1f} | {:>5.1f} | {:>6.3f} | {:>6.3f} | {:>5.1f} | {:>5.2f} | {:>5.0f} |\n",
      world.name, share(all.accepted, all.machines), share(all.noted, all.accepted), 100.0 * all.error_coverage(),
      100.0 * all.distance_coverage(), median(all.largest_distance_error), median(all.largest_U),
      share(all.use_exceeded, all.accepted), median(all.U_over_oracle), ms);
}

}  // namespace

int main(int argc, char** argv) {
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
    fmt::print("\n{}, {} machines a world\n\n", robot.name(), machines);
    fmt::print(
        "| world                           | accepted, % | with a note, % | errors held, % | distances held, % | "
        "largest error of a distance, mm | largest U, mm | beyond U in use, % | U over the oracle's | ms |\n"
        "|---|---|---|---|---|---|---|---|---|---|\n");
    for (const World& world : wrong_worlds()) {
      if (!wanted.empty() && world.name.find(wanted) == std::string::npos) continue;
      const auto start = std::chrono::steady_clock::now();
      const Judgement all = judge_world(bench, world, 0, machines, true);
      const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
      print(world, all, took.count() / machines);
      if (show_notes) {
        for (const std::string& note : all.notes) fmt::print("    {}\n", note);
      }
      std::fflush(stdout);
    }
  }
}
