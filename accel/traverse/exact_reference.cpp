#include "accel/traverse/exact_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "accel/exact/crossing_filter.h"
#include "accel/exact/exact_crossing.h"
#include "accel/exact/exact_matrix.h"
#include "accel/exact/exact_sphere.h"
#include "accel/structure/sphere.h"
#include "accel/transform/transform.h"
#include "accel/traverse/ray_check.h"
#include "core/numeric/octahedral.h"

namespace carousel::accel {

namespace {

std::array<Vec3, 3> corners(const scene::Mesh& mesh, std::uint32_t primitive) {
  const std::uint32_t* const index = &mesh.indices[std::size_t{3} * primitive];
  return {mesh.positions[index[0]], mesh.positions[index[1]], mesh.positions[index[2]]};
}

const scene::Sphere& sphere_of(const scene::Mesh& mesh, std::uint32_t primitive) {
  return mesh.spheres[primitive - mesh.triangle_count()];
}

PlainTree tree_over(const scene::Mesh& mesh) {
  std::vector<WideBox> boxes;
  boxes.reserve(mesh.triangle_count() + mesh.spheres.size());
  const auto add = [&](const Aabb& from) {
    WideBox& box = boxes.emplace_back();
    for (int a = 0; a < 3; ++a) box.lo[a] = from.lo[a], box.hi[a] = from.hi[a];
  };
  for (std::uint32_t i = 0; i < mesh.triangle_count(); ++i) {
    Aabb box;
    for (const Vec3& p : corners(mesh, i)) box.extend(p);
    add(box);
  }
  for (const scene::Sphere& sphere : mesh.spheres) add(box_around(sphere.center, sphere.reach()));
  return PlainTree(boxes);
}

/// Where on a triangle or sphere a hit is.
struct Place {
  float u, v;
};
Place place_of(const ExactCrossing& crossing) {
  return {rounded_ratio<float>(crossing.weight[1], crossing.denominator),
          rounded_ratio<float>(crossing.weight[2], crossing.denominator)};
}
Place place_of(const ExactSphereCrossings& crossings, std::size_t k) {
  const Vec2 where = octahedral(crossings.normal(k));
  return {where.x, where.y};
}

/// The side that a crossed triangle shows: that of its winding in model space. An instance whose transform has no
/// inverse is traced in the world, where a mirror turns the winding.
bool shows_front(const ExactCrossing& crossing, const scene::Affine& placement) {
  InstanceTransform transform;
  const bool turned = make_transform(placement, transform) && ExactAdjugate(placement).determinant.sign() < 0;
  return crossing.front != turned;
}

}  // namespace

ExactReference::ExactReference(const scene::Scene& scene, const AnyHit* any_hit)
    : scene_(scene), any_hit_(any_hit), opacity_(scene) {
  for (const scene::Mesh& mesh : scene.meshes) meshes_.push_back(tree_over(mesh));
  std::vector<WideBox> boxes;
  for (const scene::Instance& instance : scene.instances) {
    const PlainTree& tree = meshes_[instance.mesh.value];
    boxes.push_back(tree.empty() ? WideBox{} : tree.node(0).box.placed(instance.world_from_model));
  }
  instances_ = PlainTree(boxes);
}

/// One ray on its way.
class ExactReference::Search {
 public:
  Search(const ExactReference& reference, const Ray& ray, std::uint8_t flags)
      : reference_(reference), scene_(reference.scene_), ray_(ray), flags_(flags) {
    best_.t_hi = ray.tmax;
  }

  ExactHit run() {
    walk(
        reference_.instances_, [](const WideBox& box) { return box; },
        [&](std::uint32_t instance) {
          const PlainTree& mesh = reference_.meshes_[scene_.instances[instance].mesh.value];
          if (mesh.empty()) return;
          walk(
              mesh, [&](const WideBox& box) { return box.placed(placement(instance)); },
              [&](std::uint32_t primitive) { test(instance, primitive); });
        });
    return answer();
  }

 private:
  struct Best {
    std::uint32_t instance = kNoInstance, primitive = 0;
    double t_lo = 0, t_hi = 0;
    bool tie = false;
    std::optional<ExactRoot> t;  // set once it has been computed
    std::optional<Place> place;  // likewise
  };

  /// Visits the items of a tree that the ray may meet before the best hit, nearest boxes first.
  template <class Placed, class Visit>
  void walk(const PlainTree& tree, const Placed& placed, const Visit& visit) const {
    struct Entry {
      std::uint32_t node;
      double entry;
    };
    if (tree.empty()) return;
    std::vector<Entry> stack{{0, ray_.tmin}};
    while (!stack.empty()) {
      const Entry top = stack.back();
      stack.pop_back();
      if (top.entry > best_.t_hi) continue;
      const PlainTree::Node& node = tree.node(top.node);
      if (node.count > 0) {
        for (const std::uint32_t item : tree.items(node)) visit(item);
        continue;
      }
      for (std::uint32_t child = node.first; child < node.first + 2; ++child)
        if (double entry; placed(tree.node(child).box).meets(ray_, best_.t_hi, entry)) stack.push_back({child, entry});
      if (const std::size_t n = stack.size(); n >= 2 && stack[n - 2].entry < stack[n - 1].entry)
        std::swap(stack[n - 2], stack[n - 1]);
    }
  }

  const scene::Mesh& mesh_of(std::uint32_t instance) const {
    return scene_.meshes[scene_.instances[instance].mesh.value];
  }
  const scene::Affine& placement(std::uint32_t instance) const { return scene_.instances[instance].world_from_model; }
  bool culls(bool front) const { return (flags_ & (front ? kRayCullFront : kRayCullBack)) != 0; }

