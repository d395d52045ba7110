// Cull planes: what they hold, exactly; what they must never lose; what they are worth.
#include <cstring>
#include <iostream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "accel/exact/dyadic.h"
#include "accel/planes/cull_plane_clip.h"
#include "accel/structure/primitive_boxes.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/planes/plane_rays.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using Nodes = CullPlanesConfig::Nodes;
using Fit = CullPlanesConfig::Fit;

Accel with_planes(const scene::Scene& scene, std::int64_t count, Nodes nodes, std::int64_t leaf = 4,
                  Fit fit = Fit::kVertices, const AccuracyConfig& accuracy = {}, bool shared = false) {
  BvhConfig bvh;
  bvh.leaf_triangles = leaf;
  CullPlanesConfig planes;
  planes.count = count;
  planes.nodes = nodes;
  planes.fit = fit;
  planes.shared_normals = shared;
  return build(scene, bvh, *make_sequential_executor(), accuracy, planes);
}

/// Neighbours in one tilted plane but for a few ulps, long and thin.
scene::Mesh coplanar_strip(const Vec3& at, float length, float width) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 40; ++i) {
    const Vec3 a = at + Vec3(width * float(i), width * 0.3f * float(i), 0), b = a + Vec3(width, width * 0.3f, 0),
               up(length * 0.1f, 0, length);
    for (const Vec3& p : {a, b, a + up, b, b + up, a + up}) corners.push_back(p);
  }
  return soup(corners);
}

struct HardMesh {
  std::string name;
  scene::Scene scene;
};

std::vector<HardMesh> hard_meshes() {
  std::vector<HardMesh> all;
  all.push_back({"icosphere", icosphere_scene(3)});
  all.push_back({"icosphere at 1e6", icosphere_scene(3, Vec3(1e6f, -1e6f, 1e6f), 20)});
  all.push_back({"small icosphere", icosphere_scene(2, Vec3(1e-9f, 0, 0), 1e-8f)});
  all.push_back({"slivers", small_builtin(BuiltinScene::kSliver, 1000)});
  all.push_back({"terrain", small_builtin(BuiltinScene::kTerrain, 2000)});
  all.push_back({"coplanar", scene_of(coplanar_strip(Vec3(0), 1, 0.01f))});
  all.push_back({"coplanar at 1e6", scene_of(coplanar_strip(Vec3(1e6f, 3e5f, -1e6f), 100, 1))});
  all.push_back({"instances", small_builtin(BuiltinScene::kInstances, 0, 12)});
  return all;
}

bool same_bits(const Hit& a, const Hit& b) {
  return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}

// One triangle a leaf and eight planes everywhere: nothing else holds a ray up. Where every triangle has planes of its
// own and of all nodes above, no hit may be missing, be it one that only rounding makes.
void expect_none_lost(const AccuracyConfig& accuracy, std::size_t total) {
  const std::vector<HardMesh> meshes = hard_meshes();
  std::size_t hits = 0, lost = 0;
  IntersectionCounts counts;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const HardMesh& mesh = meshes[m];
    const Accel plain = build_sequential(mesh.scene, 8, 1, accuracy);
    const Accel planes =
        with_planes(mesh.scene, 8, Nodes::kAll, 1, m % 2 == 0 ? Fit::kVertices : Fit::kBoxes, accuracy, m % 3 == 2);
    std::size_t left = total / meshes.size(), mesh_lost = 0;
    for (std::uint64_t batch = 0; left > 0; ++batch) {
      const std::size_t count = std::min<std::size_t>(left, 20000);
      const std::uint64_t seed = std::uint64_t{run_seed()} << 32 | m << 24 | batch;
      const RayBatch rays = plane_grazing_rays(mesh.scene, count, seed);
      HitBatch got;
      trace_depth_first(planes, rays, got, counts);
      const HitBatch expected = trace(plain, rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        hits += expected[i].hit.valid();
        if (same_bits(got[i].hit, expected[i].hit)) continue;
        const Ray& r = rays[i].ray;
        if (++mesh_lost <= 2)
          ADD_FAILURE() << mesh.name << ", CAROUSEL_SEED=" << run_seed() << " batch " << batch << " ray " << i
                        << std::hexfloat << ": origin " << r.origin.x << " " << r.origin.y << " " << r.origin.z
                        << " direction " << r.direction.x << " " << r.direction.y << " " << r.direction.z << " t "
                        << expected[i].hit.t << " became " << got[i].hit.t;
      }
      left -= count;
    }
    lost += mesh_lost;
  }
  std::cout << total << " rays, " << hits << " hits, " << counts.culled << " culled, " << lost << " lost\n";
  EXPECT_EQ(lost, 0u);
  EXPECT_GT(hits, total / 4);
  EXPECT_GT(counts.culled, total / 4);
}

