#include <fmt/format.h>

#include <memory>

#include "paracal/io/toml.hpp"
#include "paracal/mechanism/catalogue.hpp"
#include "paracal/printer/printer_machine.hpp"
#include "printing.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

void list_robots(Session& session) {
  const auto names = catalogue::names();
  session.json() ? session.print_json(io::Json{{"robots", io::json_array(names)}})
                 : session.print(fmt::format("{}\n", fmt::join(names, "\n")));
}

Robot printer_robot(const PrinterFile& file) {
  const PrinterState printer = read_printer(file);
  return printer_machine(printer.geometry, printer.print_radius).robot;
}

void print_template(Session& session, const std::string& kind) {
  const io::TextFile file = io::robot_template(kind);
  session.json() ? session.print_json(io::to_json(io::read_robot(file))) : session.print(file.text);
}

}  // namespace

void add_robot(Command& program, Session& session) {
  Command* command =
      session.add_command(program, "robot", "Describe a robot", "print a robot file (TOML) to start from");
  const auto only_names = std::make_shared<bool>(false);
  command->add_flag("--list", *only_names, "list the robots of the catalogue");
  const auto printer = std::make_shared<PrinterFile>();
  add_firmware_option(*command, *printer)->needs(add_printer_option(*command, *printer));
  const auto kind = std::make_shared<std::string>();
  command->add_option("--template", *kind, "print a commented file of this kind of robot, to be filled in")
      ->check(one_of(io::robot_templates()));
  command->example("The published robot", "paracal robot --robot huang2016");
  command->example("A file for your own delta robot", "paracal robot --template delta --out delta.toml");
  command->callback([&session, only_names, printer, kind] {
    if (*only_names) return list_robots(session);
    if (!kind->empty()) return print_template(session, *kind);
    const Robot robot = printer->name.empty() ? session.robot() : printer_robot(*printer);
    session.json() ? session.print_json(io::to_json(robot)) : session.print(io::robot_toml(robot));
  });
}

}  // namespace paracal::app
