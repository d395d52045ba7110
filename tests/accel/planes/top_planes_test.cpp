// Cull planes above the instances: they hold every vertex where the instance puts it, and lose no hit that the kernel
// finds in the space it has rounded the ray to.
#include <cstring>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "accel/exact/dyadic.h"
#include "accel/planes/cull_plane_clip.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/exact/adversarial_cases.h"
#include "tests/accel/planes/plane_rays.h"
#include "tests/accel/structure/placements.h"
#include "tests/accel/structure/test_scenes.h"
#include "tests/accel/traverse/brute_force_answers.h"
#include "tests/accel/traverse/test_rays.h"
#include "tests/support/publish.h"
#include "tests/support/random_runs.h"

namespace carousel::accel {
namespace {

using PlaneLevels = CullPlanesConfig::Levels;
using Nodes = CullPlanesConfig::Nodes;
using Fit = CullPlanesConfig::Fit;

struct Placed {
  std::string name;
  scene::Scene scene;
};

scene::Mesh icosphere(int level, const Vec3& centre = Vec3{0}) {
  scene::Mesh mesh;
  scene::add_icosphere(mesh, centre, 1, level, MaterialId(0));
  return mesh;
}

/// A few triangles that lie slanted in their box, long and thin ones among them.
scene::Mesh shards(Random& random) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 6; ++i) {
    const Vec3 at = random.in_box(Vec3(-1), Vec3(1));
    for (const float width : {1.0f, 1.0f, 0.01f}) corners.push_back(at + width * random.in_box(Vec3(-1), Vec3(1)));
  }
  return soup(corners);
}

/// Instances turned, scaled, mirrored, sheared and far away.
std::vector<Placed> placed_scenes(std::uint64_t seed) {
  Random random(seed);
  std::vector<Placed> all;
  const auto scene_with = [&](const std::string& name, int instances, const auto& placement) {
    scene::Scene scene = empty_scene();
    const std::uint32_t meshes[] = {add_mesh(scene, icosphere(1)), add_mesh(scene, shards(random)),
                                    add_mesh(scene, soup({{0, 0, 0}, {1, 0, 0.2f}, {0, 1, 0.7f}})),
                                    add_mesh(scene, soup({{-1, 0.1f, 0}, {1, 0.3f, 0.4f}, {1, 0.3001f, 0.5f}}))};
    for (int i = 0; i < instances; ++i) add_instance(scene, meshes[i % 4], placement());
    all.push_back({name, std::move(scene)});
  };
  const auto turned = [&](const DVec3& scale, const Vec3& reach) {
    return rotate_scale_translate(random_direction(random), 360.0 * random.uniform(), scale,
                                  DVec3(random.in_box(-reach, reach)));
  };
  const auto flip = [&] { return random.below(2) ? 1.0 : -1.0; };
  scene_with("turned", 20, [&] { return turned(DVec3(1), Vec3(10)); });
  scene_with("scaled", 20, [&] { return turned(DVec3(log_uniform(random, 1e-3, 1e3)), Vec3(100)); });
  scene_with("mirrored and stretched", 20, [&] {
    return turned({flip() * log_uniform(random, 0.1, 10), flip() * log_uniform(random, 0.1, 10), flip()}, Vec3(10));
  });
  scene_with("far away", 20, [&] {
    scene::Affine m = turned(DVec3(log_uniform(random, 1, 100)), Vec3(50));
    m.translation += Vec3(1e6f, -1e6f, 3e5f);
    return m;
  });
  scene_with("anything", 20, [&] { return placement_case(random); });
  scene_with("beside plain ones", 20, [&] {
    if (random.below(3) == 0)
      return scene::Affine{Mat3(1.0f), random.below(2) ? Vec3(0) : random.in_box(Vec3(-5), Vec3(5))};
    if (random.below(6) == 0)
      return scene::Affine{Mat3(DMat3(1, 0, 0, 0, 1, 0, 0, 0, 0) * rotation({1, 1, 0}, 30)), Vec3(1, 2, 3)};
    return turned(DVec3(1, 2, 0.5), Vec3(5));
  });
  // Model coordinates that the translation takes back: what is left is small, what is rounded is not.
  scene::Scene back = empty_scene();
  const Vec3 at(1e4f, 0, -1e4f);
  const std::uint32_t far[] = {add_mesh(back, icosphere(1, at)),
                               add_mesh(back, soup({at, at + Vec3(1, 0, 0.2f), at + Vec3(0, 1, 0.7f)}))};
  for (int i = 0; i < 12; ++i) {
    scene::Affine m = turned(DVec3(1), Vec3(3));
    m.translation -= m.linear * at;
    add_instance(back, far[i % 2], m);
  }
  all.push_back({"taken back", std::move(back)});
  return all;
}

