#include "scene/builtin/nested_groups.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/numeric/exponential.h"
#include "core/numeric/trigonometry.h"
#include "scene/builtin/hash_random.h"
#include "scene/builtin/random_rotation.h"

namespace carousel::scene {

namespace {

constexpr std::uint32_t kVariants = 3;  // number of different groups at each depth
constexpr double kSpacing = 1.0;        // between a sunflower's points, in radii of the objects there, at all depths

/// The linear part and the translation of a placement, in double: they are rounded once, when all are multiplied.
struct Map {
  DMat3 linear{1.0};
  DVec3 translation{0};

  Map operator*(const Map& inner) const { return {linear * inner.linear, linear * inner.translation + translation}; }
  Affine rounded() const { return {Mat3(linear), Vec3(translation)}; }
};

/// Point k of a sunflower (Vogel 1979) whose points lie about `spacing` apart.
DVec3 sunflower(std::int64_t k, double spacing) {
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  const double radius = spacing * std::sqrt(double(k) + 0.5), angle = double(k) * golden;
  return {radius * double(cos_float(static_cast<float>(std::fmod(angle, 2 * std::numbers::pi)))), 0,
          radius * double(sin_float(static_cast<float>(std::fmod(angle, 2 * std::numbers::pi))))};
}

class Nested {
 public:
  Nested(Scene& scene, std::int64_t instances, std::int64_t seed, std::int64_t depth, std::uint32_t shapes)
      : scene_(scene), random_(static_cast<std::uint64_t>(seed), 3), instances_(instances), shapes_(shapes) {
    // With as many members at each depth as in the world.
    const double members = pow_precise(double(instances), 1 / double(depth + 1));
    members_ = std::max<std::int64_t>(2, static_cast<std::int64_t>(members + 1e-9));
    for (std::int64_t at = 0; at < depth; ++at) define(at);
  }

  float place() {
    std::int64_t in_group = 1;
    for (std::size_t at = 0; at < placed_.size() / kVariants; ++at) in_group *= members_;
    const std::int64_t groups = instances_ / in_group, single = instances_ % in_group;
    const double disc = kSpacing * radius_ * std::sqrt(double(groups + (single > 0)));
    for (std::int64_t k = 0; k < groups; ++k) {
      Map world = random_place(k, radius_, 0.2f);
      world.translation.y += 0.75 + 0.35 * radius_;
      open({world, newest_group(), kNoPlacement, 0});
    }
    // Around the others, on a ring.
    for (std::int64_t k = 0; k < single; ++k) {
      const float angle = 2 * std::numbers::pi_v<float> * float(k) / float(single);
      Map world = random_shape(DVec3(cos_float(angle), 0, sin_float(angle)) * (disc + 1));
      world.translation.y += 0.75;
      scene_.instances.push_back({MeshId(random_.below(shapes_)), world.rounded()});
    }
    return static_cast<float>(disc + 1);
  }

 private:
  struct Opened {
    Map world;
    std::uint32_t group, parent, member;
  };

  std::uint32_t newest_group() {
    return static_cast<std::uint32_t>(scene_.groups.size()) - kVariants + random_.below(kVariants);
  }
  Map random_shape(const DVec3& at) {
    const DVec3 scale{random_.uniform(0.45f, 1.0f), random_.uniform(0.45f, 1.0f), random_.uniform(0.45f, 1.0f)};
    return {DMat3(random_rotation(random_)) * DMat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z), at};
  }
  /// Turned about the vertical, tilted a little, and every fourth mirrored.
  Map random_place(std::int64_t k, double radius, float most_tilt) {
    const float turn = random_.uniform(0, 2 * std::numbers::pi_v<float>), tilt = random_.uniform(-most_tilt, most_tilt);
    const double scale = random_.uniform(0.85f, 1.0f);
    const DMat3 upright(cos_float(turn), 0, -sin_float(turn), 0, 1, 0, sin_float(turn), 0, cos_float(turn));
    const DMat3 tilted(1, 0, 0, 0, cos_float(tilt), sin_float(tilt), 0, -sin_float(tilt), cos_float(tilt));
    const DMat3 scaled(k % 4 == 3 ? -scale : scale, 0, 0, 0, scale, 0, 0, 0, scale);
    return {upright * tilted * scaled, sunflower(k, kSpacing * radius)};
  }

  /// The groups of one depth, the deepest first.
  void define(std::int64_t at) {
    for (std::uint32_t variant = 0; variant < kVariants; ++variant) {
      Group& group = scene_.groups.emplace_back();
      std::vector<Map>& places = placed_.emplace_back();
      const auto first_below = static_cast<std::uint32_t>(at - 1) * kVariants;
      for (std::int64_t k = 0; k < members_; ++k) {
        if (at == 0) {
          group.members.push_back({false, random_.below(shapes_)});
          places.push_back(random_shape(sunflower(k, kSpacing * radius_)));
          places.back().translation.y = random_.uniform(-0.3f, 0.3f);
        } else {
          group.members.push_back({true, first_below + random_.below(kVariants)});
          places.push_back(random_place(k, radius_, 0.4f));
        }
      }
    }
    radius_ *= kSpacing * std::sqrt(double(members_));
  }

  /// Places a group with everything in it, depth first, so that the order of instances is that of the members.
  void open(const Opened& from) {
    const auto placement = static_cast<std::uint32_t>(scene_.placements.size());
    scene_.placements.push_back({from.group, from.world.rounded(), from.parent, from.member});
    const Group& group = scene_.groups[from.group];
    for (std::uint32_t m = 0; m < group.members.size(); ++m) {
      const Map world = from.world * placed_[from.group][m];
      if (group.members[m].is_group)
        open({world, group.members[m].index, placement, m});
      else
        scene_.instances.push_back({MeshId(group.members[m].index), world.rounded(), placement, m});
    }
  }

  Scene& scene_;
  HashRandom random_;
  std::int64_t instances_, members_;
  std::uint32_t shapes_;
  double radius_ = 0.5;                   // radius of the groups defined last; shapes are about so large
  std::vector<std::vector<Map>> placed_;  // by group: where its members stand in it
};

}  // namespace

float place_groups(Scene& scene, std::int64_t instances, std::int64_t seed, std::int64_t depth, std::uint32_t shapes) {
  scene.instances.reserve(static_cast<std::size_t>(instances) + 1);
  return Nested(scene, instances, seed, depth, shapes).place();
}

}  // namespace carousel::scene
