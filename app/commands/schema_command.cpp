#include "app/commands/schema_command.h"

#include <nlohmann/json.hpp>

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/plugins/plugins.h"
#include "core/config/config_page.h"
#include "core/config/schema.h"
#include "report/run/report_json.h"
#include "report/run/report_page.h"

namespace carousel::app {

int schema_command(const SchemaArguments& arguments) {
  const bool config = arguments.file == "config";
  open_plugins(arguments.plugins);
  if (arguments.markdown)
    print_result(config ? config_markdown() : report::report_markdown());
  else
    print_result((config ? config_schema() : report::report_schema()).dump(2) + "\n");
  return kDone;
}

}  // namespace carousel::app