Accel built(const scene::Scene& scene, const CullPlanesConfig& planes,
            TransformLevel transform = TransformLevel::kTwoStep, std::int64_t leaf = 1,
            TriangleLevel triangle = TriangleLevel::kWatertight) {
  BvhConfig bvh;
  bvh.leaf_triangles = leaf;
  AccuracyConfig accuracy;
  accuracy.transform = transform;
  accuracy.triangle = triangle;
  return build(scene, bvh, *make_sequential_executor(), accuracy, planes);
}

const TransformLevel kBoundedLevels[] = {TransformLevel::kTwoStep, TransformLevel::kTwoStepDouble,
                                         TransformLevel::kTransposeIfRotation};

struct Losses {
  std::size_t hits = 0, lost = 0, culled = 0;
  std::string example;
};

/// Hits that are other with the planes than without.
void count_losses(const Accel& plain, const Accel& planes, const RayBatch& rays, Losses& out) {
  HitBatch got;
  IntersectionCounts counts;
  trace_depth_first(planes, rays, got, counts);
  out.culled += counts.culled;
  const HitBatch expected = trace(plain, rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    out.hits += expected[i].hit.valid();
    if (std::memcmp(&got[i].hit, &expected[i].hit, sizeof(Hit)) == 0) continue;
    const Ray& r = rays[i].ray;
    if (++out.lost == 1)
      out.example = fmt::format("origin {:a} {:a} {:a} direction {:a} {:a} {:a}: instance {} t {} became {}",
                                r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z,
                                expected[i].hit.instance, expected[i].hit.t, got[i].hit.t);
  }
}

TEST(TopPlanes, LoseNoHitOfInstancesAnywhere) {
  const std::size_t total = oracle_rays();
  const std::vector<Placed> scenes = placed_scenes(run_seed() + 700);
  Losses sum;
  int turn = 0;
  for (const TransformLevel level : kBoundedLevels)
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      ++turn;
      const CullPlanesConfig config{.count = 8,
                                    .nodes = Nodes::kAll,
                                    .shared_normals = turn % 3 == 2,
                                    .fit = turn % 2 == 0 ? Fit::kBoxes : Fit::kVertices,
                                    .levels = turn % 4 == 0 ? PlaneLevels::kAll : PlaneLevels::kTlas};
      Losses losses;
      const auto trace = [&](const scene::Scene& scene) {
        const Accel plain = built(scene, {}, level), planes = built(scene, config, level);
        std::size_t left = total / (std::size(kBoundedLevels) * scenes.size()) + 1;
        for (std::uint64_t batch = 0; left > 0; ++batch) {
          const std::size_t count = std::min<std::size_t>(left, 10000);
          count_losses(plain, planes,
                       plane_grazing_rays(scene, count, std::uint64_t{run_seed()} << 32 | turn << 16 | batch), losses);
          left -= count;
        }
      };
      trace(scenes[i].scene);
      // Where next to nothing is culled, no loss means nothing. Instances placed at random may be so (1.3 % of the hits
      // of one scene with CAROUSEL_SEED=723212000); then another scene of the kind has to make up for it.
      if (losses.culled <= losses.hits / 50) trace(placed_scenes(run_seed() + 710)[i].scene);
      EXPECT_EQ(losses.lost, 0u) << scenes[i].name << ", " << enum_name(level) << ", CAROUSEL_SEED=" << run_seed()
                                 << ": " << losses.example;
      EXPECT_GT(losses.culled, losses.hits / 50) << scenes[i].name << ", " << enum_name(level);
      sum.hits += losses.hits;
      sum.lost += losses.lost;
      sum.culled += losses.culled;
    }
  std::cout << total << " rays, " << sum.hits << " hits, " << sum.culled << " culled, " << sum.lost << " lost\n";
  EXPECT_GT(sum.hits, total / 3);
}

