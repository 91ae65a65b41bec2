// Calibrations and other JSON.

#include "fuzzing.hpp"
#include "paracal/io/json.hpp"
#include "paracal/io/robot_statement.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace paracal;
  const std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::may_complain([&] {
    const io::JsonFile file({"calibration.json", text});
    for (const unsigned choice : {0U, 1U, 2U}) {
      fuzz::may_complain([&] { (void)io::read_calibration(file, fuzz::robot(choice)).known(); });
    }
    const Robot robot = io::robot_of_calibration(file).robot;
    (void)io::read_calibration(file, robot).known();
  });
  return 0;
}
