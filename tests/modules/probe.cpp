// A module for tests: of this build, and once more as one of another build.
#include "tests/modules/probe.h"

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/module/module.h"

namespace {

// A library's own code runs when it is opened: where the file names one, a mark is left in it.
[[gnu::constructor]] void leave_a_mark() {
  if (const char* mark = std::getenv("CAROUSEL_PROBE_MARK")) setenv(mark, "opened", 1);
}

int number() {
  return 42;
}

void fail(int how) {
  if (how == 0) throw carousel::SceneError("a.obj", "/line 3", "is broken");
  throw carousel::FileError("cannot be read");
}

std::string library() {
  return "Probe 1.2";
}

std::string answer(std::string_view question) {
  if (question == "refuse") throw std::runtime_error("of no use\x1b[31m");
  if (question == "crash") std::raise(SIGSEGV);
  if (question == "leave") std::_Exit(7);
  return "answer to " + std::string(question);
}

}  // namespace

const carousel::ModuleInfo* carousel_module() {
  using namespace carousel;
  static const Probe functions{number, fail};
  static const ModuleInfo info{.build = module_build(),
                               .name = Probe::kModule,
                               .brings = "a number",
                               .library = library,
                               .functions = &functions,
                               .answer = answer};
  return &info;
}