TEST(CullPlanes, LoseNoHitThatIsFoundWithoutThem) {
  expect_none_lost({}, oracle_rays());
}

TEST(CullPlanes, LoseNoHitOfExactTriangles) {
  AccuracyConfig accuracy;
  accuracy.triangle = TriangleLevel::kExact;
  expect_none_lost(accuracy, oracle_rays() / 20);
}

TEST(CullPlanes, GiveTheAnswersOfBruteForce) {
  for (const TriangleLevel level : {TriangleLevel::kWatertight, TriangleLevel::kExact}) {
    AccuracyConfig accuracy;
    accuracy.triangle = level;
    for (const BuiltinScene builtin : {BuiltinScene::kTerrain, BuiltinScene::kSliver, BuiltinScene::kInstances}) {
      const scene::Scene scene = small_builtin(builtin);
      const BruteForceAnswers answers(scene, mixed_rays(scene, 300, run_seed()), accuracy);
      EXPECT_GT(answers.hits(), 50u);
      for (const Nodes nodes : {Nodes::kLeaves, Nodes::kInner, Nodes::kAll})
        for (const std::int64_t count : {1, 3, 8})
          for (const Fit fit : {Fit::kVertices, Fit::kBoxes})
            EXPECT_EQ(answers.differences(with_planes(scene, count, nodes, 2, fit, accuracy)), 0u)
                << "scene " << int(builtin) << " nodes " << int(nodes) << " count " << count << " fit " << int(fit);
    }
  }
}

void corners_below(const Accel& accel, NodeRef ref, std::vector<Vec3>& out) {
  if (ref.is_inner()) {
    for (int lane = 0; lane < accel.nodes[ref.node()].count; ++lane)
      corners_below(accel, accel.nodes[ref.node()].child[lane], out);
    return;
  }
  for (std::uint32_t i = 0; i < ref.triangles(); ++i)
    for (const auto& vertex : accel.blocks[ref.first_block() + i / 4].vertex)
      out.push_back({vertex[0][i % 4], vertex[1][i % 4], vertex[2][i % 4]});
}

/// How many vertices stand beyond a plane of a box around them, in exact arithmetic.
std::size_t cut_off(const Accel& accel, std::size_t& planes) {
  std::size_t outside = 0;
  for (const Node& node : accel.nodes) {
    const CullPlane* plane = accel.planes.data() + node.first_plane;
    for (int lane = 0; lane < node.count && node.plane_counts != 0; ++lane) {
      std::vector<Vec3> corners;
      corners_below(accel, node.child[lane], corners);
      for (int i = 0; i < plane_count(node, lane); ++i, ++plane, ++planes) {
        Dyadic length;
        for (int axis = 0; axis < 3; ++axis) length = length + Dyadic(std::fabs(plane->normal[axis]));
        EXPECT_LE((length - Dyadic(1)).sign(), 0);
        for (const Vec3& p : corners) {
          Dyadic beyond = -Dyadic(plane->distance);
          for (int axis = 0; axis < 3; ++axis) {
            const float centre = plane_centre(node.plane[axis][lane], node.plane[axis + 3][lane]);
            beyond = beyond + Dyadic(plane->normal[axis]) * (Dyadic(p[axis]) - Dyadic(centre));
          }
          outside += beyond.sign() > 0;
        }
      }
    }
  }
  return outside;
}

