// The 27 nonlinear regression problems of the NIST Statistical Reference Datasets, data/nist-strd: certified parameters
// and standard deviations, each to be found from both certified starts. None of them is a robot: what passes here is
// the least-squares core on its own.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <ostream>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <unsupported/Eigen/AutoDiff>
#include <vector>

#include "paracal/numerics/least_squares.hpp"
#include "support/places.hpp"

namespace paracal::nist_test {
namespace {

constexpr int kMostParameters = 9;

/// A number that carries its derivatives by b1, b2, ...
using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostParameters, 1>>;

/// b(1), b(2), ... as the files count them.
class Parameters {
 public:
  explicit Parameters(const Eigen::VectorXd& values) {
    for (Eigen::Index k = 0; k < values.size(); ++k) duals_.emplace_back(values(k), values.size(), k);
  }
  const Dual& operator()(std::size_t k) const { return duals_[k - 1]; }

 private:
  std::vector<Dual> duals_;
};

Dual power(const Dual& base, const Dual& exponent) { return exp(exponent * log(base)); }

Dual arctan(const Dual& z) { return {std::atan(z.value()), z.derivatives() / (1.0 + z.value() * z.value())}; }

Dual bennett5(const Parameters& b, double x) { return b(1) * power(b(2) + x, -1.0 / b(3)); }

Dual saturation(const Parameters& b, double x) { return b(1) * (1.0 - exp(-b(2) * x)); }

Dual chwirut(const Parameters& b, double x) { return exp(-b(1) * x) / (b(2) + b(3) * x); }

Dual dan_wood(const Parameters& b, double x) { return b(1) * exp(b(2) * std::log(x)); }

Dual cycle(const Dual& cosine, const Dual& sine, const Dual& period, double x) {
  const Dual angle = 2.0 * std::numbers::pi * x / period;
  return cosine * cos(angle) + sine * sin(angle);
}

Dual enso(const Parameters& b, double x) {
  const double year = 2.0 * std::numbers::pi * x / 12.0;
  const Dual annual = b(2) * std::cos(year) + b(3) * std::sin(year);
  return b(1) + annual + cycle(b(5), b(6), b(4), x) + cycle(b(8), b(9), b(7), x);
}

Dual bell(const Dual& height, const Dual& centre, const Dual& width, double x) {
  const Dual z = (x - centre) / width;
  return height * exp(-z * z);
}

Dual eckerle4(const Parameters& b, double x) {
  const Dual z = (x - b(3)) / b(2);
  return b(1) / b(2) * exp(-0.5 * z * z);
}

Dual gauss(const Parameters& b, double x) {
  return b(1) * exp(-b(2) * x) + bell(b(3), b(4), b(5), x) + bell(b(6), b(7), b(8), x);
}

Dual cubic_ratio(const Parameters& b, double x) {
  return (b(1) + x * (b(2) + x * (b(3) + x * b(4)))) / (1.0 + x * (b(5) + x * (b(6) + x * b(7))));
}

Dual kirby2(const Parameters& b, double x) { return (b(1) + x * (b(2) + x * b(3))) / (1.0 + x * (b(4) + x * b(5))); }

Dual lanczos(const Parameters& b, double x) {
  return b(1) * exp(-b(2) * x) + b(3) * exp(-b(4) * x) + b(5) * exp(-b(6) * x);
}

Dual mgh09(const Parameters& b, double x) { return b(1) * (x * x + x * b(2)) / (x * x + x * b(3) + b(4)); }

Dual mgh10(const Parameters& b, double x) { return b(1) * exp(b(2) / (x + b(3))); }

Dual mgh17(const Parameters& b, double x) { return b(1) + b(2) * exp(-x * b(4)) + b(3) * exp(-x * b(5)); }

Dual misra1b(const Parameters& b, double x) {
  const Dual z = 1.0 + b(2) * x / 2.0;
  return b(1) * (1.0 - 1.0 / (z * z));
}

Dual misra1c(const Parameters& b, double x) { return b(1) * (1.0 - 1.0 / sqrt(1.0 + 2.0 * b(2) * x)); }

Dual misra1d(const Parameters& b, double x) { return b(1) * b(2) * x / (1.0 + b(2) * x); }

Dual rat42(const Parameters& b, double x) { return b(1) / (1.0 + exp(b(2) - b(3) * x)); }

Dual rat43(const Parameters& b, double x) { return b(1) / power(1.0 + exp(b(2) - b(3) * x), 1.0 / b(4)); }

Dual roszman1(const Parameters& b, double x) { return b(1) - b(2) * x - arctan(b(3) / (x - b(4))) / std::numbers::pi; }

/// y and its predictors; only Nelson has a second one.
struct Observation {
  double y = 0.0;
  double x1 = 0.0;
  double x2 = 0.0;
};

using Residual = Dual (*)(const Parameters& b, const Observation& seen);

template <Dual (*Model)(const Parameters&, double)>
Dual residual(const Parameters& b, const Observation& seen) {
  return Model(b, seen.x1) - seen.y;
}

Dual nelson(const Parameters& b, const Observation& seen) {
  return b(1) - b(2) * seen.x1 * exp(-b(3) * seen.x2) - std::log(seen.y);
}

struct Problem {
  const char* name;
  Residual residual;
};

void PrintTo(const Problem& problem, std::ostream* out) { *out << problem.name; }

constexpr std::array<Problem, 27> kProblems{{
    {"Bennett5", residual<bennett5>},
    {"BoxBOD", residual<saturation>},
    {"Chwirut1", residual<chwirut>},
    {"Chwirut2", residual<chwirut>},
    {"DanWood", residual<dan_wood>},
    {"ENSO", residual<enso>},
    {"Eckerle4", residual<eckerle4>},
    {"Gauss1", residual<gauss>},
    {"Gauss2", residual<gauss>},
    {"Gauss3", residual<gauss>},
    {"Hahn1", residual<cubic_ratio>},
    {"Kirby2", residual<kirby2>},
    {"Lanczos1", residual<lanczos>},
    {"Lanczos2", residual<lanczos>},
    {"Lanczos3", residual<lanczos>},
    {"MGH09", residual<mgh09>},
    {"MGH10", residual<mgh10>},
    {"MGH17", residual<mgh17>},
    {"Misra1a", residual<saturation>},
    {"Misra1b", residual<misra1b>},
    {"Misra1c", residual<misra1c>},
    {"Misra1d", residual<misra1d>},
    {"Nelson", nelson},
    {"Rat42", residual<rat42>},
    {"Rat43", residual<rat43>},
    {"Roszman1", residual<roszman1>},
    {"Thurber", residual<cubic_ratio>},
}};

/// What a file says of one parameter, in the order of its columns.
struct CertifiedParameter {
  std::array<double, 2> start{};
  double value = 0.0;
  double deviation = 0.0;
};

struct Dataset {
  std::vector<CertifiedParameter> parameters;
  std::vector<Observation> observations;
  std::size_t observation_count = 0;  ///< as the file's head says

