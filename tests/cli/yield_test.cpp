// A batch of virtual machines as its user meets it: figures, the same bytes however the work is spread, and what is
// left when a process is interrupted, killed, or finds a folder that is not its own.

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <thread>
#include <tuple>

#include "jobs/gzip.hpp"
#include "json_checks.hpp"
#include "paracal/io/file.hpp"
#include "terminal.hpp"

namespace paracal::test::yield_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::HasSubstr, testing::IsEmpty, testing::Not;

const int kMachines = every_machine() ? 37 : 9, kChunk = every_machine() ? 5 : 2;
constexpr int kEndless = 100000000;  // machines

std::string yield_of(int machines, const std::string& options = "") {
  return fmt::format("yield --exact --machines {} --max-position-aligned-mm 0.05 --seed 3 --json {}", machines,
                     options);
}

/// The same with a checkpoint folder.
std::string kept_yield(int machines, const std::string& options = "") {
  return yield_of(machines, fmt::format("--checkpoint folder --chunk {} {}", kChunk, options));
}

class Yield : public testing::Test {
 protected:
  /// What one process says, without a folder and with one thread.
  static const std::string& undisturbed() {
    static const std::string bytes = run_program(of_huang2016(yield_of(kMachines, "--threads 1"))).out;
    return bytes;
  }

  std::unique_ptr<RunningProgram> start(const std::string& command, std::vector<std::string> environment = {}) const {
    return std::make_unique<RunningProgram>(
        of_huang2016(command), Surroundings{.folder = folder.path(), .environment = std::move(environment)});
  }

  std::set<std::string> chunks() const {
    std::set<std::string> names;
    const std::filesystem::path path = folder.path() / "folder";
    if (!std::filesystem::exists(path)) return names;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      const std::string name = entry.path().filename();
      if (name.ends_with(".json.gz")) names.insert(name);
    }
    return names;
  }

  /// Waits until a running batch has finished something.
  void wait_for_chunks(std::size_t count) const {
    wait_until([&] { return chunks().size() >= count; });
  }
  void wait_for(const std::string& file) const {
    wait_until([&] { return std::filesystem::exists(folder.path() / "folder" / file); });
  }

  template <typename Condition>
  static void wait_until(Condition&& condition) {
    for (int k = 0; k < 6000 && !condition(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    ASSERT_TRUE(condition());
  }

  void expect_undisturbed(const ProgramResult& result) const {
    EXPECT_EQ(result.exit_code, kDone);
    EXPECT_THAT(result.err, IsEmpty());
    EXPECT_TRUE(result.out == undisturbed()) << result.out;
  }

  TemporaryFolder folder;
};

TEST_F(Yield, SaysWhatCustomersGet) {
  const json object = json::parse(undisturbed());
  ASSERT_TRUE(has_keys(
      object, "machines machines_asked partial fates confidence passed yield dpmo quantities assumed batch inputs"));
  EXPECT_EQ(object["machines"], kMachines);
  EXPECT_EQ(object["partial"], false);
  ASSERT_TRUE(has_keys(object["fates"], "accepted rejected not_identifiable not_converged does_not_close"));
  EXPECT_EQ(object["fates"]["accepted"], kMachines);
  ASSERT_TRUE(has_keys(object["yield"], "value low high confidence"));
  EXPECT_EQ(object["yield"]["value"], object["passed"].get<double>() / kMachines);
  EXPECT_LT(object["yield"]["low"], object["yield"]["value"]);
  EXPECT_NEAR(object["dpmo"]["value"], 1e6 * (1.0 - object["yield"]["value"].get<double>()), 1e-6);
  ASSERT_TRUE(has_keys(object["quantities"], "distance_mm volumetric_mm volumetric_aligned_mm rotation_deg tilt_rad"));
  for (const auto& [name, quantity] : object["quantities"].items()) {
    SCOPED_TRACE(name);
    for (const char* when : {"before", "after"}) {
      ASSERT_TRUE(has_keys(quantity[when], "mean std p50 p90 p95 p99 p99_73 p95_interval"));
      EXPECT_LE(quantity[when]["p50"], quantity[when]["p95"]);
      EXPECT_LE(quantity[when]["p95_interval"][0], quantity[when]["p95"]);
      EXPECT_TRUE(quantity[when]["p95_interval"][1].is_null()) << "so few machines cannot tell";
    }
  }
  EXPECT_LT(object["quantities"]["volumetric_aligned_mm"]["after"]["p95"], 0.2);
  EXPECT_GT(object["quantities"]["volumetric_aligned_mm"]["before"]["p50"], 1.0);
}

TEST_F(Yield, PeopleReadATable) {
  const ProgramResult result = folder.run(fmt::format("yield --machines {} --max-tilt-rad 0.01", kChunk));
  EXPECT_EQ(result.exit_code, kDone);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out, AllOf(HasSubstr(fmt::format("{} accepted", kChunk)), HasSubstr("yield 100.000 %"),
                                HasSubstr("defects per million"), HasSubstr("99.73 %"), HasSubstr("tilt, rad")));
}