/// How many vertices stand outside of a sphere around them, in exact arithmetic.
std::size_t outside_spheres(const Accel& accel) {
  std::size_t outside = 0;
  for (const Node& node : accel.nodes) {
    const CullPlane* sphere = accel.planes.data() + node.first_plane;
    for (int lane = 0; lane < node.count; sphere += plane_count(node, lane++)) {
      if (plane_count(node, lane) == 0) continue;
      std::vector<Vec3> corners;
      corners_below(accel, node.child[lane], corners);
      for (const Vec3& p : corners) {
        Dyadic beyond = -(Dyadic(sphere->distance) * Dyadic(sphere->distance));
        for (int axis = 0; axis < 3; ++axis) {
          const Dyadic along = Dyadic(p[axis]) - Dyadic(sphere->normal[axis]);
          beyond = beyond + along * along;
        }
        outside += beyond.sign() > 0;
      }
    }
  }
  return outside;
}

TEST(CullPlanes, CutOffNoVertexExactly) {
  std::size_t planes = 0;
  for (const HardMesh& mesh : hard_meshes())
    for (const Fit fit : {Fit::kVertices, Fit::kBoxes})
      for (const bool shared : {false, true})
        EXPECT_EQ(cut_off(with_planes(mesh.scene, 8, Nodes::kAll, 2, fit, {}, shared), planes), 0u) << mesh.name;
  EXPECT_GT(planes, 10000u);
}

TEST(CullPlanes, StandOnlyWhereTheyAreWanted) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 2000);
  std::size_t bytes = build_sequential(scene).size_bytes();
  EXPECT_TRUE(with_planes(scene, 0, Nodes::kAll).planes.empty());
  EXPECT_EQ(with_planes(scene, 0, Nodes::kAll).size_bytes(), bytes);
  for (const Nodes nodes : {Nodes::kLeaves, Nodes::kInner, Nodes::kAll}) {
    const Accel accel = with_planes(scene, 3, nodes);
    EXPECT_EQ(accel.size_bytes(), bytes + 16 * accel.planes.size());
    std::size_t seen = 0;
    for (const Node& node : accel.nodes)
      for (int lane = 0; lane < kMaxWidth; ++lane) {
        const int count = plane_count(node, lane);
        seen += static_cast<std::size_t>(count);
        EXPECT_LE(count, 3);
        if (count == 0) continue;
        ASSERT_LT(lane, node.count);
        EXPECT_NE(node.child[lane].kind(), NodeRef::Kind::kInstance);
        EXPECT_TRUE(nodes == Nodes::kAll || node.child[lane].is_inner() == (nodes == Nodes::kInner));
      }
    EXPECT_EQ(seen, accel.planes.size());
    EXPECT_GT(seen, 0u);
  }
}

TEST(CullPlanes, StandAtTheDepthsAskedFor) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 2000);
  CullPlanesConfig planes;
  planes.count = 2;
  planes.nodes = Nodes::kAll;
  planes.depth = {1, 2};
  const Accel accel = build(scene, {}, *make_sequential_executor(), {}, planes);
  std::array<std::size_t, 4> with_planes{};  // nodes, by depth
  for (const Node& node : accel.nodes) with_planes[std::min<std::size_t>(node.depth, 3)] += node.plane_counts != 0;
  EXPECT_EQ(with_planes[0], 0u);
  EXPECT_GT(with_planes[1], 0u);
  EXPECT_GT(with_planes[2], 0u);
  EXPECT_EQ(with_planes[3], 0u);
}

