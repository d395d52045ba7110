// Pictures of Gaussians on machines of both engines, against a reference that sorts all Gaussians of each ray.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
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
  for (PlyGaussian& one : out)
    for (float& coefficient : one.higher) coefficient = within(-0.5f, 0.5f);
  return out;
}

/// The real spherical harmonic in a direction of length 1 by its definition: of polar angles and associated Legendre
/// functions with the Condon-Shortley phase.
double harmonic(int degree, int order, const DVec3& d) {
  const int m = std::abs(order);
  const double around = std::atan2(d.y, d.x), across = std::sqrt(std::max(0.0, 1 - d.z * d.z));
  double same = 1;  // of order m and degree m, then by recurrence of the degree wanted
  for (int k = 1; k <= m; ++k) same *= -(2 * k - 1) * across;
  double below = 0, at = same, factorials = 1;
  for (int l = m + 1; l <= degree; ++l) {
    const double next = ((2 * l - 1) * d.z * at - (l + m - 1) * below) / (l - m);
    below = at, at = next;
  }
  for (int k = degree - m + 1; k <= degree + m; ++k) factorials *= k;
  const double scale = std::sqrt((2 * degree + 1) / (4 * std::numbers::pi) / factorials);
  if (order == 0) return scale * at;
  return std::sqrt(2.0) * scale * at * (order > 0 ? std::cos(m * around) : std::sin(m * around));
}