TEST_F(Yield, ARigidPlateHasNoRotation) {
  const json object = json_of(folder.run("yield --machines 2 --robot rotary_delta --json"));
  EXPECT_TRUE(object["quantities"]["rotation_deg"].is_null());
  EXPECT_EQ(folder.run("yield --machines 2 --robot rotary_delta --max-rotation-deg 1").exit_code, kWrongUsage);
}

/// Nothing was asked of the machines, so none keeps it.
TEST_F(Yield, WithoutLimitsThereIsNone) {
  const ProgramResult text = folder.run("yield --machines 2 --report page.html");
  EXPECT_THAT(text.out, AllOf(HasSubstr("no yield: no limits are stated"), HasSubstr("2 accepted"),
                              Not(HasSubstr("yield 1")), Not(HasSubstr("defects"))));
  const json object = json_of(folder.run("yield --machines 2 --json"));
  for (const char* key : {"passed", "yield", "dpmo"}) EXPECT_TRUE(object.at(key).is_null()) << key;
  EXPECT_EQ(object.at("confidence"), 0.95);
  EXPECT_THAT(folder.read("page.html"), HasSubstr("\"passed\":null,\"yield\":null"));
  const ProgramResult refused = folder.run("yield --machines 2 --min-yield 0.1");
  EXPECT_EQ(refused.exit_code, kWrongUsage);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("--min-yield"), HasSubstr("--max-")));
}

/// One machine: it fails just below the number in the row, and passes just above it.
TEST_F(Yield, EveryLimitJudgesTheRowOfItsName) {
  const std::string command = "yield --machines 1 --seed 5";
  const std::string table = folder.run(command + " --report page.html").out;
  const json quantities = data_in(folder.read("page.html")).at("results").at("yield").at("quantities");
  std::string above;
  const auto passed = [&](const std::string& limits) {
    return json_of(folder.run(command + " --json" + limits)).at("passed").get<int>();
  };
  for (const auto& [option, key, row] :
       {std::tuple("--max-distance-mm", "distance_mm", "distance, mm"),
        std::tuple("--max-position-mm", "volumetric_mm", "position, mm"),
        std::tuple("--max-position-aligned-mm", "volumetric_aligned_mm", "position aligned, mm"),
        std::tuple("--max-rotation-deg", "rotation_deg", "rotation, deg"),
        std::tuple("--max-tilt-rad", "tilt_rad", "tilt, rad")}) {
    const double after = quantities.at(key).at("after").at("mean");
    EXPECT_EQ(passed(fmt::format(" {} {}", option, 0.98 * after)), 0) << option;
    above += fmt::format(" {} {}", option, 1.02 * after);
    const std::size_t line = table.find(std::string("\n  ") + row);
    ASSERT_NE(line, std::string::npos) << row;
    const double shown = std::stod(table.substr(table.find("after", line) + 5));
    EXPECT_NEAR(shown / after, 1.0, 0.005) << row;
  }
  EXPECT_EQ(passed(above), 1);
}

TEST_F(Yield, NamesItsInputs) {
  folder.write("tolerances.toml", "rod_mean_mm = 0.3\nalpha2_deg = 0.01\nothers = \"exact\"\n");
  folder.write("robot.toml", run_program(of_huang2016("robot")).out);
  const json object = json_of(folder.run("yield --machines 2 --robot robot.toml --tolerances tolerances.toml --json"));
  ASSERT_EQ(object["inputs"].size(), 2U);
  EXPECT_EQ(object["inputs"][0]["file"], "robot.toml");
  EXPECT_EQ(object["inputs"][1]["file"], "tolerances.toml");
  EXPECT_EQ(object["inputs"][1]["sha256"].get<std::string>().size(), 64U);
}

/// The lower bound decides: 2 of 2 machines prove little.
TEST_F(Yield, IsJudged) {
  EXPECT_EQ(folder.run("yield --machines 2 --max-tilt-rad 0.01 --min-yield 0.1").exit_code, kDone);
  EXPECT_EQ(folder.run("yield --machines 2 --max-tilt-rad 0.01 --min-yield 0.9").exit_code, kVerdictIsNo);
}

// ---- the same bytes

TEST_F(Yield, DoesNotDependOnThreadsOrChunks) {
  for (const char* options : {"--threads 2", "--threads 0 --chunk 7", "--threads 1 --chunk 1000"}) {
    SCOPED_TRACE(options);
    expect_undisturbed(folder.run(yield_of(kMachines, options)));
  }
}

