// Pictures of Gaussians on machines of both engines, against a reference that sorts all Gaussians of each ray.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "scene/model/camera_pose.h"
#include "shading/camera/camera_rays.h"
#include "shading/math/sampler.h"
#include "tests/app/support/program.h"
#include "tests/scene/import/gaussian_ply_file.h"
#include "tests/support/random_runs.h"
#include "tests/support/read_exr.h"

namespace carousel::gaussians_test {
namespace {

using Json = nlohmann::json;
using scene::PlyGaussian;

constexpr int kWidth = 20, kHeight = 14, kSeed = 4;
const Vec3 kEye{0, 0.5f, 6};

/// Gaussians in a box before the camera, long and flat ones among them.
std::vector<PlyGaussian> cloud(int count) {
  std::mt19937 random(11);
  const auto within = [&](float from, float to) {
    return from + (to - from) * static_cast<float>(random() >> 8) * 0x1p-24f;
  };
  std::vector<PlyGaussian> out(static_cast<std::size_t>(count));
  for (PlyGaussian& one : out) {
    one.x = within(-2, 2), one.y = within(-1.5f, 1.5f), one.z = within(-2, 2);
    for (float& color : one.color) color = within(-1.7f, 1.7f);
    one.opacity = within(-1, 5);
    for (float& scale : one.scale) scale = within(-4, -1);
    for (float& part : one.rotation) part = within(-1, 1);
  }
  return out;
}

double linear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// What a file says of a Gaussian, in double.
struct Reference {
  DVec3 mean, color;
  DMat3 precision;  ///< inverse of the covariance
  double opacity;
};

Reference reference_of(const PlyGaussian& one) {
  Reference out;
  out.mean = {one.x, one.y, one.z};
  for (int c = 0; c < 3; ++c) out.color[c] = std::max(0.0, 0.5 + 0.28209479177387814 * double{one.color[c]});
  out.opacity = 1 / (1 + std::exp(-double{one.opacity}));
  double w = one.rotation[0], x = one.rotation[1], y = one.rotation[2], z = one.rotation[3];
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  w /= length, x /= length, y /= length, z /= length;
  const DMat3 rows(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
                   1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
                   1 - 2 * (x * x + y * y));
  DMat3 scaled(0.0);
  for (int axis = 0; axis < 3; ++axis) scaled[axis][axis] = std::exp(-2 * double{one.scale[axis]});
  out.precision = glm::transpose(rows) * scaled * rows;
  return out;
}

/// The light of a ray: all Gaussians that it passes within three standard deviations, sorted by where they respond
/// most.
DVec3 light_of(const std::vector<Reference>& all, const Ray& ray) {
  struct Met {
    double t, alpha;
    const Reference* gaussian;
  };
  std::vector<Met> met;
  const DVec3 origin(ray.origin), direction(ray.direction);
  for (const Reference& one : all) {
    const DVec3 by = one.precision * direction;
    const double t = glm::dot(by, one.mean - origin) / glm::dot(by, direction);
    const DVec3 off = origin + t * direction - one.mean;
    const double squared = glm::dot(off, one.precision * off);
    if (t >= 0 && squared <= 9) met.push_back({t, std::min(0.99, one.opacity * std::exp(-squared / 2)), &one});
  }
  std::sort(met.begin(), met.end(), [](const Met& a, const Met& b) { return a.t < b.t; });
  DVec3 light(0.0);
  double passing = 1;
  for (const Met& one : met) {
    if (passing < 0.001) break;
    light += passing * one.alpha * one.gaussian->color;
    passing *= 1 - one.alpha;
  }
  for (int c = 0; c < 3; ++c) light[c] = linear(light[c]);  // the sky is black
  return light;
}

std::vector<double> reference_picture(const std::vector<PlyGaussian>& gaussians) {
  std::vector<Reference> all;
  for (const PlyGaussian& one : gaussians) all.push_back(reference_of(one));
  const shading::CameraRays camera(scene::look_at(kEye, Vec3(0), 0.8f), {}, kWidth, kHeight);
  const shading::Sampler sampler(kSeed, 1);
  std::vector<double> out;
  for (std::uint32_t y = 0; y < kHeight; ++y)
    for (std::uint32_t x = 0; x < kWidth; ++x) {
      const DVec3 light = light_of(all, camera.ray(x, y, sampler.camera(y * kWidth + x, 0)));
      for (int c = 0; c < 3; ++c) out.push_back(light[c]);
    }
  return out;
}

class Gaussians : public testing::Test {
 protected:
  Gaussians() {
    program_.write("cloud.ply", scene::gaussian_ply(cloud(kCount)));
    program_.write("run.yaml",
                   fmt::format("scene: {{file: cloud.ply, sky: {{strength: 0}}}}\n"
                               "camera: {{eye: [{}, {}, {}], target: [0, 0, 0], field_of_view: 45.8366236}}\n"
                               "image: {{width: {}, height: {}, samples: 1, seed: {}}}\n"
                               "rays: {{slots_per_resource: 64, query: {{nearest: 4096, buffer: 4}}}}\n"
                               "engine: {{kind: cycle}}\ncollections: {{traversal: ordered}}\n",
                               kEye.x, kEye.y, kEye.z, kWidth, kHeight, kSeed));
  }

