#include <memory>

#include "paracal/io/klipper.hpp"
#include "paracal/io/machine_codes.hpp"
#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/printer/printer_machine.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

void list(const Session& session) {
  io::Json names = io::Json::array();
  std::string text;
  for (const std::string_view name : catalogue::names()) {
    names.push_back(name);
    text.append(name).append("\n");
  }
  session.json() ? session.print_json(io::Json{{"robots", names}}) : session.print(text);
}

/// The robot that a printer's own configuration describes: Klipper's printer.cfg, or M665 and M666 of a config.g.
Robot printer_robot(const std::string& name, const std::string& firmware) {
  const io::TextFile file = io::read_file(name);
  if (firmware == "klipper") {
    const io::KlipperDelta printer = io::read_klipper(file);
    return printer_machine(printer.geometry, printer.print_radius).robot;
  }
  const io::CodeDialect dialect = firmware == "marlin" ? io::CodeDialect::marlin : io::CodeDialect::reprapfirmware;
  return printer_machine(io::read_machine_codes(file, dialect)).robot;
}

}  // namespace

void add_robot(CLI::App& app, Session& session) {
  CLI::App* command = session.add_command(app, "robot", "Describe a robot", "the robot as a file to start from");
  const auto only_names = std::make_shared<bool>(false);
  command->add_flag("--list", *only_names, "names of the catalogue");
  const auto printer = std::make_shared<std::string>();
  const auto firmware = std::make_shared<std::string>("klipper");
  CLI::Option* file = command->add_option("--printer", *printer, "the linear delta of a printer's own configuration");
  command->add_option("--firmware", *firmware, "whose configuration it is")
      ->check(CLI::IsMember({"klipper", "reprapfirmware", "marlin"}))
      ->needs(file)
      ->capture_default_str();
  command->callback([&session, only_names, printer, firmware] {
    if (*only_names) return list(session);
    const Robot robot = printer->empty() ? session.robot() : printer_robot(*printer, *firmware);
    session.json() ? session.print_json(io::to_json(robot)) : session.print(io::robot_toml(robot));
  });
}

}  // namespace paracal::app