/// Enough machines that most are computed to first order: said, the same for any threads, chunks and interruptions,
/// and not mixed with the other way.
TEST_F(Yield, ComputesMostMachinesToFirstOrder) {
  const std::string command =
      "yield --robot rotary_delta --machines 2000 --max-position-aligned-mm 0.05 --interval 0.05";
  const ProgramResult text = folder.run(command + " --report page.html");
  const json object = data_in(folder.read("page.html")).at("results").at("yield");
  EXPECT_EQ(object["machines"], 2000);
  EXPECT_LE(object["produced"], 1000);
  EXPECT_GE(object["produced"], 256);
  EXPECT_GT(object["unseen"], 0.0);
  EXPECT_EQ(object["batch"]["first_order"], true);
  const json& spread = object["quantities"]["volumetric_aligned_mm"]["after"];
  EXPECT_LT(spread["intervals"]["p95"][0], spread["p95"]);
  EXPECT_GT(spread["intervals"]["p95"][1], spread["p95"]);
  EXPECT_TRUE(spread["intervals"]["p99_9"][1].is_null());
  EXPECT_LT(object["yield"]["low"], object["yield"]["value"]);
  const std::string kept = command + " --json --chunk 500 --checkpoint folder";
  EXPECT_EQ(folder
                .run("yield --robot rotary_delta --machines 700 --max-position-aligned-mm 0.05 --json --chunk 500 "
                     "--checkpoint folder")
                .exit_code,
            kDone);
  EXPECT_EQ(json_of(folder.run(kept + " --threads 1"))["quantities"], object["quantities"]);
  EXPECT_EQ(folder.run(kept + " --exact").exit_code, kBadInputFile);
  EXPECT_THAT(text.out, AllOf(HasSubstr("exact model: "), HasSubstr("may still fail"), HasSubstr("not known")));
}

TEST_F(Yield, MakesEveryMachineWhenAsked) {
  const json object = json_of(folder.run("yield --robot rotary_delta --machines 260 --exact --json"));
  EXPECT_EQ(object["produced"], 260);
  EXPECT_EQ(object["unseen"], 0.0);
  EXPECT_EQ(object["batch"]["first_order"], false);
}

/// A folder keeps the chunk sizes that it was begun with, whatever more machines would have.
TEST_F(Yield, GoesOnWithTheChunksOfTheFolder) {
  EXPECT_EQ(folder.run(kept_yield(kChunk)).exit_code, kDone);
  expect_undisturbed(folder.run(yield_of(kMachines, "--checkpoint folder")));
  EXPECT_EQ(chunks().size(), static_cast<std::size_t>((kMachines + kChunk - 1) / kChunk));
}

