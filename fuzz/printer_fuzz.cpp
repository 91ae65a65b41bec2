// Configurations of delta printers: Klipper's, and the M-codes of two firmwares, by a choice of '0' to '2'. What is
// read can be written, and read again.

#include "fuzzing.hpp"
#include "paracal/io/klipper.hpp"
#include "paracal/io/machine_codes.hpp"

namespace paracal::fuzz {
namespace {

void read(const Input& input) {
  if (input.text.find("include") != std::string::npos) return;  // of files of this machine
  using enum io::CodeDialect;
  const io::TextFile file{"/nowhere/printer.cfg", input.text};  // so that it includes nothing
  if (input.choice % 3 == 0) return (void)io::klipper_save_config(io::read_klipper(file).geometry);
  const io::CodeDialect dialect = input.choice % 3 == 1 ? reprapfirmware : marlin;
  const DeltaGeometry geometry = io::read_machine_codes(file, dialect);
  const std::string written = io::machine_codes(geometry, dialect);
  if (geometry.actuator == Actuator::revolute) return;  // what is written lacks the lowest angle, which its owner knows
  must_read([&] { (void)io::read_machine_codes({"written.g", written}, dialect); });
}

}  // namespace
}  // namespace paracal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return paracal::fuzz::run(data, size, paracal::fuzz::read);
}
