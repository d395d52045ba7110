#pragma once

#include <string>
#include <vector>

#include "app/usage/usage.h"

namespace carousel::app {

/// Command lines that teach the program, in the order in which a newcomer needs them: for help texts and the man page.
const std::vector<Example>& examples();

/// The end of `carousel --help`: first steps, and where more is to be read.
std::string first_steps();

/// The end of `carousel COMMAND --help`; empty if the command has no example.
std::string examples_text(const std::string& command);

/// Exit statuses with their meaning.
struct StatusMeaning {
  int status;
  const char* meaning;
};
const std::vector<StatusMeaning>& exit_statuses();

}  // namespace carousel::app