/// Files of a long job stay small: 10 kB a chunk.
TEST_F(Yield, ChunksAreSmall) {
  EXPECT_EQ(folder.run("yield --machines 10000 --interval 1 --checkpoint folder").exit_code, kDone);
  ASSERT_GE(chunks().size(), 5U);
  for (const std::string& name : chunks()) EXPECT_LT(folder.read("folder/" + name).size(), 10'000U) << name;
}

/// So many cores, so long, so much memory, so many files; and no batch.
TEST_F(Yield, PlansWithoutComputing) {
  const ProgramResult text = folder.run("yield --machines 1e9 --plan");
  EXPECT_EQ(text.exit_code, kDone);
  EXPECT_THAT(text.out, AllOf(HasSubstr("1000000000 machines"), HasSubstr("1024 cores"), HasSubstr("MB per process"),
                              HasSubstr("files of at most")));
  const json plan = json_of(folder.run("yield --machines 1e9 --exact --plan --json"));
  EXPECT_EQ(plan["exact_machines"], 1'000'000'000);
  EXPECT_EQ(plan["chunks"], 61'036);
  EXPECT_NEAR(plan["core_seconds"].get<double>() / (1e6 * plan["exact_machine_ms"].get<double>()), 1.0, 1e-6);
  EXPECT_LT(plan["bytes_a_chunk"].get<double>(), 1e6);
  EXPECT_GE(json_of(folder.run("yield --machines 1e6 --plan --json"))["exact_machines"], 4096);
  const json few = json_of(folder.run("yield --machines 100 --plan --json"));
  EXPECT_EQ(few["exact_machines"], 100);
}

TEST_F(Yield, IsResumedAndExtended) {
  EXPECT_EQ(folder.run(kept_yield(2 * kChunk)).exit_code, kDone);
  const auto first = std::filesystem::last_write_time(folder.path() / "folder" / *chunks().begin());
  expect_undisturbed(folder.run(kept_yield(kMachines)));
  expect_undisturbed(folder.run(kept_yield(kMachines, "--threads 1")));
  EXPECT_EQ(std::filesystem::last_write_time(folder.path() / "folder" / *chunks().begin()), first) << "was made again";
  EXPECT_EQ(folder.run(kept_yield(2 * kChunk)).out, folder.run(yield_of(2 * kChunk)).out);
}

// ---- several processes

/// Ranks of MPI take chunks as they come to them and add up what they have: the same bytes as one process, with a
/// folder and without.
class UnderMpi : public Yield {
 protected:
  static bool has_mpi() { return std::filesystem::exists(build_folder() / "bin/paracal-mpi"); }
  std::unique_ptr<RunningProgram> ranks(int count, const std::string& command) const {
    return std::make_unique<RunningProgram>(
        of_huang2016(command), Surroundings{.folder = folder.path(),
                                            .launcher = {"/usr/bin/mpirun", "--allow-run-as-root", "--oversubscribe",
                                                         "-n", std::to_string(count)},
                                            .program = "paracal-mpi"});
  }
};

TEST_F(UnderMpi, IsBuilt) { EXPECT_TRUE(has_mpi()) << "install libopenmpi-dev, or build without these tests"; }

TEST_F(UnderMpi, AnyNumberOfRanksHasTheSameBytes) {
  for (const int count : {1, 2, 4}) {
    SCOPED_TRACE(count);
    expect_undisturbed(ranks(count, yield_of(kMachines, fmt::format("--chunk {}", kChunk)))->result());
  }
  expect_undisturbed(ranks(2, kept_yield(kMachines))->result());
  EXPECT_EQ(chunks().size(), static_cast<std::size_t>((kMachines + kChunk - 1) / kChunk));
  expect_undisturbed(ranks(4, kept_yield(kMachines))->result());
}

/// Rounds of exact machines end at the same one on all ranks.
TEST_F(UnderMpi, RoundsEndAlike) {
  const std::string command = "yield --machines 1000 --interval 0.1 --chunk 100 --json";
  EXPECT_EQ(ranks(3, command)->result().out, folder.run(command).out);
}

/// Other long jobs on ranks, in parts and from a folder: the bytes of one process.
TEST_F(UnderMpi, OtherJobsAreLongToo) {
  for (const std::string command : {"poses --optimal 6 --candidates 60 --starts 5 --json",
                                    "tolerance analyze --model exact --sigma-error 0.1 --max-machines 600 "
                                    "--failure-error 0.9 --json"}) {
    SCOPED_TRACE(command);
    std::filesystem::remove_all(folder.path() / "folder");
    const std::string alone = folder.run(command).out, kept = command + " --checkpoint folder";
    EXPECT_EQ(ranks(2, command)->result().out, alone);
    EXPECT_THAT(folder.run(kept + " --part 2/2").out, HasSubstr("part 2 of 2 is done"));
    const std::size_t half = chunks().size();
    EXPECT_GT(half, 0U);
    EXPECT_EQ(folder.run(kept + " --threads 1").out, alone);
    EXPECT_GT(chunks().size(), half);
    EXPECT_EQ(folder.run("--seed 5 " + kept).exit_code, kWrongUsage);  // options stand behind the command
    EXPECT_EQ(folder.run(kept + " --seed 5").exit_code, kBadInputFile);
  }
  EXPECT_THAT(folder.run("poses --optimal 6 --checkpoint x").err, HasSubstr("--starts"));
  EXPECT_THAT(folder.run("tolerance analyze --part 1/2 --checkpoint x").err, HasSubstr("--model exact"));
}

/// More starts are never worse, and the first one is that of the seed.
TEST_F(Yield, MoreStartsFindBetterPoses) {
  const auto value = [&](const std::string& options) {
    return json_of(folder.run("poses --optimal 6 --candidates 60 --json" + options)).at("value").get<double>();
  };
  const double one = value(""), second = value(" --seed 2"), two = value(" --starts 2"), eight = value(" --starts 8");
  EXPECT_EQ(two, std::min(one, second));
  EXPECT_LE(eight, two);
  EXPECT_LT(eight, std::max(one, second));
}

/// mpirun ends all ranks when one is killed; the same command again makes what is missing.
TEST_F(UnderMpi, AKilledRankCostsItsChunk) {
  const std::string command = kept_yield(4 * kMachines);
  const auto killed = ranks(2, command);
  wait_for_chunks(2);
  // One of this folder: other tests have ranks of their own.
  const ProgramResult kill = run_program(
      {},
      {.folder = folder.path(),
       .launcher = {"/bin/sh", "-c",
                    "for p in $(pgrep -x paracal-mpi); do [ \"$(readlink /proc/$p/cwd)\" = \"$PWD\" ] && kill -9 $p && "
                    "exit 0; done; exit 1"}});
  EXPECT_EQ(kill.exit_code, 0);
  (void)killed->result();
  EXPECT_EQ(ranks(2, command)->result().out, folder.run(yield_of(4 * kMachines)).out);
}

/// What is wrong is said once, and no rank waits for one that has gone.
TEST_F(UnderMpi, ComplaintsEndAllRanks) {
  const ProgramResult usage = ranks(2, "yield --machines 0")->result();
  EXPECT_EQ(usage.exit_code, kWrongUsage);
  EXPECT_EQ(usage.err.find("--machines"), usage.err.rfind("--machines")) << usage.err;
  for (int round = 0; round < 3; ++round) {
    const ProgramResult missing = ranks(3, "yield --machines 2 --tolerances missing.toml")->result();
    EXPECT_EQ(missing.exit_code, kBadInputFile);
    EXPECT_EQ(missing.err.find("missing.toml: "), missing.err.rfind("missing.toml: ")) << missing.err;
    EXPECT_NE(missing.err.find("missing.toml: "), std::string::npos);
  }
  EXPECT_EQ(ranks(2, "robot")->result().exit_code, kWrongUsage);  // computes nothing that ranks could share
}

/// An array of jobs: each computes its part; the last one, or the command without --part, has the result.
TEST_F(Yield, PartsAreComputedByThemselves) {
  const ProgramResult first = folder.run(kept_yield(kMachines, "--part 1/2"));
  EXPECT_EQ(first.exit_code, kDone);
  EXPECT_EQ(json::parse(first.out)["partial"], true);
  const std::size_t half = chunks().size();
  EXPECT_EQ(half, static_cast<std::size_t>((kMachines + kChunk - 1) / kChunk + 1) / 2);
  std::filesystem::copy(folder.path() / "folder", folder.path() / "copy");
  const ProgramResult text =
      folder.run("yield --exact --machines 9 --max-position-aligned-mm 0.05 --seed 3 --checkpoint copy --part 1/2");
  EXPECT_THAT(text.out, AllOf(HasSubstr("part 1 of 2 is done"), HasSubstr("without --part")));
  expect_undisturbed(folder.run(kept_yield(kMachines, "--part 2/2")));
  expect_undisturbed(folder.run(kept_yield(kMachines)));
  for (const char* part : {"0/2", "3/2", "1", "1/0", "a/b", "1/2/3", ""}) {
    EXPECT_EQ(folder.run(yield_of(2, fmt::format("--checkpoint x --part \"{}\"", part))).exit_code, kWrongUsage)
        << part;
  }
  EXPECT_THAT(folder.run(yield_of(2, "--part 1/2")).err, HasSubstr("--checkpoint"));
}

TEST_F(Yield, AKilledRunIsResumed) {
  const auto killed = start(kept_yield(kEndless));
  wait_for_chunks(2);
  killed->send(SIGKILL);
  EXPECT_EQ(killed->result().exit_code, -SIGKILL);
  const int machines = kChunk * (static_cast<int>(chunks().size()) + 2) + 1;
  EXPECT_EQ(folder.run(kept_yield(machines)).out, folder.run(yield_of(machines)).out);
}

// ---- interrupted

/// A disk that fills up or a folder that goes away: told as what cannot be written, not a crash.
TEST_F(Yield, AFolderThatVanishesIsTold) {
  const auto running = start(kept_yield(kEndless, "--threads 1 --robot huang2016"));
  wait_for_chunks(1);
  std::filesystem::rename(folder.path() / "folder", folder.path() / "elsewhere");
  const ProgramResult result = running->result();
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, AllOf(HasSubstr("folder"), HasSubstr("cannot be written")));
}

TEST_F(Yield, InterruptedItSaysThatItIsPartial) {
  for (const int signal : {SIGINT, SIGTERM}) {
    SCOPED_TRACE(signal);
    std::filesystem::remove_all(folder.path() / "folder");
    const auto program = start(kept_yield(kEndless));
    wait_for_chunks(2);
    program->send(signal);
    const json object = json_of(program->result(), kVerdictIsNo);
    EXPECT_EQ(object["partial"], true);
    EXPECT_EQ(object["machines_asked"], kEndless);
    const int made = object["machines"];
    EXPECT_GE(made, 2 * kChunk);
    EXPECT_EQ(made % kChunk, 0);
    const json whole = json_of(folder.run(yield_of(made)));
    EXPECT_EQ(object["quantities"], whole["quantities"]);
  }
}

TEST_F(Yield, InterruptedAtOnceItHasNothing) {
  const auto program = start(yield_of(kEndless, "--checkpoint folder --chunk 1000000"));
  wait_for("job.json");
  program->send(SIGINT);
  const json object = json_of(program->result(), kVerdictIsNo);
  EXPECT_EQ(object["partial"], true);
  EXPECT_EQ(object["machines"], 0);
  EXPECT_TRUE(object["yield"]["value"].is_null());
}

/// Machines to first order alone tell nothing, and no nan is printed.
TEST_F(Yield, InterruptedBeforeTheFirstExactMachineItKnowsNothing) {
  for (const bool as_json : {true, false}) {
    std::filesystem::remove_all(folder.path() / "folder");
    const auto program = start(fmt::format("yield --machines {} --max-tilt-rad 0.001 --checkpoint folder{}", kEndless,
                                           as_json ? " --json" : ""));
    wait_for_chunks(1);
    program->send(SIGINT);
    const ProgramResult result = program->result();
    EXPECT_EQ(result.exit_code, kVerdictIsNo);
    if (!as_json) {
      EXPECT_THAT(result.out, AllOf(HasSubstr("no result yet"), Not(HasSubstr("nan"))));
      continue;
    }
    const json object = json::parse(result.out);
    EXPECT_EQ(object["produced"], 0);
    EXPECT_EQ(object["passed"], 0);
    EXPECT_TRUE(object["yield"]["value"].is_null());
    EXPECT_EQ(object["yield"]["low"], 0.0);
    EXPECT_EQ(object["yield"]["high"], 1.0);
  }
}

// ---- progress

TEST_F(Yield, ShowsItsProgressOnATerminalOnly) {
  const Terminal terminal;
  const ProgramResult result = run_program(of_huang2016(yield_of(kMachines, fmt::format("--chunk {}", kChunk))),
                                           {.folder = folder.path(), .standard_error = terminal.path()});
  EXPECT_TRUE(result.out == undisturbed());
  const std::string shown = terminal.written();
  EXPECT_THAT(shown, AllOf(HasSubstr(fmt::format("1 of {} chunks", (kMachines + kChunk - 1) / kChunk)),
                           HasSubstr("per second"), HasSubstr("left"), Not(HasSubstr("\n"))));
  EXPECT_TRUE(shown.ends_with("\r\033[K")) << "is not cleared";
}

// ---- folders and numbers that cannot be meant

TEST_F(Yield, ADamagedChunkIsNamedAndMadeAgain) {
  const std::string command = kept_yield(kMachines);
  expect_undisturbed(folder.run(command));
  const std::string name = "folder/" + *std::next(chunks().begin());
  const std::string good = folder.read(name), other_chunk = folder.read("folder/" + *chunks().begin());
  std::string other_digit = jobs::gunzip(good);
  const std::size_t digit = other_digit.find("\"passed\":") + 9;
  other_digit[digit] = other_digit[digit] == '1' ? '2' : '1';
  std::string other_bit = good;
  other_bit[good.size() / 2] ^= 1;
  for (const std::string& damaged :
       {good.substr(0, good.size() / 2), std::string(), std::string("[]"), other_bit, jobs::gzip(other_digit),
        jobs::gzip("[]"), other_chunk, jobs::gzip(std::string(100'000'000, ' '))}) {
    folder.write(name, damaged);
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kDone);
    EXPECT_TRUE(result.out == undisturbed());
    EXPECT_THAT(result.err, AllOf(HasSubstr(name), HasSubstr("computed again")));
    EXPECT_EQ(folder.read(name), good);
  }
}

/// Whatever gave it a hash that fits: what it says must add up to its machines.
TEST_F(Yield, AChunkThatDoesNotAddUpIsMadeAgain) {
  const std::string command = kept_yield(kMachines);
  expect_undisturbed(folder.run(command));
  const std::string name = "folder/" + *chunks().begin();
  const std::string good = folder.read(name);
  using Json = nlohmann::ordered_json;
  for (const auto& change : std::vector<std::function<void(Json&)>>{
           [](Json& tally) { tally["fates"][0] = kChunk + 1; }, [](Json& tally) { tally["fates"][1] = -1; },
           [](Json& tally) { tally["passed"] = kChunk + 1; }, [](Json& tally) { tally["passed"] = 1e22; },
           [](Json& tally) { tally["after"]["tilt"] = Json::array(); },
           [](Json& tally) { tally["before"]["distance"].push_back(1); },
           [](Json& tally) { tally["before"]["distance"][0] = std::uint64_t{1} << 32; },
           [](Json& tally) { tally["before"]["distance"][0] = 16383; }, [](Json& tally) { tally = "tally"; }}) {
    Json chunk = Json::parse(jobs::gunzip(good));
    change(chunk["content"]);
    chunk["sha256"] = io::sha256(chunk["content"].dump());
    folder.write(name, jobs::gzip(chunk.dump()));
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kDone) << chunk["content"];
    EXPECT_TRUE(result.out == undisturbed()) << chunk["content"];
    EXPECT_THAT(result.err, AllOf(HasSubstr(name), HasSubstr("computed again")));
    EXPECT_EQ(folder.read(name), good);
  }
}

