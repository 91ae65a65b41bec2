// Pages as files: what they hold, and what comes of bad wishes. How they look is for web/tests.

#include "json_checks.hpp"
#include "support/places.hpp"

namespace paracal::test::report_test {
namespace {

using nlohmann::json;
using testing::AllOf, testing::ElementsAre, testing::HasSubstr, testing::IsEmpty, testing::Not;

const std::string kData = source_folder() / "data/huang2016";

class ReportCommands : public testing::Test {
 protected:
  void SetUp() override {
    distances = "--measurements " + kData + "/distances.csv --poses " + kData + "/poses.csv";
    folder.make({"calibrate " + distances + " --out calibration.json --report calibrate.html"});
  }
  json page_of(const std::string& command, const std::string& file, int exit_code = kDone) const {
    const ProgramResult result = folder.run(command);
    EXPECT_EQ(result.exit_code, exit_code) << command << ": " << result.err;
    return data_in(folder.read(file));
  }

  const TemporaryFolder folder;
  std::string distances;
};

TEST_F(ReportCommands, ThePageStandsAlone) {
  const std::string html = folder.read("calibrate.html");
  EXPECT_LT(html.size(), 2'500'000u);
  EXPECT_THAT(html, AllOf(HasSubstr("default-src 'none'"), HasSubstr("; base-uri 'none'; form-action 'none'\">"),
                          Not(HasSubstr("<link")), Not(HasSubstr(" src=")), Not(HasSubstr("@import"))));
}

TEST_F(ReportCommands, CalibrateShowsWhatItPrints) {
  const json data = data_in(folder.read("calibrate.html"));
  EXPECT_EQ(data.at("results").at("calibration"), json::parse(folder.read("calibration.json")));
  EXPECT_TRUE(has_keys(data.at("figures"), "scene error_map observability"));
  EXPECT_TRUE(has_keys(data, "format program date command kind robot inputs"));
  EXPECT_EQ(data.at("inputs").size(), 2u);
  EXPECT_THAT(data.at("command").get<std::string>(), HasSubstr("--report calibrate.html"));
}

/// A page goes to customers, who need not know the folders of its author.
TEST_F(ReportCommands, FilesHaveNoFolders) {
  const std::string place = folder.path().string() + "/";
  const json data =
      page_of("report --calibration " + place + "calibration.json --out=" + place + "report.html", "report.html");
  EXPECT_EQ(data.at("inputs")[0].at("file"), "calibration.json");
  EXPECT_THAT(data.at("command").get<std::string>(), HasSubstr("--calibration calibration.json --out=report.html"));
  EXPECT_THAT(folder.read("report.html"), Not(HasSubstr(place)));
}

TEST_F(ReportCommands, ReportOfACalibrationAlone) {
  const json data = page_of("report --calibration calibration.json --out report.html", "report.html");
  EXPECT_EQ(data.at("results").at("calibration"), json::parse(folder.read("calibration.json")));
  EXPECT_FALSE(data.at("figures").at("scene").at("measured"));
  EXPECT_EQ(data.at("figures").at("scene").at("poses").size(), 121u);
}

TEST_F(ReportCommands, ReportWithTheDistancesItCameFrom) {
  const json data = page_of("report --calibration calibration.json " + distances + " --out report.html", "report.html");
  EXPECT_EQ(data.at("figures").at("scene").at("poses").size(), 7u);
  EXPECT_FALSE(data.at("results").contains("validation"));
  EXPECT_EQ(data.at("inputs").size(), 3u);
}

TEST_F(ReportCommands, ReportAndValidateShowTheSameValidation) {
  ASSERT_EQ(folder.run("poses --stage fine --out poses.csv").exit_code, kDone);
  ASSERT_EQ(folder.run("simulate --errors " + kData + "/offsets.toml --poses poses.csv --noise-mm 0.01 --out m.csv")
                .exit_code,
            kDone);
  const std::string check = " --calibration calibration.json --measurements m.csv --limit-mm 3";
  const json validated = page_of("validate --report validate.html" + check, "validate.html");
  const json reported = page_of("report --out report.html" + check, "report.html");
  EXPECT_EQ(reported.at("results").at("validation"), validated.at("results").at("validation"));
  EXPECT_EQ(reported.at("figures").at("scene"), validated.at("figures").at("scene"));
  EXPECT_TRUE(validated.at("figures").at("scene").at("measured"));
  const json refused =
      page_of("report --out report.html --calibration calibration.json --measurements m.csv --limit-mm 0.001",
              "report.html", kVerdictIsNo);
  EXPECT_FALSE(refused.at("results").at("validation").at("accepted"));
}

TEST_F(ReportCommands, JsonIsTheDataOfThePage) {
  const json printed = json_of(folder.run("report --calibration calibration.json --json"));
  EXPECT_EQ(printed.at("format"), "paracal report 1");
}

TEST_F(ReportCommands, OtherCommandsShowWhatTheyPrint) {
  const json sensitivity = page_of("sensitivity --out s.json --json --report s.html", "s.html");
  EXPECT_EQ(sensitivity.at("results").at("sensitivity"), json::parse(folder.read("s.json")));
  const json analysis =
      page_of("tolerance analyze --max-machines 5000 --sigma-error 0.1 --out a.json --json --report a.html", "a.html");
  EXPECT_EQ(analysis.at("results").at("analysis"), json::parse(folder.read("a.json")));
  EXPECT_EQ(analysis.at("figures").at("largest_on_a_machine").at(0).at("machines").at("total"),
            analysis.at("results").at("analysis").at("machines"));
  const json allocation = page_of("tolerance allocate --out t.json --json --report t.html", "t.html");
  EXPECT_EQ(allocation.at("results").at("allocation"), json::parse(folder.read("t.json")));
  const json batch = page_of("yield --machines 5 --out y.json --json --report y.html", "y.html");
  EXPECT_EQ(batch.at("results").at("yield"), json::parse(folder.read("y.json")));
  for (const json& one : batch.at("figures").at("largest_of_a_machine")) EXPECT_EQ(one.at("after").at("total"), 5);
}

TEST_F(ReportCommands, AMachineThatWasNotFoundIsNotPredicted) {
  folder.write("two.csv", "from,to,distance_mm\nP0,P1,501.0\nP0,P2,502.0\n");
  const json data = page_of("calibrate --measurements two.csv --poses " + kData + "/poses.csv --report no.html",
                            "no.html", kVerdictIsNo);
  EXPECT_FALSE(data.at("results").at("calibration").at("accepted"));
  EXPECT_FALSE(data.at("figures").contains("error_map"));
  EXPECT_FALSE(data.at("figures").contains("scene"));
}

TEST_F(ReportCommands, APageThatCannotBeWrittenIsWrongUsage) {
  const ProgramResult result = folder.run("calibrate " + distances + " --report nowhere/page.html");
  EXPECT_EQ(result.exit_code, kWrongUsage);
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_THAT(result.err, HasSubstr("nowhere/page.html"));
}

TEST_F(ReportCommands, TheCommandIsALineForAShell) {
  folder.write("it's <b>.json", folder.read("calibration.json"));
  ASSERT_EQ(folder.run({"report", "--calibration", "it's <b>.json", "--out", "report.html"}).exit_code, kDone);
  EXPECT_EQ(data_in(folder.read("report.html")).at("command"),
            R"(paracal report --calibration 'it'\''s <b>.json' --out report.html)");
}

}  // namespace
}  // namespace paracal::test::report_test
