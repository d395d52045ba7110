#pragma once

#include <string>
#include <vector>

#include "app/usage/usage.h"

namespace carousel::app {

// Scripts that complete commands, options, the words that options take, configuration keys and their values. All that
// they offer stands in them: to ask the program would take a quarter of a second a key press.

/// For bash 4 and newer. It needs nothing of the package bash-completion.
std::string bash_completion(const ProgramUsage& program, const std::vector<KeyUsage>& keys);

/// For zsh's function system (compinit), as a file _carousel in a folder of fpath.
std::string zsh_completion(const ProgramUsage& program, const std::vector<KeyUsage>& keys);

}  // namespace carousel::app