TEST_F(Yield, RefusesTheFolderOfAnotherBatch) {
  EXPECT_EQ(folder.run(kept_yield(kChunk)).exit_code, kDone);
  const auto expect_refused = [&](const std::string& command, const std::string& expected) {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, kBadInputFile) << command;
    EXPECT_THAT(result.out, IsEmpty());
    EXPECT_THAT(result.err, AllOf(HasSubstr("folder/job.json"), HasSubstr(expected)));
  };
  const std::string kept = " --checkpoint folder --chunk " + std::to_string(kChunk);
  const std::string machines = "yield --exact --machines 2 --max-position-aligned-mm 0.05";
  expect_refused(machines + " --seed 4" + kept, "expected seed 4, got 3");
  expect_refused(machines + " --seed 3 --checkpoint folder --chunk 3", "expected chunks of 3 machines, got");
  expect_refused(machines + " --seed 3 --noise-mm 0.02" + kept, "expected instrument/noise_mm 0.02, got 0.017");
  expect_refused("yield --exact --machines 2 --seed 3" + kept, "limits/volumetric_aligned_mm");
  expect_refused(machines + " --seed 3 --robot rotary_delta" + kept, "expected robot/name \"rotary_delta\"");
  folder.write("folder/job.json", "[]");
  expect_refused(kept_yield(kChunk), "expected job.json of a paracal command");
  folder.write("folder/job.json", "{");
  expect_refused(kept_yield(kChunk), "job.json:1: expected JSON");
}