double linear(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// What a file says of a Gaussian, in double.
struct Reference {
  DVec3 mean;
  std::vector<DVec3> harmonics;  ///< by degree and order
  DMat3 precision;               ///< inverse of the covariance
  double opacity;
};

Reference reference_of(const PlyGaussian& one, int degree) {
  Reference out;
  out.mean = {one.x, one.y, one.z};
  out.harmonics.resize(static_cast<std::size_t>((degree + 1) * (degree + 1)));
  const std::size_t in_channel = out.harmonics.size() - 1;
  for (std::size_t c = 0; c < 3; ++c) {
    out.harmonics[0][static_cast<int>(c)] = double{one.color[c]};
    for (std::size_t k = 0; k < in_channel; ++k)
      out.harmonics[k + 1][static_cast<int>(c)] = double{one.higher[c * in_channel + k]};
  }
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

DVec3 color_of(const Reference& one, const DVec3& direction) {
  DVec3 sum(0.5);
  std::size_t at = 0;
  for (int degree = 0; at < one.harmonics.size(); ++degree)
    for (int order = -degree; order <= degree; ++order) sum += harmonic(degree, order, direction) * one.harmonics[at++];
  return glm::max(sum, DVec3(0.0));
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
    light += passing * one.alpha * color_of(*one.gaussian, glm::normalize(direction));
    passing *= 1 - one.alpha;
  }
  for (int c = 0; c < 3; ++c) light[c] = linear(light[c]);  // the sky is black
  return light;
}

std::vector<double> reference_picture(const std::vector<PlyGaussian>& gaussians, int degree) {
  std::vector<Reference> all;
  for (const PlyGaussian& one : gaussians) all.push_back(reference_of(one, degree));
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
    write_cloud(0);
    program_.write("run.yaml",
                   fmt::format("scene: {{file: cloud.ply, sky: {{strength: 0}}}}\n"
                               "camera: {{eye: [{}, {}, {}], target: [0, 0, 0], field_of_view: 45.8366236}}\n"
                               "image: {{width: {}, height: {}, samples: 1, seed: {}}}\n"
                               "rays: {{slots_per_resource: 64, query: {{nearest: 4096, buffer: 4}}}}\n"
                               "engine: {{kind: cycle}}\ncollections: {{traversal: ordered}}\n",
                               kEye.x, kEye.y, kEye.z, kWidth, kHeight, kSeed));
  }

  void write_cloud(int degree) { program_.write("cloud.ply", scene::gaussian_ply(cloud(kCount), degree)); }
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
  const std::vector<double> wanted = reference_picture(cloud(kCount), 0);
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

TEST_F(Gaussians, HaveTheColoursOfHarmonicsOfDegree0To3) {
  std::size_t turn = run_seed();
  for (int degree = 0; degree <= 3; ++degree) {
    write_cloud(degree);
    const std::vector<double> wanted = reference_picture(cloud(kCount), degree);
    std::string digest;
    for (const std::string geometry : {"ellipsoids", "triangles"}) {
      const Json result = report(machines()[++turn % machines().size()] + " scene.gaussians.geometry=" + geometry);
      ASSERT_TRUE(result.is_object());
      const ExrPicture picture = read_exr(program_.folder() / "out/image.exr");
      ASSERT_EQ(picture.rgb.size(), wanted.size());
      for (std::size_t i = 0; i < wanted.size(); ++i)
        ASSERT_NEAR(picture.rgb[i], wanted[i], 4e-5) << degree << ": " << i / 3 % kWidth << ", " << i / 3 / kWidth;
      if (digest.empty()) digest = result["digest"]["image"].get<std::string>();
      EXPECT_EQ(result["digest"]["image"], digest) << geometry << degree;
    }
    // Those of a file above a degree are left out.
    if (degree < 3) continue;
    const std::vector<double> first = reference_picture(cloud(kCount), 0);
    ASSERT_TRUE(report("scene.gaussians.degree=0").is_object());
    const ExrPicture picture = read_exr(program_.folder() / "out/image.exr");
    for (std::size_t i = 0; i < first.size(); ++i) ASSERT_NEAR(picture.rgb[i], first[i], 2e-5);
  }
}

// Each Gaussian that a ray meets costs the steps of its coefficients. Its record grows by their bytes, which are read
// with it: from memory, and from packets that bring what is tested.
TEST_F(Gaussians, PayForHarmonics) {
  const std::string machine =
      "energy.profile=n45 rays.query.rounds=resume topology.resources=1 memory.shape_buffer_kib=4096";
  const auto steps = [](const Json& r) { return r["tests"]["buffer_steps"]["count"].get<std::uint64_t>(); };
  const auto terms = [](const Json& r) { return r["nearest"]["color_terms"].get<std::uint64_t>(); };
  const auto joules = [](const Json& r) { return r["energy"]["parts"]["hit_buffer_steps"]["joules"].get<double>(); };
  const auto lines = [](const Json& r) { return r["memory"]["caches"][0]["lines"].get<std::uint64_t>(); };
  constexpr std::uint64_t kCoefficients[4] = {0, 3, 8, 15}, kLines[4] = {1, 2, 3, 4};
  for (const std::string geometry : {"ellipsoids", "triangles"}) {
    const bool triangles = geometry == "triangles";
    const std::string with = machine + " scene.gaussians.geometry=" + geometry;
    write_cloud(0);
    const Json plain = report(with),
               packets = report(with + " topology.resources=3 packets.carry=data memory.fetch=packet");
    EXPECT_EQ(terms(plain), 0u);
    std::uint64_t met = 0;
    for (int degree = 1; degree <= 3; ++degree) {
      write_cloud(degree);
      const Json result = report(with), free = report(with + " rays.query.harmonic_steps=0"),
                 slow = report(with + " rays.query.harmonic_steps=64");
      EXPECT_EQ(terms(result) % kCoefficients[degree], 0u);
      if (degree == 1) met = terms(result) / 3;
      EXPECT_EQ(terms(result) / kCoefficients[degree], met);
      EXPECT_EQ(steps(free), steps(plain));
      EXPECT_EQ(steps(result), steps(free) + terms(result));
      EXPECT_GT(slow["engine"]["cycles"], free["engine"]["cycles"]);
      // A step is 1.8 pJ, and a coefficient three products of 9.6 pJ besides.
      EXPECT_NEAR(joules(result) - joules(free), 1.8e-12 * static_cast<double>(terms(result)), 1e-4 * joules(result));
      EXPECT_NEAR(joules(result) - joules(plain), (1.8e-12 + 3 * 9.6e-12) * static_cast<double>(terms(result)),
                  1e-4 * joules(result));
      // The buffer holds all, so each record is read once: 64 bytes beside triangles and another coefficient's 12.
      const std::uint64_t more = lines(result) - lines(plain);
      if (triangles) {
        EXPECT_EQ(more % (kLines[degree] - kLines[0]), 0u);
        EXPECT_LE(more / (kLines[degree] - kLines[0]), kCount);
        EXPECT_GT(more / (kLines[degree] - kLines[0]), kCount / 2);
      } else {
        EXPECT_GT(more, kCount / 2);
      }
      EXPECT_GE(result["structure"]["bytes"].get<std::uint64_t>(),
                plain["structure"]["bytes"].get<std::uint64_t>() + 12 * kCoefficients[degree] * kCount);
      const Json bring = report(with + " topology.resources=3 packets.carry=data memory.fetch=packet");
      EXPECT_GT(
          bring["links"][0]["bytes"].get<std::uint64_t>(),
          packets["links"][0]["bytes"].get<std::uint64_t>() + packets["links"][0]["bytes"].get<std::uint64_t>() / 10);
    }
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
      {"scene.gaussians.degree=4", "scene.gaussians.degree: expected"},
      {"scene.gaussians.geometry=triangles bvh.mixed_triangles=4",
       "bvh.mixed_triangles: the scene consists of Gaussians"},
      {"scene.gaussians.geometry=triangles collections.key=block",
       "a block of memory does not bring the records of its triangles; expected node, or scene.gaussians.geometry"},
      {"scene.gaussians.geometry=triangles rays.query.nearest=8 rays.query.buffer=auto bvh.treelets.bytes=1024",
       "bvh.treelets.bytes: the scene consists of Gaussians"},
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
