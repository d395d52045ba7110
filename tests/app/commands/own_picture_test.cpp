// The camera and the exposure of a configuration, as seen in the files of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"

namespace carousel::own_picture_test {
namespace {

const char* const kSmall = "scene: {builtin: cornell}\nimage: {width: 16, height: 12, samples: 1}\n";

TEST(OwnPicture, ExposureChangesThePngAlone) {
  const Program program;
  program.write("a.yaml", kSmall);
  ASSERT_EQ(program.run({"run", "a.yaml", "--out", "a"}).status, 0);
  ASSERT_EQ(program.run({"run", "a.yaml", "--out", "b", "--set", "image.exposure=1.5"}).status, 0);
  EXPECT_NE(program.read("a/image.png"), program.read("b/image.png"));
  EXPECT_EQ(program.read("a/image.exr"), program.read("b/image.exr"));
  const auto digest = [&](const char* name) { return nlohmann::json::parse(program.read(name))["digest"]; };
  EXPECT_EQ(digest("a/report.json"), digest("b/report.json"));
}

TEST(OwnPicture, ACameraThatRepeatsTheScenesGivesItsPicture) {
  const Program program;
  program.write("a.yaml", kSmall);
  ASSERT_EQ(program.run({"run", "a.yaml", "--out", "a"}).status, 0);
  // scene/builtin/cornell.cpp: look_at({0, 1, 2.5}, {0, 1, 0}, 0.76).
  ASSERT_EQ(
      program.run({"run", "a.yaml", "--out", "b", "--set", "camera={eye: [0, 1, 2.5], target: [0, 1, 0]}"}).status, 0);
  ASSERT_EQ(
      program
          .run({"run", "a.yaml", "--out", "c", "--set", "camera={eye: [0, 1, 2.5], target: [0, 1, 0], up: [1, 0, 0]}"})
          .status,
      0);
  EXPECT_EQ(program.read("a/image.png"), program.read("b/image.png"));
  EXPECT_NE(program.read("a/image.png"), program.read("c/image.png"));
}

}  // namespace
}  // namespace carousel::own_picture_test