/// A size of 0 would divide by it; job.json is a file that anybody can edit.
TEST_F(Yield, SizesOfChunksAreWholeNumbers) {
  EXPECT_EQ(folder.run(kept_yield(kChunk)).exit_code, kDone);
  const std::string good = folder.read("folder/job.json");
  const auto json = nlohmann::ordered_json::parse(good);
  for (const std::string value : {"0", "\"x\"", "null", "-1", "1.5", "1e30", "[]"}) {
    auto changed = json;
    changed["chunks"]["exact"] = nlohmann::ordered_json::parse(value);
    folder.write("folder/job.json", changed.dump(2));
    const ProgramResult result = folder.run(kept_yield(kChunk));
    EXPECT_EQ(result.exit_code, kBadInputFile) << value;
    EXPECT_THAT(result.err, testing::ContainsRegex("job.json:[0-9]+: exact: expected a whole number from 1")) << value;
  }
  for (const auto& change : std::vector<std::function<void(nlohmann::ordered_json&)>>{
           [](auto& job) { job.erase("chunks"); }, [](auto& job) { job["chunks"] = 3; },
           [](auto& job) { job["chunks"]["more"] = 3; }, [](auto& job) { job["chunks"].erase("exact"); }}) {
    auto changed = json;
    change(changed);
    folder.write("folder/job.json", changed.dump(2));
    const ProgramResult result = folder.run(kept_yield(kChunk));
    EXPECT_EQ(result.exit_code, kBadInputFile);
    EXPECT_THAT(result.err, HasSubstr("job.json"));
  }
  folder.write("folder/job.json", good);
  expect_undisturbed(folder.run(kept_yield(kMachines)));
}

