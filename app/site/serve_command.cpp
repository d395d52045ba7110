#include "app/site/serve_command.h"

#include <fmt/format.h>

#include "app/host/exit_status.h"
#include "app/host/interrupt.h"
#include "app/host/output.h"
#include "app/site/site.h"
#include "core/module/module.h"

namespace carousel::app {

int serve_command(const ServeArguments& arguments) {
  const InterruptScope interrupt;
  const HttpModule& http = open_module<HttpModule>();
  Site site(arguments.folders);
  http.serve(
      arguments.port, [&](const HttpRequest& request) { return site.answer(request); },
      [&](int port) {
        site.set_port(port);
        print_result(fmt::format("site         http://127.0.0.1:{}/{}/\n", port, site.token()));
      },
      interrupt.token());
  return kDone;
}

}  // namespace carousel::app
