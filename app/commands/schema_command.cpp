#include "app/commands/schema_command.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/plugins/plugins.h"
#include "core/config/config_page.h"
#include "core/config/graph/names_in_schema.h"
#include "core/config/load/load.h"
#include "core/config/schema.h"
#include "core/system/error.h"
#include "core/types/enum_names.h"
#include "report/run/report_json.h"
#include "report/run/report_page.h"

namespace carousel::app {

namespace {

/// The schema of configurations with the names of a graph, which a file draws.
nlohmann::ordered_json schema_of_graph(const std::string& file) {
  const LocatedConfig located = load_config(read_config_file(file), {}, {.force = true});
  const TopologyShape shape = located.config.topology.shape;
  if (shape != TopologyShape::kGraph)
    throw ConfigError({{located.positions.find("topology.shape"), "topology.shape",
                        fmt::format("expected graph, whose nodes have names, found {}", enum_name(shape))}});
  nlohmann::ordered_json schema = config_schema();
  config::name_in_schema(schema, located.config.topology, located.config.clocks);
  return schema;
}

}  // namespace

int schema_command(const SchemaArguments& arguments) {
  const bool config = arguments.file == "config";
  if (!config && !arguments.graph.empty())
    throw ConfigError({{{}, "--graph", "a report names no nodes; expected schema config"}});
  open_plugins(arguments.plugins);
  if (!arguments.graph.empty())
    print_result(schema_of_graph(arguments.graph).dump(2) + "\n");
  else if (arguments.markdown)
    print_result(config ? config_markdown() : report::report_markdown());
  else
    print_result((config ? config_schema() : report::report_schema()).dump(2) + "\n");
  return kDone;
}

}  // namespace carousel::app