  void test(std::uint32_t instance, std::uint32_t primitive) {
    if (primitive >= mesh_of(instance).triangle_count()) return test_sphere(instance, primitive);
    const FilteredCrossing filtered =
        filtered_crossing(ray_, corners(mesh_of(instance), primitive), placement(instance));
    if (filtered.verdict == FilteredCrossing::Verdict::kMiss) return;
    Best found{instance, primitive, filtered.t_lo, filtered.t_hi, false, std::nullopt, std::nullopt};
    std::optional<ExactCrossing> crossing;
    if (filtered.verdict == FilteredCrossing::Verdict::kUnsure) {
      crossing = crossing_of(found);
      if (!crossing) return;
      set(found, *crossing);
      bound(found);
    }
    consider(found, [&] {
      if (!crossing) crossing = crossing_of(found);
      set(found, *crossing);
      if ((flags_ & (kRayCullFront | kRayCullBack)) != 0 && culls(shows_front(*crossing, placement(instance))))
        return false;
      return stops(found, reference_.opacity_.may_be_non_opaque(mesh_of(instance), primitive));
    });
  }

  void test_sphere(std::uint32_t instance, std::uint32_t primitive) {
    const scene::Sphere& sphere = sphere_of(mesh_of(instance), primitive);
    const std::optional<ExactSphereCrossings> crossings = exact_sphere(ray_, sphere, placement(instance));
    if (!crossings) return;
    for (std::size_t k = 0; k < 2; ++k) {
      Best found{instance, primitive, 0, 0, false, crossings->t[k], std::nullopt};
      bound(found);
      consider(found, [&] {
        if (culls(k == 0)) return false;
        found.place = place_of(*crossings, k);
        return stops(found, reference_.opacity_.may_be_non_opaque(sphere));
      });
    }
  }

  /// Makes `found` the best hit if it is, and if the ray `stops_there`, which also sets its place.
  template <class Stops>
  void consider(Best& found, const Stops& stops_there) {
    if (!in_range(found)) return;
    const int order = best_.instance == kNoInstance ? -1 : compare(found, best_);
    if (order > 0 || !stops_there()) return;
    if (order == 0) {
      // The way in and the way out of a sphere that is touched are one hit.
      const bool another = found.instance != best_.instance || found.primitive != best_.primitive;
      best_.tie |= another;
      found.tie = best_.tie;
      if (std::pair(found.instance, found.primitive) >= std::pair(best_.instance, best_.primitive)) return;
    }
    best_ = std::move(found);
  }

  bool stops(const Best& found, bool may_be_non_opaque) const {
    if (!may_be_non_opaque || reference_.any_hit_ == nullptr || (flags_ & kRayForceOpaque) != 0) return true;
    return reference_.any_hit_->accepts(ray_, found.instance, found.primitive, found.place->u, found.place->v);
  }

  std::optional<ExactCrossing> crossing_of(const Best& of) const {
    return exact_crossing(ray_, corners(mesh_of(of.instance), of.primitive), placement(of.instance));
  }
  static void set(Best& of, const ExactCrossing& crossing) {
    of.t = ExactRoot{crossing.numerator, crossing.denominator};
    of.place = place_of(crossing);
  }
  static void bound(Best& of) {
    const double t = of.t->rounded<double>();
    of.t_lo = std::nextafter(t, -HUGE_VAL);
    of.t_hi = std::nextafter(t, HUGE_VAL);
  }
  /// Computed at the first call for a triangle.
  const ExactRoot& t_of(Best& of) const {
    if (!of.t) set(of, *crossing_of(of));
    return *of.t;
  }
  bool in_range(Best& found) const {
    if (found.t_hi < ray_.tmin || found.t_lo > ray_.tmax) return false;
    if (found.t_lo < ray_.tmin && t_of(found).compare(ray_.tmin) < 0) return false;
    return found.t_hi <= ray_.tmax || t_of(found).compare(ray_.tmax) <= 0;
  }
  int compare(Best& a, Best& b) const {
    if (a.t_hi < b.t_lo) return -1;
    if (a.t_lo > b.t_hi) return 1;
    return t_of(a).compare(t_of(b));
  }

  ExactHit answer() {
    ExactHit out;
    if (best_.instance == kNoInstance) return out;
    const ExactRoot& t = t_of(best_);
    out.hit = {t.rounded<float>(), best_.place->u, best_.place->v, best_.instance, best_.primitive};
    out.t = t.rounded<double>();
    out.tie = best_.tie;
    return out;
  }

  const ExactReference& reference_;
  const scene::Scene& scene_;
  const Ray& ray_;
  const std::uint8_t flags_;
  Best best_;
};

ExactHit ExactReference::closest(const Ray& ray, std::uint8_t flags) const {
  return valid(ray) ? Search(*this, ray, flags).run() : ExactHit{};
}

bool ExactOpacity::accepts(const Ray& ray, std::uint32_t instance, std::uint32_t primitive, float u, float v) const {
  const scene::Mesh& mesh = scene_.meshes[scene_.instances[instance].mesh.value];
  const scene::Affine& placement = scene_.instances[instance].world_from_model;
  Place at{u, v};
  if (primitive < mesh.triangle_count()) {
    if (const auto crossing = exact_crossing(ray, corners(mesh, primitive), placement)) at = place_of(*crossing);
  } else if (const auto crossings = exact_sphere(ray, sphere_of(mesh, primitive), placement)) {
    const Place in = place_of(*crossings, 0), way_out = place_of(*crossings, 1);
    const DVec3 here = from_octahedral(u, v);
    const auto cosine = [&](const Place& p) { return glm::dot(from_octahedral(p.u, p.v), here); };
    at = cosine(in) >= cosine(way_out) ? in : way_out;
  }
  return asked_.accepts(ray, instance, primitive, at.u, at.v);
}

}  // namespace carousel::accel
