#pragma once

#include <string>
#include <vector>

namespace carousel::app {

struct ServeArguments {
  std::vector<std::string> folders;
  int port = 0;  ///< 0: a free one
};

/// `carousel serve`: shows folders of results as one site on 127.0.0.1 until it is interrupted, and prints its address.
/// Returns the exit status.
int serve_command(const ServeArguments& arguments);

}  // namespace carousel::app
