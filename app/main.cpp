#include "app/command_line/command_line.h"
#include "app/host/starved.h"

namespace {

// Libraries of libraries start threads before main(). Where there is no memory for them, they throw, and nobody catches
// it: the handler has to be there before their constructors, which only the preinit array allows (System V ABI,
// "Initialization and Termination Functions").
void before_libraries() {
  carousel::app::explain_starvation();
}
[[gnu::section(".preinit_array"), gnu::used]] void (*const kBeforeLibraries)() = before_libraries;

}  // namespace

int main(int argc, char** argv) {
  return carousel::app::main(argc, argv);
}