/// What stands in the place of a chunk is neither waited for, read without end, nor written through.
TEST_F(Yield, AChunkIsARegularFile) {
  EXPECT_EQ(folder.run(kept_yield(kMachines)).exit_code, kDone);
  const std::filesystem::path chunk = folder.path() / "folder" / *std::next(chunks().begin());
  const auto expect_refused = [&](const std::string& complaint) {
    const ProgramResult result = folder.run(kept_yield(kMachines));
    EXPECT_EQ(result.exit_code, kBadInputFile) << complaint;
    EXPECT_THAT(result.err, AllOf(HasSubstr(chunk.filename().string() + ": "), HasSubstr(complaint)));
    std::filesystem::remove(chunk);
  };
  std::filesystem::remove(chunk);
  ASSERT_EQ(mkfifo(chunk.c_str(), 0600), 0);
  expect_refused("expected a regular file, got a pipe or device");
  std::filesystem::create_symlink("/dev/zero", chunk);
  expect_refused("expected a regular file, got a pipe or device");
  std::filesystem::create_symlink(folder.path() / "elsewhere", chunk);
  expect_refused("No such file");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "elsewhere"));
  expect_undisturbed(folder.run(kept_yield(kMachines)));
}

/// Of a stage whose chunks are single results: numbers of another type, counts that no such chunk has.
TEST_F(Yield, AResultOfAnotherTypeIsMadeAgain) {
  using Json = nlohmann::ordered_json;
  struct Case {
    std::string command;
    std::vector<std::function<void(Json&)>> changes;
  };
  for (const Case& one : std::vector<Case>{
           {"poses --optimal 4 --candidates 20 --starts 2 --json",
            {[](Json& result) { result = "x"; }, [](Json& result) { result = nullptr; },
             [](Json& result) { result = 1; }}},
           {"tolerance analyze --model exact --max-machines 64 --json",
            {[](Json& result) { result["passed_all"] = -1; }, [](Json& result) { result["not_closed"] = 0.5; },
             [](Json& result) { result["components"][0] = "x"; }, [](Json& result) { result["squares"] = 3; },
             [](Json& result) { result["passed"][0] = 1000; }, [](Json& result) { result["largest"][0][0][0] = 99999; },
             [](Json& result) { result["largest"][0][0][1] = "x"; },
             [](Json& result) { result["largest"][0] = Json::object(); },
             [](Json& result) { result["largest"][0].erase(0); }, [](Json& result) { result["passed"].push_back(0); },
             [](Json& result) { result = Json::array(); }}}}) {
    const ProgramResult alone = folder.run(one.command);
    const std::string kept = one.command + " --checkpoint folder";
    EXPECT_EQ(folder.run(kept).out, alone.out) << alone.err;
    const std::string name = "folder/" + *chunks().begin(), good = folder.read(name);
    for (const auto& change : one.changes) {
      Json chunk = Json::parse(jobs::gunzip(good));
      change(chunk["content"].front());
      chunk["sha256"] = io::sha256(chunk["content"].dump());
      folder.write(name, jobs::gzip(chunk.dump()));
      const ProgramResult result = folder.run(kept);
      EXPECT_TRUE(result.out == alone.out) << chunk["content"];
      EXPECT_THAT(result.err,
                  AllOf(HasSubstr(name), HasSubstr("expected the result of chunk"), Not(HasSubstr("[json."))))
          << chunk["content"];
      EXPECT_EQ(folder.read(name), good);
    }
    std::filesystem::remove_all(folder.path() / "folder");
  }
}