TEST(TopPlanes, LoseNoHitOfExactTriangles) {
  Losses losses;
  for (const Placed& placed : placed_scenes(run_seed() + 703)) {
    const auto level = TransformLevel::kTwoStep;
    const CullPlanesConfig config{.count = 8, .nodes = Nodes::kAll, .levels = PlaneLevels::kTlas};
    count_losses(built(placed.scene, {}, level, 1, TriangleLevel::kExact),
                 built(placed.scene, config, level, 1, TriangleLevel::kExact),
                 plane_grazing_rays(placed.scene, oracle_rays() / 200, std::uint64_t{run_seed()} << 32 | 78), losses);
  }
  EXPECT_EQ(losses.lost, 0u) << "CAROUSEL_SEED=" << run_seed() << ": " << losses.example;
  EXPECT_GT(losses.hits, oracle_rays() / 100);
  EXPECT_GT(losses.culled, oracle_rays() / 1000);
}

/// The margins of all nodes above the instances, times `factor`.
Accel with_margins(Accel accel, float factor) {
  for (Node& node : accel.nodes) {
    if (!node.above_instances) continue;
    node.margin_per_reach *= factor;
    node.least_margin *= factor;
  }
  return accel;
}

// The derived margin is needed and not much too wide: hits must go missing without one, and none well before the whole.
TEST(TopPlanes, NeedTheirMargin) {
  const std::vector<Placed> scenes = placed_scenes(run_seed() + 701);
  std::string table = fmt::format("\n{} rays at each of:\n\n| margin |", oracle_rays() / 50);
  for (const Placed& placed : scenes) table += " " + placed.name + " |";
  table += "\n|---|";
  for (std::size_t i = 0; i < scenes.size(); ++i) table += "---:|";
  table += "\n";
  struct Structures {
    Accel plain, planes;
  };
  std::vector<Structures> structures;
  const CullPlanesConfig config{.count = 8, .nodes = Nodes::kAll, .levels = PlaneLevels::kTlas};
  for (const Placed& placed : scenes) structures.push_back({built(placed.scene, {}), built(placed.scene, config)});
  for (const float factor : {0.0f, 0x1p-7f, 0x1p-6f, 0x1p-5f, 0x1p-4f, 0x1p-3f, 0x1p-2f, 0x1p-1f, 1.0f}) {
    table += fmt::format("| {} |", factor);
    std::size_t lost = 0;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      Losses losses;
      count_losses(structures[s].plain, with_margins(structures[s].planes, factor),
                   plane_grazing_rays(scenes[s].scene, oracle_rays() / 50, std::uint64_t{run_seed()} << 32 | 77),
                   losses);
      table += fmt::format(" {} |", losses.lost);
      lost += losses.lost;
    }
    table += "\n";
    if (factor == 0) {
      EXPECT_GT(lost, oracle_rays() / 2000);
    } else if (factor >= 0.5f) {
      EXPECT_EQ(lost, 0u) << factor;
    }
  }
  publish(table);
}

void each_instance_below(const Accel& accel, NodeRef ref, const std::function<void(std::uint32_t)>& visit) {
  if (!ref.is_inner()) return visit(ref.instance_index());
  for (int lane = 0; lane < accel.nodes[ref.node()].count; ++lane)
    each_instance_below(accel, accel.nodes[ref.node()].child[lane], visit);
}