  Eigen::VectorXd start(std::size_t which) const {
    Eigen::VectorXd values(parameters.size());
    std::ranges::transform(parameters, values.begin(), [which](const auto& b) { return b.start[which]; });
    return values;
  }
};

/// "b1 = start 1, start 2, certified value, certified standard deviation".
void read_parameter(const std::string& line, Dataset& data) {
  std::istringstream words(line);
  std::string name, equals;
  CertifiedParameter parameter;
  if (words >> name >> equals && name.front() == 'b' && equals == "=" && words >> parameter.start[0] &&
      words >> parameter.start[1] >> parameter.value >> parameter.deviation)
    data.parameters.push_back(parameter);
}

void read_observation(const std::string& line, Dataset& data) {
  std::istringstream words(line);
  Observation seen;
  if (!(words >> seen.y >> seen.x1)) return;
  words >> seen.x2;
  data.observations.push_back(seen);
}

/// The observations follow the last line that begins with "Data:".
Dataset read_dataset(const std::string& name) {
  Dataset data;
  std::ifstream file(test::source_folder() / "data/nist-strd" / (name + ".dat"));
  const std::string count = "Number of Observations:";
  for (std::string line; std::getline(file, line);) {
    read_parameter(line, data);
    read_observation(line, data);
    if (line.starts_with("Data:")) data.observations.clear();
    if (line.starts_with(count)) data.observation_count = std::stoul(line.substr(count.size()));
  }
  return data;
}

double largest_response(const Dataset& data) {
  double largest = 0.0;
  for (const Observation& seen : data.observations) largest = std::max(largest, std::abs(seen.y));
  return largest;
}

/// Rows [dr/db | r] of all observations in units of the largest response, so that one step tolerance suits all
/// problems.
RowModel row_model(const Problem& problem, const Dataset& data) {
  const double unit = largest_response(data);
  return [&problem, &data, unit](const Eigen::VectorXd& parameters, InformationRoot& rows) {
    const Parameters b(parameters);
    Eigen::MatrixXd block(data.observations.size(), parameters.size() + 1);
    for (Eigen::Index k = 0; k < block.rows(); ++k) {
      const Dual r = problem.residual(b, data.observations[static_cast<std::size_t>(k)]);
      block.row(k) << r.derivatives().transpose(), r.value();
    }
    block /= unit;
    rows.add(block);
    return block.allFinite();
  };
}

/// Decimal digits that two numbers share: the log relative error of the NIST tests, at most what the files certify.
double digits(double value, double certified) {
  constexpr double kCertified = 1e-11;
  const double error = std::abs(value - certified) / std::abs(certified);
  return std::isfinite(error) ? -std::log10(std::max(error, kCertified)) : 0.0;
}

/// Standard errors sqrt(s^2 (J^T J)^-1) with s^2 = |r|^2 / (rows - parameters).
Eigen::VectorXd standard_errors(const InformationRoot& fit) {
  const double variance = fit.squared_residuals() / static_cast<double>(fit.row_count() - fit.parameter_count());
  return (variance * inverse_information(fit.root()).diagonal()).cwiseSqrt();
}

constexpr double kParameterDigits = 6.0;

/// The residuals of Lanczos1, 1e-13, are what 14 printed digits left over. Rounding its responses to double alone
/// changes them so that the exact standard errors share 3.5 digits with the certified ones (computed with 60 digits);
/// rounding inside the model costs a little more.
double standard_error_digits(const std::string& problem) { return problem == "Lanczos1" ? 2.5 : 4.0; }

/// Digits that an answer shares with the certified one; the least of all parameters.
struct Agreement {
  double parameters = 0.0, errors = 0.0;
};

Agreement agreement(const LeastSquaresResult& fit, const Dataset& data) {
  const Eigen::VectorXd errors = standard_errors(fit.at_answer);
  Agreement least{99.0, 99.0};
  for (Eigen::Index k = 0; k < errors.size(); ++k) {
    const CertifiedParameter& certified = data.parameters[static_cast<std::size_t>(k)];
    least.parameters = std::min(least.parameters, digits(fit.parameters(k), certified.value));
    least.errors = std::min(least.errors, digits(errors(k), certified.deviation));
  }
  return least;
}

/// For all 54 together. A first step that is small, because some starts are far away; many iterations, because from
/// its first start MGH10 creeps along a curved valley, 50 decades of b1 down and up again; a rank tolerance near
/// rounding, because every parameter here can be identified, however weakly: on its way MGH17 passes where two
/// exponentials nearly coincide.
constexpr LeastSquaresOptions kPatient{
    .max_iterations = 10'000, .step_tolerance = 1e-14, .rank_tolerance = 1e-12, .initial_damping = 1e3};

class NistStrd : public testing::TestWithParam<std::tuple<Problem, std::size_t>> {
 protected:
  void SetUp() override {
    ASSERT_FALSE(data.parameters.empty()) << "cannot read " << problem().name << ".dat";
    ASSERT_EQ(data.observations.size(), data.observation_count);
  }

  Problem problem() const { return std::get<0>(GetParam()); }
  std::size_t start() const { return std::get<1>(GetParam()); }
  LeastSquaresResult solve(const LeastSquaresOptions& options) const {
    const Problem solved = problem();
    return solve_least_squares(row_model(solved, data), data.start(start()), options);
  }

  const Dataset data = read_dataset(problem().name);
};

TEST_P(NistStrd, CertifiedParametersAndStandardErrors) {
  const LeastSquaresResult fit = solve(kPatient);
  EXPECT_EQ(fit.status, LeastSquaresStatus::converged);
  const Agreement found = agreement(fit, data);
  EXPECT_GE(found.parameters, kParameterDigits);
  EXPECT_GE(found.errors, standard_error_digits(problem().name));
  RecordProperty("parameter_digits", std::to_string(found.parameters));
  RecordProperty("error_digits", std::to_string(found.errors));
  RecordProperty("iterations", fit.iterations);
}

/// What the library's own options do: they are made for machines near their nominal dimensions, and these need more.
struct Demanding {
  const char* problem;
  std::size_t start;
  const char* needs;
};

constexpr std::array kDemanding{
    Demanding{"Bennett5", 0, "iterations"}, Demanding{"Bennett5", 1, "iterations"},
    Demanding{"BoxBOD", 0, "iterations"},   Demanding{"Eckerle4", 0, "iterations"},
    Demanding{"Lanczos1", 0, "iterations"}, Demanding{"Lanczos2", 0, "iterations"},
    Demanding{"Lanczos3", 0, "iterations"}, Demanding{"MGH09", 0, "iterations"},
    Demanding{"MGH10", 0, "iterations"},    Demanding{"MGH10", 1, "iterations"},
    Demanding{"Nelson", 0, "iterations"},   Demanding{"MGH17", 0, "rank"},
};

/// Residuals of 1e-13 and 1e-7 of the responses: settled before they are this small, so s is not theirs.
bool fits_beyond_the_step(std::string_view problem) { return problem == "Lanczos1" || problem == "Lanczos2"; }

TEST_P(NistStrd, TheLibrarysOwnOptionsGiveFourDigitsOrSaySo) {
  const LeastSquaresResult fit = solve({});
  const auto* const demanding = std::ranges::find_if(kDemanding, [&](const Demanding& one) {
    return one.problem == std::string(problem().name) && one.start == start();
  });
  const std::string needs = demanding == kDemanding.end() ? "" : demanding->needs;
  EXPECT_EQ(fit.status, needs == "iterations" ? LeastSquaresStatus::not_converged : LeastSquaresStatus::converged);
  const Agreement found = agreement(fit, data);
  EXPECT_EQ(found.parameters >= 4.0, needs.empty()) << found.parameters << " digits";
  if (fits_beyond_the_step(problem().name)) return;
  EXPECT_EQ(found.errors >= 4.0, needs.empty()) << found.errors << " digits";
}

INSTANTIATE_TEST_SUITE_P(BothStarts, NistStrd, testing::Combine(testing::ValuesIn(kProblems), testing::Values(0U, 1U)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + "FromStart" +
                                  std::to_string(std::get<1>(test.param) + 1);
                         });

}  // namespace
}  // namespace paracal::nist_test
