#include <memory>

#include "inputs.hpp"
#include "printing.hpp"
#include "reporting.hpp"
#include "session.hpp"

namespace paracal::app {

void add_printer(Command& program, Session& session) {
  Command* command = session.add_command(program, "printer", "Calibrate a machine",
                                         "calibrate a delta printer from its own configuration and readings");
  const auto options = std::make_shared<PrinterOptions>();
  command->heading("Printer");
  command->get_option("--robot")->hide()->excludes(
      command
          ->add_option("configuration", options->printer.name,
                       "Klipper's printer.cfg with the results of DELTA_CALIBRATE, or the M-codes of another firmware")
          ->required());
  add_printer_options(*command, *options, session.outputs);
  add_table_options(*command, options->style);
  command->heading("Results");
  const std::shared_ptr<std::string> report = add_report_option(*command, session);
  command->example("Check a printer and see new values", "paracal printer printer.cfg");
  command->example("Write the configuration with the new values to another file",
                   "paracal printer printer.cfg --config new.cfg");
  command->callback([&session, options, report] { calibrate_printer_file(*options, *report, session); });
}

}  // namespace paracal::app
