#include "core/module/module.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/module/module_process.h"
#include "core/system/error.h"
#include "tests/modules/probe.h"

namespace carousel::module_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder of modules, which the program is told of by the environment.
class Modules : public testing::Test {
 protected:
  Modules() {
    std::string name = (fs::temp_directory_path() / "carousel_modules_XXXXXX").string();
    folder_ = mkdtemp(name.data());
    setenv("CAROUSEL_MODULES", folder_.c_str(), 1);
  }
  ~Modules() override {
    unsetenv("CAROUSEL_MODULES");
    fs::remove_all(folder_);
  }

  void bring(const char* file, const std::string& name) const { fs::copy_file(file, folder_ / name); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  static std::string refusal(const std::function<void()>& open) {
    try {
      open();
    } catch (const ModuleError& error) {
      return error.what();
    }
    return "opened";
  }

  fs::path folder_;
};

TEST_F(Modules, OneOfThisBuildIsOpenedOnce) {
  bring(CAROUSEL_PROBE, "probe.so");
  EXPECT_EQ(open_module<Probe>().number(), 42);
  const ModuleInfo& info = open_module("probe");
  EXPECT_EQ(info.library(), "Probe 1.2");
  EXPECT_STREQ(info.brings, "a number");
  EXPECT_EQ(&info, &open_module("probe"));
}

TEST_F(Modules, ErrorsOfAModuleAreThoseOfTheProgram) {
  bring(CAROUSEL_PROBE, "probe.so");
  const Probe& probe = open_module<Probe>();
  try {
    probe.fail(0);
    FAIL() << "nothing was thrown";
  } catch (const SceneError& error) {
    EXPECT_EQ(error.json_path(), "/line 3");
    EXPECT_STREQ(error.what(), "a.obj: /line 3: is broken");
  }
  EXPECT_THROW(probe.fail(1), FileError);
}

TEST_F(Modules, OneOfAnotherBuildIsRefusedBeforeItsCodeRuns) {
  bring(CAROUSEL_STRANGER, "probe.so");
  setenv("CAROUSEL_PROBE_MARK", "CAROUSEL_PROBE_LEFT", 1);
  const std::string text = refusal([] { open_module<Probe>(); });
  unsetenv("CAROUSEL_PROBE_MARK");
  EXPECT_THAT(text, HasSubstr("the module probe cannot be opened: " + (folder_ / "probe.so").string() +
                              ": it is of the build 0.0.1 stranger; expected that of this program, "));
  EXPECT_EQ(std::getenv("CAROUSEL_PROBE_LEFT"), nullptr);
  EXPECT_EQ(refusal([] { module_file("probe"); }), text);
}

TEST_F(Modules, WhatIsNoModuleIsRefused) {
  write("probe.so", "text");
  EXPECT_THAT(refusal([] { open_module("probe"); }), HasSubstr("probe.so: it is no module of Carousel"));
  write("broken.so", std::string("\x7f"
                                 "ELF") +
                         module_build());
  EXPECT_THAT(refusal([] { open_module("broken"); }), HasSubstr("the module broken cannot be opened"));
  bring(CAROUSEL_PROBE, "pictures.so");
  EXPECT_THAT(refusal([] { open_module("pictures"); }), HasSubstr("it calls itself probe"));
}

TEST_F(Modules, AMissingOneIsNamedWithItsPackage) {
  EXPECT_EQ(refusal([] { open_module("pictures"); }),
            "the module pictures is not there: " + (folder_ / "pictures.so").string() +
                " does not exist; Debian's package carousel-pictures brings it, and so does a build with "
                "libopenimageio-dev installed");
}

TEST_F(Modules, AllAreListed) {
  bring(CAROUSEL_PROBE, "probe.so");
  bring(CAROUSEL_STRANGER, "mpi.so");
  std::string text;
  for (const FoundModule& each : find_modules())
    text += each.name + ": " + (each.info != nullptr ? each.info->library() : each.refused) + "\n";
  EXPECT_THAT(text, HasSubstr("probe: Probe 1.2\n"));
  EXPECT_THAT(text, HasSubstr("mpi: it is of the build 0.0.1 stranger"));
  EXPECT_THAT(text, HasSubstr("pictures: not there; Debian's package carousel-pictures"));
}

class ModuleProcesses : public Modules {
 protected:
  ModuleProcesses() {
    bring(CAROUSEL_PROBE, "probe.so");
    bring(CAROUSEL_MODULE_PROCESS, "process");
  }

  std::string ask(std::string_view one, std::string_view two = {}) {
    const std::vector<std::string_view> question{one, two};
    const std::vector<unsigned char> bytes = process_.ask(question, [](std::uint64_t) {});
    return {bytes.begin(), bytes.end()};
  }
  std::string error(std::string_view question) {
    try {
      return "answered: " + ask(question);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
  }

  ModuleProcess process_{"probe"};
};

TEST_F(ModuleProcesses, AnswerAndGoOnAfterARefusal) {
  EXPECT_EQ(ask("this ", "question"), "answer to this question");
  EXPECT_EQ(error("refuse").substr(0, 9), "of no use");
  EXPECT_EQ(error("refuse").find('\x1b'), std::string::npos);
  EXPECT_EQ(ask(std::string(3 << 20, 'x')), "answer to " + std::string(3 << 20, 'x'));
}

TEST_F(ModuleProcesses, ThatBreakDownAreReportedAndStartedAgain) {
  // AddressSanitizer ends a process itself.
  EXPECT_THAT(error("crash"), testing::AnyOf("broken: the module probe broke down over it (Segmentation fault)",
                                             "broken: the module probe broke down over it (exit status 1)"));
  EXPECT_EQ(ask("one"), "answer to one");
  EXPECT_EQ(error("leave"), "broken: the module probe broke down over it (exit status 7)");
  EXPECT_EQ(ask("two"), "answer to two");
}

TEST_F(ModuleProcesses, AreAskedNoMoreThanTheMemoryAllows) {
  const std::vector<std::string_view> question{"long"};
  EXPECT_THROW(process_.ask(question, [](std::uint64_t bytes) { throw std::length_error(std::to_string(bytes)); }),
               std::length_error);
  EXPECT_EQ(ask("one"), "answer to one");
}

TEST_F(ModuleProcesses, AreOneForEachProcess) {
  EXPECT_EQ(ask("one"), "answer to one");
  const pid_t child = fork();
  if (child == 0) _exit(error("mine") == "answered: answer to mine" ? 0 : 1);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(ask("two"), "answer to two");
}

TEST_F(ModuleProcesses, NameAModuleThatIsMissing) {
  fs::remove(folder_ / "probe.so");
  EXPECT_THROW(ask("one"), ModuleError);
  bring(CAROUSEL_STRANGER, "probe.so");
  EXPECT_THROW(ask("one"), ModuleError);
}

}  // namespace
}  // namespace carousel::module_test