  Outcome run(const std::string& sets) {
    std::vector<std::string> words{"run", "run.yaml", "--out", "out", "--force", "--quiet", "--no-html"};
    std::istringstream in(sets);
    for (std::string set; in >> set;) words.insert(words.end(), {"--set", set});
    return program_.run(words);
  }
  Json report(const std::string& sets) {
    const Outcome outcome = run(sets);
    EXPECT_EQ(outcome.status, 0) << sets << outcome.err;
    return outcome.status == 0 ? Json::parse(program_.read("out/report.json")) : Json();
  }

  static constexpr int kCount = 250;
  Program program_;
};

const std::vector<std::string>& machines() {
  static const std::vector<std::string> all{
      "topology.resources=3 rays.query.rounds=restart",
      "topology.resources=3 rays.query.rounds=resume",
      "topology.shape=independent topology.resources=2 rays.query.rounds=restart rays.query.buffer=1",
      "topology.shape=independent topology.resources=2 rays.query.rounds=resume rays.query.buffer=16",
      "engine.kind=native engine.threads=2 topology.resources=3 rays.query.rounds=restart rays.query.buffer=3",
      "engine.kind=native engine.threads=1 topology.resources=2 rays.query.rounds=resume",
      "topology.resources=2 bvh.width=2 accuracy.triangle=double rays.query.buffer=7",
      "topology.resources=2 bvh.storage=quantised rays.query.buffer=2 rays.query.rounds=resume",
  };
  return all;
}

TEST_F(Gaussians, PictureIsThatOfAllHitsSortedOnEveryMachine) {
  const std::vector<double> wanted = reference_picture(cloud(kCount));
  ASSERT_GT(*std::max_element(wanted.begin(), wanted.end()), 0.3);
  std::string digest;
  std::uint64_t blended = 0;
  std::size_t turn = run_seed();
  for (const std::string& machine : machines())
    for (const std::string geometry : {"ellipsoids", "triangles"}) {
      if (!digest.empty() && run_effort() < 1 && ++turn % 2 != 0) continue;
      const std::string sets = machine + " scene.gaussians.geometry=" + geometry;
      const Json result = report(sets);
      ASSERT_TRUE(result.is_object());
      if (digest.empty()) {
        digest = result["digest"]["image"].get<std::string>();
        blended = result["nearest"]["blended"].get<std::uint64_t>();
        const ExrPicture picture = read_exr(program_.folder() / "out/image.exr");
        ASSERT_EQ(picture.rgb.size(), wanted.size());
        for (std::size_t i = 0; i < wanted.size(); ++i)
          ASSERT_NEAR(picture.rgb[i], wanted[i], 2e-5) << i / 3 % kWidth << ", " << i / 3 / kWidth;
      }
      EXPECT_EQ(result["digest"]["image"], digest) << sets;
      EXPECT_EQ(result["nearest"]["blended"], blended) << sets;
      // Rays had rounds, and these ended.
      EXPECT_GT(result["nearest"]["rounds"], result["nearest"]["rays"]) << sets;
      EXPECT_EQ(result["nearest"]["rays"], kWidth * kHeight);
    }
}

// Bytes beside the records, steps, joules and area; opaque rays end early, and resumed rounds visit less.
TEST_F(Gaussians, CostWhatTheyTake) {
  const std::string machine = "energy.profile=n45 rays.query.rounds=resume";
  const Json resume = report(machine), free = report(machine + " rays.query.response_steps=0"),
             slow = report(machine + " rays.query.response_steps=400"),
             restart = report("energy.profile=n45 rays.query.rounds=restart"),
             all = report(machine + " scene.gaussians.opaque_below=0"),
             triangles = report(machine + " scene.gaussians.geometry=triangles");
  const auto steps = [](const Json& r) { return r["tests"]["buffer_steps"]["count"].get<std::uint64_t>(); };
  const auto count = [](const Json& r, const char* name) { return r["nearest"][name].get<std::uint64_t>(); };
  EXPECT_EQ(steps(resume), steps(free) + 8 * count(resume, "responses"));
  EXPECT_GT(slow["engine"]["cycles"].get<std::uint64_t>(), free["engine"]["cycles"].get<std::uint64_t>() * 3 / 2);
  EXPECT_GT(resume["energy"]["joules"].get<double>(), free["energy"]["joules"].get<double>());
  EXPECT_GT(count(all, "blended"), count(resume, "blended"));
  EXPECT_GT(count(all, "rounds"), count(resume, "rounds"));
  EXPECT_GT(count(restart, "visits"), count(resume, "visits"));
  EXPECT_EQ(count(resume, "response_bytes"), 0u);  // read with the instance
  EXPECT_EQ(count(triangles, "response_bytes"), 64 * count(triangles, "responses"));
  EXPECT_GT(triangles["structure"]["bytes"], resume["structure"]["bytes"]);
  EXPECT_EQ(resume["structure"]["primitives"], 1);  // they share a sphere
  EXPECT_EQ(triangles["structure"]["primitives"], 20 * kCount);
}

TEST_F(Gaussians, EndWhereTheyTakeTooLittle) {
  const Json wide = report(""), narrow = report("scene.gaussians.radius=1"),
             some = report("scene.gaussians.least_alpha=0.1");
  const auto responses = [](const Json& r) { return r["nearest"]["responses"].get<std::uint64_t>(); };
  EXPECT_LT(responses(narrow), responses(wide));
  EXPECT_LT(responses(some), responses(wide));
}

TEST_F(Gaussians, RefuseWhatIsNotBuilt) {
  program_.write("run.yaml", program_.read("run.yaml") + "primitives: {cube: {program: ['hit dx, dx, dx, dx']}}\n");
  const std::vector<std::pair<std::string, std::string>> refused{
      {"rays.query.nearest=0 rays.query.buffer=auto",
       "rays.query.nearest: the scene consists of Gaussians; a ray blends the nearest hits that it finds; expected 1 "
       "to "
       "65536"},
      {"verify=reference", "verify: the scene consists of Gaussians; the reference knows surfaces alone"},
      {"scene.gaussians.geometry=ellipsoid", "did you mean 'ellipsoids'?"},
      {"scene.gaussians.radius=0", "scene.gaussians.radius: expected"},
      {R"(scene.objects=[{"primitive":"cube"}])",
       "scene.objects: the scene consists of Gaussians; rays blend these alone"},
      {"collections.traversal=spread", "expected at most 64 with rays.query.buffer: auto, or collections.traversal"},
  };
  for (const auto& [sets, message] : refused) {
    const Outcome outcome = run(sets);
    EXPECT_EQ(outcome.status, 2) << sets << outcome.err;
    EXPECT_THAT(outcome.err, testing::HasSubstr(message)) << sets;
  }
}

}  // namespace
}  // namespace carousel::gaussians_test
