#pragma once

namespace carousel::app {

/// The program: parses the command line, runs the command, and maps errors to an exit status.
int main(int argc, const char* const* argv);

}  // namespace carousel::app