/// Another compiler, or another commit of the same version, may round otherwise.
TEST_F(Yield, RefusesTheFolderOfAnotherBuild) {
  EXPECT_EQ(folder.run(kept_yield(kChunk)).exit_code, kDone);
  const std::string name = "folder/" + *chunks().begin(), chunk = folder.read(name);
  auto header = nlohmann::ordered_json::parse(folder.read("folder/job.json"));
  ASSERT_TRUE(run_program({"--version"}).out.ends_with("(" + header.at("build").get<std::string>() + ")\n"));
  header["build"] = "another";
  folder.write("folder/job.json", header.dump(2) + "\n");
  const ProgramResult result = folder.run(kept_yield(2 * kChunk));
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, AllOf(HasSubstr("folder/job.json"), HasSubstr("expected build \""),
                                HasSubstr("got \"another\""), HasSubstr("belongs to another command")));
  EXPECT_EQ(chunks().size(), 1u);
  EXPECT_EQ(folder.read(name), chunk);
}

TEST_F(Yield, RefusesAChunkOfAnotherBatch) {
  EXPECT_EQ(folder.run(kept_yield(kChunk)).exit_code, kDone);
  const std::string name = *chunks().begin();
  EXPECT_EQ(
      folder.run(fmt::format("yield --exact --machines {0} --chunk {0} --seed 9 --checkpoint other", kChunk)).exit_code,
      kDone);
  folder.write("folder/" + name, folder.read("other/" + name));
  const ProgramResult result = folder.run(kept_yield(kChunk));
  EXPECT_EQ(result.exit_code, kBadInputFile);
  EXPECT_THAT(result.err, AllOf(HasSubstr("folder/" + name), HasSubstr("expected a chunk of job"), HasSubstr("got")));
}

TEST_F(Yield, RefusesAFolderThatCannotBeWritten) {
  folder.write("file", "");
  for (const char* name : {"file", "file/below", "/proc/nowhere"}) {
    const ProgramResult result = folder.run(fmt::format("yield --machines 2 --checkpoint {}", name));
    EXPECT_EQ(result.exit_code, kWrongUsage) << name;
    EXPECT_THAT(result.err, AllOf(HasSubstr(name), HasSubstr("cannot be written")));
    EXPECT_THAT(result.out, IsEmpty());
  }
}

/// As "$FOLDER" is where none was set: nothing would be kept of a long job, or a default would count instead of a file.
TEST_F(Yield, RefusesEmptyNames) {
  for (const char* option : {"--checkpoint", "--tolerances", "--poses", "--robot"}) {
    const ProgramResult result = folder.run(std::vector<std::string>{"yield", "--machines", "2", option, ""});
    EXPECT_EQ(result.exit_code, kWrongUsage) << option;
    EXPECT_THAT(result.err, HasSubstr(fmt::format("{}: expected a value, got \"\"", option)));
  }
}

TEST_F(Yield, RefusesNumbersThatCannotBeMeant) {
  for (const char* options : {"",
                              "--machines 0",
                              "--machines -1",
                              "--machines 1.5",
                              "--machines nan",
                              "--machines 1e99",
                              "--machines 2 --chunk 0",
                              "--machines 2 --chunk 99999999",
                              "--machines 2 --noise-mm -1",
                              "--machines 2 --noise-mm nan",
                              "--machines 2 --noise-mm inf",
                              "--machines 2 --confidence 1",
                              "--machines 2 --confidence nan",
                              "--machines 2 --min-yield 1.1",
                              "--machines 2 --max-tilt-rad 0",
                              "--machines 2 --max-distance-mm nan",
                              "--machines 2 --repeats 0",
                              "--machines 2 --method guess",
                              "--machines 2 --rotation some",
                              "--machines 2 --second 1,2",
                              "--machines 2 --second nan,0,0",
                              "--machines 2 --tracker-um 1,2,3",
                              "--machines 2 --threads -1"}) {
    SCOPED_TRACE(options);
    const ProgramResult result = folder.run(std::string("yield ") + options);
    EXPECT_EQ(result.exit_code, kWrongUsage);
    EXPECT_THAT(result.err, Not(IsEmpty()));
    EXPECT_THAT(result.out, IsEmpty());
  }
}

TEST_F(Yield, RefusesFilesThatCannotBeMeant) {
  folder.write("none.toml", "rod_mean_mm = 0\nothers = \"exact\"\n");
  folder.write("far.csv", "pose,x_mm,y_mm,z_mm,phi_deg\nhome,0,0,-888,0\nfar,5000,0,-888,0\n");
  EXPECT_EQ(folder.run("yield --machines 2 --tolerances none.toml").exit_code, kBadInputFile);
  const std::string robot = run_program(of_huang2016("robot")).out;
  folder.write("perfect.toml",
               robot.substr(0, robot.find("[tolerances]")) + "[tolerances]\nrod_mean_mm = 0\nothers = \"exact\"\n");
  EXPECT_EQ(folder.run("yield --machines 2 --robot perfect.toml").exit_code, kBadInputFile);
  EXPECT_EQ(folder.run("yield --machines 2 --tolerances missing.toml").exit_code, kBadInputFile);
  EXPECT_EQ(folder.run("yield --machines 2 --poses far.csv").exit_code, kMathematicsSaysNo);
}

}  // namespace
}  // namespace paracal::test::yield_test