// Six faces in opposite pairs that are at right angles. None of them cuts a vertex off, and no ray loses its hit.
TEST(CullPlanes, MayBeTheFacesOfAnOrientedBox) {
  CullPlanesConfig config;
  config.count = 6;
  config.nodes = Nodes::kAll;
  config.object = CullPlanesConfig::Object::kOrientedBox;
  std::size_t planes = 0, lost = 0;
  IntersectionCounts counts;
  for (const HardMesh& mesh : hard_meshes()) {
    const Accel plain = build_sequential(mesh.scene, 8, 2), accel = [&] {
      BvhConfig bvh;
      bvh.leaf_triangles = 2;
      return build(mesh.scene, bvh, *make_sequential_executor(), {}, config);
    }();
    EXPECT_EQ(cut_off(accel, planes), 0u) << mesh.name;
    for (const Node& node : accel.nodes) {
      const CullPlane* plane = accel.planes.data() + node.first_plane;
      for (int lane = 0; lane < kMaxWidth; plane += plane_count(node, lane++)) {
        if (plane_count(node, lane) == 0) continue;
        ASSERT_EQ(plane_count(node, lane), 6);
        const auto normal = [&](int i) { return Vec3(plane[i].normal[0], plane[i].normal[1], plane[i].normal[2]); };
        for (int i = 0; i < 6; i += 2) {
          EXPECT_EQ(normal(i), -normal(i + 1));
          EXPECT_NEAR(glm::dot(normal(i), normal((i + 2) % 6)), 0, 1e-6);
        }
      }
    }
    const RayBatch rays = plane_grazing_rays(mesh.scene, 5000, run_seed());
    HitBatch without, with;
    IntersectionCounts of_plain;
    trace_depth_first(plain, rays, without, of_plain);
    trace_depth_first(accel, rays, with, counts);
    for (std::size_t i = 0; i < rays.size(); ++i) lost += !same_bits(without[i].hit, with[i].hit);
  }
  EXPECT_GT(planes, 5000u);
  EXPECT_GT(counts.culled, 1000u);
  EXPECT_EQ(lost, 0u);
}

/// Rays that touch the sphere of a leaf beside a vertex of its triangles, from afar.
RayBatch rays_beside_spheres(const Accel& accel, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  RayBatch rays;
  while (rays.size() < count) {
    const Node& node = accel.nodes[random.below(static_cast<std::uint32_t>(accel.nodes.size()))];
    const CullPlane* sphere = accel.planes.data() + node.first_plane;
    for (int lane = 0; lane < node.count; sphere += plane_count(node, lane++)) {
      if (plane_count(node, lane) == 0 || node.child[lane].is_inner()) continue;
      for (const Vec3& corner : triangle_corners(accel, node.child[lane], random.below(node.child[lane].triangles()))) {
        const DVec3 out = DVec3(corner) - DVec3(sphere->normal[0], sphere->normal[1], sphere->normal[2]);
        const DVec3 along = glm::normalize(glm::cross(out, DVec3(random.in_box(Vec3(-1), Vec3(1)))));
        const double away = glm::length(out) * std::exp2(random.uniform(0, 12));
        const Vec3 from(DVec3(corner) - away * along);
        rays.push_back(ray_to(from, corner - from));
      }
    }
  }
  return rays;
}

// A sphere holds every vertex below, exactly, and no ray that touches it loses its hit.
TEST(CullPlanes, MayBeASphere) {
  CullPlanesConfig config;
  config.count = 1;
  config.nodes = Nodes::kAll;
  config.object = CullPlanesConfig::Object::kSphere;
  std::size_t spheres = 0, lost = 0, hit = 0;
  IntersectionCounts counts;
  for (const HardMesh& mesh : hard_meshes()) {
    BvhConfig bvh;
    bvh.leaf_triangles = 2;
    const Accel plain = build_sequential(mesh.scene, 8, 2),
                accel = build(mesh.scene, bvh, *make_sequential_executor(), {}, config);
    spheres += accel.planes.size();
    EXPECT_EQ(outside_spheres(accel), 0u) << mesh.name;
    if (accel.planes.empty()) continue;
    RayBatch rays = plane_grazing_rays(mesh.scene, 5000, run_seed());
    for (const RayRequest& ray : rays_beside_spheres(accel, 20000, run_seed())) rays.push_back(ray);
    HitBatch without, with;
    IntersectionCounts of_plain;
    trace_depth_first(plain, rays, without, of_plain);
    trace_depth_first(accel, rays, with, counts);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      lost += !same_bits(without[i].hit, with[i].hit);
      hit += without[i].hit.valid();
    }
  }
  std::cout << fmt::format("{} spheres, {} culled, {} hits, {} lost\n", spheres, counts.culled, hit, lost);
  EXPECT_GT(spheres, 1000u);
  EXPECT_GT(counts.culled, 1000u);
  EXPECT_EQ(lost, 0u);
}

