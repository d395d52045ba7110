#pragma once

#include <string>

namespace CLI {
class App;
}

namespace carousel::app {

struct CompletionArguments {
  std::string shell;  ///< bash | zsh
};

/// `carousel completion`: prints the completion of `program` for a shell. Returns the exit status.
int completion_command(const CLI::App& program, const CompletionArguments& arguments);

/// `carousel man`: prints the manual page of `program`. Returns the exit status.
int man_command(const CLI::App& program);

}  // namespace carousel::app
