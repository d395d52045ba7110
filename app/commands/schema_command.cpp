#include "app/commands/schema_command.h"

#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "core/config/config_page.h"
#include "core/config/schema.h"
#include "report/run/report_json.h"

namespace carousel::app {

int schema_command(const SchemaArguments& arguments) {
  const bool config = arguments.file == "config";
  if (arguments.markdown && !config) {
    spdlog::error("--markdown goes with schema config only");
    return kUsage;
  }
  if (arguments.markdown)
    print_result(config_markdown());
  else
    print_result((config ? config_schema() : report::report_schema()).dump(2) + "\n");
  return kDone;
}

}  // namespace carousel::app
