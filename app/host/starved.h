#pragma once

namespace carousel::app {

/// From here on an exception that nobody catches, thrown because a thread or memory could not be had, ends the program
/// with a message and exit status 2. Other such exceptions end it as before. May be called before any library has been
/// initialised.
void explain_starvation();

}  // namespace carousel::app
