#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/module/module.h"
#include "core/system/memory_budget.h"
#include "scene/images/image_decode.h"
#include "tests/app/support/program.h"

namespace carousel::modules_run_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const char* const kSmall = "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 1}\n";

struct Environment {
  Environment(const char* key, const std::string& value) : name(key) { setenv(key, value.c_str(), 1); }
  ~Environment() { unsetenv(name); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  const char* name;
};

bool has_pictures() {
  try {
    module_file("pictures");
  } catch (const ModuleError&) {
    return false;
  }
  return true;
}

/// The shared libraries that the program loads: those that the loader says it starts (ld.so(8), LD_DEBUG=files).
std::set<std::string> loaded(const Program& program, const std::vector<std::string>& arguments) {
  const Environment debug("LD_DEBUG", "files"), output("LD_DEBUG_OUTPUT", (program.folder() / "loaded").string());
  const Outcome outcome = program.run(arguments);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  std::set<std::string> out;
  for (const fs::directory_entry& entry : fs::directory_iterator(program.folder())) {
    if (!entry.path().filename().string().starts_with("loaded.")) continue;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);)
      if (const std::size_t at = line.find("calling init: "); at != line.npos)
        out.insert(fs::path(line.substr(at + 14)).filename().string());
    in.close();
    fs::remove(entry.path());
  }
  return out;
}

bool holds(const std::set<std::string>& names, const std::string& part) {
  return std::any_of(names.begin(), names.end(), [&](const std::string& n) { return n.find(part) != n.npos; });
}

TEST(ModulesOfARun, NoneIsOpenedWithoutNeed) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
  GTEST_SKIP() << "a sanitizer is one library more";
#endif
  const Program program;
  program.write("a.yaml", kSmall);
  const std::set<std::string> version = loaded(program, {"--version"});
  // 22 beside the loader when the modules came. One more is a cost of every start: it belongs into a module, or here.
  EXPECT_LE(version.size(), 22u) << testing::PrintToString(version);
  EXPECT_GT(version.size(), 10u);
  std::set<std::string> run = loaded(program, {"run", "a.yaml", "--out", "a"});
  std::erase_if(run, [](const std::string& n) { return n.starts_with("libtbbmalloc"); });  // TBB opens it when it works
  EXPECT_EQ(run, version);
  if (!has_pictures()) GTEST_SKIP() << "the module pictures is not there";
  const std::set<std::string> tiff = loaded(program, {"run", "a.yaml", "--out", "b", "--set", "image.files=[tiff]"});
  EXPECT_TRUE(holds(tiff, "pictures.so"));
  EXPECT_TRUE(holds(tiff, "OpenImageIO"));
  EXPECT_FALSE(holds(tiff, "mpi.so"));
}

TEST(ModulesOfARun, AreListedByVersionWithVerbose) {
  const Program program;
  const Outcome outcome = program.run({"--version", "--verbose"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(program.run({"--verbose", "--version"}).out, outcome.out);
  EXPECT_THAT(outcome.out, HasSubstr(program.run({"--version"}).out.substr(0, 20)));
  EXPECT_THAT(outcome.out, HasSubstr("modules in "));
  if (has_pictures()) {
    EXPECT_THAT(outcome.out, HasSubstr("pictures  pictures.so, OpenImageIO "));
  }
  std::ofstream(program.folder() / "pictures.so") << "carousel module of build 0.0.1 other\n";
  const Environment modules("CAROUSEL_MODULES", program.folder().string());
  const std::string other = program.run({"--version", "--verbose"}).out;
  EXPECT_THAT(other, HasSubstr("pictures  pictures.so, refused: it is of the build 0.0.1 other; expected"));
  EXPECT_THAT(other, HasSubstr("mpi       not there; Debian's package carousel-mpi brings it"));
}

scene::Image picture(const Program& program, const std::string& name) {
  const std::string bytes = program.read(name);
  MemoryBudget memory(64 << 20);
  return scene::decode_image({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, memory, {name});
}

TEST(ModulesOfARun, WriteTheFilesOfThePicture) {
  if (!has_pictures()) GTEST_SKIP() << "the module pictures is not there";
  const Program program;
  program.write("a.yaml", kSmall);
  const Outcome outcome = program.run(
      {"run", "a.yaml", "--out", "a", "--set", "image.width=40", "--set", "image.height=32", "--set",
       "image.files=[png, exr, tiff, hdr, pfm, fits, jpg, jp2, webp, tga, bmp, gif, ppm, dpx, sgi, rla, iff]"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const scene::Image expected = picture(program, "a/image.png");
  for (const char* name : {"tga", "bmp", "ppm", "dpx", "sgi", "iff", "jp2"})
    EXPECT_EQ(picture(program, std::string("a/image.") + name).rgba, expected.rgba) << name;
  const scene::Image light = picture(program, "a/image.exr");
  for (const char* name : {"tiff", "pfm", "fits"})
    EXPECT_EQ(picture(program, std::string("a/image.") + name).rgba, light.rgba) << name;
  for (const char* name : {"hdr", "jpg", "webp", "gif", "rla"})
    EXPECT_EQ(picture(program, std::string("a/image.") + name).width, 40u) << name;
  // Other files than before: those of the last run go.
  ASSERT_EQ(program.run({"run", "a.yaml", "--out", "a", "--force", "--set", "image.files=[tiff]"}).status, 0);
  EXPECT_FALSE(fs::exists(program.folder() / "a/image.png"));
  EXPECT_FALSE(fs::exists(program.folder() / "a/image.gif"));
  EXPECT_TRUE(fs::exists(program.folder() / "a/image.tiff"));
  EXPECT_TRUE(fs::exists(program.folder() / "a/report.html"));
}

TEST(ModulesOfARun, OtherFilesAreRefusedBeforeTheRun) {
  const Program program;
  program.write("a.yaml", kSmall);
  Outcome outcome = program.run({"run", "a.yaml", "--out", "a", "--set", "image.files=[png, tif]"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("image.files"));
  EXPECT_THAT(outcome.err, HasSubstr("did you mean 'tiff'?"));
  const Environment modules("CAROUSEL_MODULES", program.folder().string());
  outcome = program.run({"run", "a.yaml", "--out", "a", "--set", "image.files=[png, tiff]"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("image.files: the module pictures is not there: "));
  EXPECT_THAT(outcome.err, HasSubstr("carousel-pictures"));
  EXPECT_FALSE(fs::exists(program.folder() / "a"));
}

}  // namespace
}  // namespace carousel::modules_run_test
