// Robots, source errors, tolerances and problems of allocation as TOML, by a choice of '0' to '3'. What is accepted is
// accepted again as it is written.

#include "fuzzing.hpp"
#include "paracal/io/allocation_problem.hpp"
#include "paracal/io/toml.hpp"

namespace paracal::fuzz {
namespace {

void read(const Input& input) {
  const io::TextFile file{"file.toml", input.text};
  const Robot& known = robot(input.choice / 4);
  const JointSpace joints(known.limb_count(), known.actuator());
  std::string written;
  switch (input.choice % 4) {
    case 0:
      written = io::robot_toml(io::read_robot(file));
      return must_read([&] { (void)io::read_robot({"written.toml", written}); });
    case 1:
      written = io::source_errors_toml(io::read_source_errors(file, joints), joints);
      return must_read([&] { (void)io::read_source_errors({"written.toml", written}, joints); });
    case 2:
      written = io::tolerances_toml(io::read_tolerances(file, known), known.geometry());
      return must_read([&] { (void)io::read_tolerances({"written.toml", written}, known); });
    default:
      return (void)io::read_allocation_problem(file, tolerances_of(known), known);
  }
}

}  // namespace
}  // namespace paracal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return paracal::fuzz::run(data, size, paracal::fuzz::read);
}