TEST(CullPlanes, ShareTheirNormalsAmongSiblings) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 2000);
  const Accel accel = with_planes(scene, 4, Nodes::kAll, 4, Fit::kVertices, {}, true);
  std::size_t bytes = 0, shared = 0;
  for (const Node& node : accel.nodes) {
    const CullPlane* plane = accel.planes.data() + node.first_plane;
    const CullPlane* first = plane;  // the first lane's that has any
    int normals = 0;
    for (int lane = 0; lane < node.count; ++lane) {
      const int count = plane_count(node, lane);
      if (count == 0) continue;
      EXPECT_TRUE(normals == 0 || count == normals);
      normals = count;
      for (int i = 0; i < count; ++i, ++plane, ++shared)
        EXPECT_EQ(std::memcmp(plane->normal, first[i].normal, sizeof(plane->normal)), 0);
      bytes += 4 * static_cast<std::size_t>(count);
    }
    bytes += 12 * static_cast<std::size_t>(normals);
  }
  EXPECT_GT(shared, 500u);
  EXPECT_EQ(accel.plane_bytes, bytes);
  EXPECT_EQ(accel.size_bytes(), build_sequential(scene).size_bytes() + bytes);
}

/// Half of a square's box is empty; the other triangle is far away, so that there is a node.
TEST(CullPlanes, CullFromTheFrontFromBehindAndInParallel) {
  const scene::Scene scene =
      scene_of(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}, {50, 50, 50}, {51, 50, 50}, {50, 51, 50}}));
  const Accel accel = with_planes(scene, 8, Nodes::kLeaves, 1);
  const auto counts_of = [&](const Vec3& from, const Vec3& direction) {
    HitBatch hits;
    IntersectionCounts counts;
    trace_depth_first(accel, {ray_to(from, direction)}, hits, counts);
    EXPECT_EQ(counts.triangle, 1 - counts.culled);  // the box is hit
    EXPECT_GT(counts.plane, 0u);
    return counts;
  };
  EXPECT_EQ(counts_of({0.2f, 0.2f, -1}, {0, 0, 1}).culled, 0u);
  EXPECT_EQ(counts_of({0.9f, 0.9f, -1}, {0, 0, 1}).culled, 1u);          // along the plane through the long edge
  EXPECT_EQ(counts_of({0.8f, 2.2f, -0.5f}, {0, -1, 0.5f}).culled, 1u);   // comes in through it too late
  EXPECT_EQ(counts_of({0.8f, 0.8f, 0.2f}, {1, 0.2f, 0.1f}).culled, 1u);  // went out of it behind the origin
}

// Issue 6 expects 23, 34, 49 and 56 % of the triangle tests to be avoided at four triangles a leaf; how many there are
// to avoid depends on the rays. These all aim at the terrain.
TEST(CullPlanes, AvoidTriangleTestsOnTerrain) {
  const scene::Scene scene = small_builtin(BuiltinScene::kTerrain, 20000);
  const RayBatch rays = whole_rays(scene, 20000, run_seed());
  HitBatch hits;
  IntersectionCounts plain;
  trace_depth_first(build_sequential(scene), rays, hits, plain);
  const std::pair<std::int64_t, double> expectations[] = {{1, 0.23}, {2, 0.34}, {4, 0.49}, {8, 0.56}};
  for (const auto& [planes, expected] : expectations) {
    IntersectionCounts counts;
    hits.clear();
    trace_depth_first(with_planes(scene, planes, Nodes::kLeaves), rays, hits, counts);
    const double avoided = 1 - double(counts.triangle) / double(plain.triangle);
    std::cout << fmt::format("{} planes: {:.1f} % of triangle tests avoided, {:.2f} plane tests a ray\n", planes,
                             100 * avoided, double(counts.plane) / double(rays.size()));
    EXPECT_GT(avoided, 0.5 * expected) << planes;
    EXPECT_EQ(counts.box, plain.box);
  }
}

}  // namespace
}  // namespace carousel::accel
