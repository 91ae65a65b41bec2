#include <fmt/format.h>

#include <memory>

#include "schemas.hpp"
#include "session.hpp"

namespace paracal::app {
namespace {

void list_schemas(Session& session) {
  io::Json schemas = io::Json::array();
  std::string text;
  for (const std::string& name : schema_names()) {
    const std::string about = result_schema(name).at("description").get<std::string>();
    schemas.push_back({{"name", name}, {"about", about}});
    text += fmt::format("{:<22}{}\n", name, about);
  }
  session.json() ? session.print_json({{"schemas", schemas}}) : session.print(text);
}

}  // namespace

void add_schema(Command& program, Session& session) {
  Command* command = session.add_command(program, "schema", "Read its results",
                                         "print the JSON Schema of a result, or list all schemas");
  const auto name = std::make_shared<std::string>();
  command->add_option("name", *name, "name of the result")->check(one_of(schema_names()));
  command->example("All schemas", "paracal schema");
  command->callback(
      [&session, name] { name->empty() ? list_schemas(session) : session.print_json(result_schema(*name)); });
}

}  // namespace paracal::app
