#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/app/support/program.h"
#include "tests/scene/gltf/pose/moving_models.h"

namespace carousel {

/// Runs series of frames on a small machine, in a folder with some models that move.
class SeriesProgram : public testing::Test {
 protected:
  using Json = nlohmann::ordered_json;

  static inline const char* const kMachine =
      "image: {width: 16, height: 12, samples: 1, max_depth: 2}\n"
      "engine: {threads: 1, what_if: false}\n"
      "topology: {resources: 2}\n"
      "rays: {slots_per_resource: 32}\n"
      "packets: {rays: 8}\n"
      "collections: {ready: 8}\n";
  static inline const std::string kSwarm = "{builtin: instances, instances: 40}";
  static inline const std::string kBalls = "{builtin: spheres, triangles: 700}";
  static inline const std::string kWaves = "{builtin: terrain, triangles: 400}";
  static inline const std::string kArm = "{file: arm.gltf, time: 0}\ncamera: {eye: [0, 1, 4], target: [0, 1, 0]}";
  static inline const std::string kSquare = "{file: square.gltf, time: 0}\ncamera: {eye: [1, 2, 5], target: [0, 0, 0]}";

  SeriesProgram() {
    program_.write("arm.gltf", scene::two_bone_arm().text());
    program_.write("square.gltf", scene::morphed_square().text());
  }

  Outcome outcome_of(const std::string& scene, const std::vector<std::string>& sets) const {
    program_.write("series.yaml", "scene: " + scene + "\n" + kMachine);
    std::vector<std::string> arguments{"run", "series.yaml", "--out", "out", "--force", "--quiet", "--no-html"};
    add_sets(arguments, sets);
    return program_.run(arguments);
  }
  Json run(const std::string& scene, const std::vector<std::string>& sets) const {
    const Outcome outcome = outcome_of(scene, sets);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return Json::parse(program_.read("out/report.json"));
  }
  void refused(const std::string& scene, const std::vector<std::string>& sets, const std::string& message) const {
    const Outcome outcome = outcome_of(scene, sets);
    EXPECT_EQ(outcome.status, 2) << message;
    EXPECT_THAT(outcome.err, testing::HasSubstr(message));
  }

  static std::vector<Json> digests(const Json& report) {
    std::vector<Json> out;
    for (const Json& row : report["frames"]["rows"]) out.push_back(row["digest"]);
    return out;
  }

  Program program_;
};

}  // namespace carousel
