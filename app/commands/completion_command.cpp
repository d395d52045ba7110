#include "app/commands/completion_command.h"

#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/usage/completion.h"
#include "app/usage/man_page.h"
#include "app/usage/usage.h"
#include "core/system/version.h"

namespace carousel::app {

int completion_command(const CLI::App& program, const CompletionArguments& arguments) {
  const auto script = arguments.shell == "bash" ? bash_completion : zsh_completion;
  print_result(script(usage_of(program), key_usages()));
  return kDone;
}

int man_command(const CLI::App& program) {
  print_result(man_page(usage_of(program), key_usages(), build_info().version));
  return kDone;
}

}  // namespace carousel::app