TEST(TopPlanes, CutOffNoVertexWhereItStandsExactly) {
  std::size_t planes = 0, outside = 0;
  for (const Placed& placed : placed_scenes(run_seed() + 702))
    for (const Fit fit : {Fit::kVertices, Fit::kBoxes})
      for (const bool shared : {false, true}) {
        const Accel accel = built(
            placed.scene,
            {.count = 8, .nodes = Nodes::kAll, .shared_normals = shared, .fit = fit, .levels = PlaneLevels::kTlas});
        for (const Node& node : accel.nodes) {
          EXPECT_TRUE(node.above_instances || node.plane_counts == 0);
          const CullPlane* plane = accel.planes.data() + node.first_plane;
          for (int lane = 0; lane < node.count && node.plane_counts != 0; ++lane)
            for (int i = 0; i < plane_count(node, lane); ++i, ++plane, ++planes)
              each_instance_below(accel, node.child[lane], [&](std::uint32_t index) {
                const scene::Instance& instance = placed.scene.instances[index];
                if (accel.instances[index].transform.identity) return;  // baked, or as CullPlanes.* have it
                const scene::Affine& m = instance.world_from_model;
                for (const Vec3& p : placed.scene.meshes[instance.mesh.value].positions) {
                  Dyadic beyond = -Dyadic(plane->distance);
                  for (int row = 0; row < 3; ++row) {
                    Dyadic at = Dyadic(m.translation[row]) -
                                Dyadic(plane_centre(node.plane[row][lane], node.plane[row + 3][lane]));
                    for (int c = 0; c < 3; ++c) at = at + Dyadic(m.linear[c][row]) * Dyadic(p[c]);
                    beyond = beyond + Dyadic(plane->normal[row]) * at;
                  }
                  outside += beyond.sign() > 0;
                }
              });
        }
      }
  EXPECT_GT(planes, 500u);
  EXPECT_EQ(outside, 0u);
}

TEST(TopPlanes, StandOnlyWhereTheyAreWanted) {
  const scene::Scene scene = small_builtin(BuiltinScene::kInstances, 0, 200);
  for (const PlaneLevels levels : {PlaneLevels::kBlas, PlaneLevels::kTlas, PlaneLevels::kAll})
    for (const Nodes nodes : {Nodes::kLeaves, Nodes::kInner, Nodes::kAll}) {
      const Accel accel = built(scene, {.count = 3, .nodes = nodes, .levels = levels}, TransformLevel::kTwoStep, 4);
      std::size_t seen[2][2] = {}, count = 0;  // above or below, inner or not
      for (const Node& node : accel.nodes)
        for (int lane = 0; lane < node.count; ++lane) {
          count += static_cast<std::size_t>(plane_count(node, lane));
          seen[node.above_instances][node.child[lane].is_inner()] += static_cast<std::size_t>(plane_count(node, lane));
        }
      EXPECT_EQ(count, accel.planes.size());
      for (const bool above : {false, true})
        for (const bool inner : {false, true}) {
          const bool wanted = (above ? levels != PlaneLevels::kBlas : levels != PlaneLevels::kTlas) &&
                              (nodes == Nodes::kAll || inner == (nodes == Nodes::kInner));
          EXPECT_EQ(seen[above][inner] > 0, wanted) << enum_name(levels) << " " << enum_name(nodes) << above << inner;
        }
    }
}

TEST(TopPlanes, GiveTheAnswersOfBruteForceAndSpareTransforms) {
  for (const TransformLevel level : kBoundedLevels) {
    AccuracyConfig accuracy;
    accuracy.transform = level;
    const scene::Scene scene = small_builtin(BuiltinScene::kInstances, 0, 40);
    const RayBatch rays = mixed_rays(scene, 500, run_seed());
    const BruteForceAnswers answers(scene, rays, accuracy);
    for (const std::int64_t count : {1, 3, 8}) {
      const Accel planes =
          built(scene, {.count = count, .nodes = Nodes::kLeaves, .levels = PlaneLevels::kTlas}, level, 2);
      EXPECT_EQ(answers.differences(planes), 0u) << enum_name(level) << " " << count;
      HitBatch hits;
      IntersectionCounts with, without;
      trace_depth_first(planes, rays, hits, with);
      hits.clear();
      trace_depth_first(built(scene, {}, level, 2), rays, hits, without);
      EXPECT_GT(with.culled, 0u);
      EXPECT_LT(with.transforms, without.transforms);
      std::cout << fmt::format("{}, {} planes: {} of {} transforms\n", enum_name(level), count, with.transforms,
                               without.transforms);
    }
  }
}

}  // namespace
}  // namespace carousel::accel
