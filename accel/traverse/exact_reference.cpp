#include "accel/traverse/exact_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "accel/exact/crossing_filter.h"
#include "accel/exact/exact_crossing.h"
#include "accel/traverse/ray_check.h"

namespace carousel::accel {

namespace {

constexpr double kEps = 0x1p-53;

/// A box in world space that holds the exact one.
struct WideBox {
  double lo[3], hi[3];
};

/// The boxes of a structure in the world: R box + T, in double and widened.
class Placement {
 public:
  Placement() = default;
  Placement(const scene::Affine& m, double margin) : margin_(margin) {
    for (int row = 0; row < 3; ++row) {
      translation_[row] = m.translation[row];
      for (int c = 0; c < 3; ++c) linear_[row][c] = m.linear[c][row];
    }
  }

  WideBox place(const Node& node, int lane) const {
    double centre[3], half[3];
    for (int c = 0; c < 3; ++c) {
      const double lo = node.plane[c][lane], hi = node.plane[c + 3][lane];
      centre[c] = (lo + hi) / 2;
      half[c] = (hi - lo) / 2;
    }
    WideBox box;
    for (int row = 0; row < 3; ++row) {
      double at = translation_[row], reach = 0, terms = std::fabs(at);
      for (int c = 0; c < 3; ++c) {
        at += linear_[row][c] * centre[c];
        reach += std::fabs(linear_[row][c]) * half[c];
        terms += std::fabs(linear_[row][c]) * (std::fabs(centre[c]) + half[c]);
      }
      reach += 16 * kEps * terms + margin_;  // about ten roundings
      box.lo[row] = at - reach;
      box.hi[row] = at + reach;
    }
    return box;
  }

 private:
  double linear_[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  double translation_[3] = {0, 0, 0};
  double margin_ = 0;
};

/// True if the line meets the box between tmin and tmax, or nearly so; `entry` is no later than the exact entry.
bool meets(const Ray& ray, const WideBox& box, double tmin, double tmax, double& entry) {
  double near = tmin, far = tmax;
  for (int a = 0; a < 3; ++a) {
    const double o = ray.origin[a], d = ray.direction[a];
    if (d == 0) {
      if (o < box.lo[a] || o > box.hi[a]) return false;
      continue;
    }
    const double t0 = (box.lo[a] - o) / d, t1 = (box.hi[a] - o) / d;
    const double first = std::min(t0, t1), last = std::max(t0, t1);
    near = std::max(near, first - 4 * kEps * std::fabs(first));
    far = std::min(far, last + 4 * kEps * std::fabs(last));
  }
  entry = near;
  return near <= far;
}

}  // namespace

ExactReference::ExactReference(const scene::Scene& scene, const Accel& accel)
    : scene_(scene), accel_(accel), baked_off_(scene.instances.size(), 0.0) {
  double largest = 0;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const scene::Affine& m = scene.instances[i].world_from_model;
    if (!accel.instances[i].transform.identity || (m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f))) continue;
    for (const Vec3& p : scene.meshes[scene.instances[i].mesh.value].positions)
      for (int row = 0; row < 3; ++row) {
        double terms = std::fabs(m.translation[row]);
        for (int c = 0; c < 3; ++c) terms += std::fabs(double(m.linear[c][row]) * p[c]);
        baked_off_[i] = std::max(baked_off_[i], 0x1p-21 * terms + 0x1p-140);  // four roundings to float, or underflow
      }
    largest = std::max(largest, baked_off_[i]);
  }
  baked_off_.resize(accel.instances.size(), largest);  // of groups: there may be any instance in them
}

/// One ray on its way.
class ExactReference::Search {
 public:
  Search(const ExactReference& reference, const Ray& ray)
      : scene_(reference.scene_), accel_(reference.accel_), baked_off_(reference.baked_off_), ray_(ray) {
    best_.t_hi = ray.tmax;
  }

  ExactHit run() {
    std::vector<Entry> stack{{accel_.root_key(), ray_.tmin}};
    while (!stack.empty()) {
      const Entry top = stack.back();
      stack.pop_back();
      if (top.entry > best_.t_hi) continue;
      if (top.key.ref.is_inner())
        open(top.key, stack);
      else if (!top.key.ref.is_procedural())
        test(top.key);
    }
    return answer();
  }

 private:
  struct Entry {
    NodeKey key;
    double entry;
  };
  struct Best {
    std::uint32_t instance = kNoInstance, primitive = 0;
    double t_lo = 0, t_hi = 0;
    bool tie = false;
    std::optional<ExactCrossing> crossing;  // set once it has been computed
  };

  std::array<Vec3, 3> vertices(std::uint32_t instance, std::uint32_t primitive) const {
    const scene::Mesh& mesh = scene_.meshes[scene_.instances[instance].mesh.value];
    const std::uint32_t* const index = &mesh.indices[std::size_t{3} * primitive];
    return {mesh.positions[index[0]], mesh.positions[index[1]], mesh.positions[index[2]]};
  }
  const scene::Affine& placement(std::uint32_t instance) const { return scene_.instances[instance].world_from_model; }

  void open(NodeKey key, std::vector<Entry>& stack) {
    if (key.instance != placed_for_) {
      placed_for_ = key.instance;
      if (key.instance == kNoInstance)
        placed_ = Placement();
      else if (accel_.is_group(key.instance))
        placed_ = Placement(scene_.placements[accel_.group(key.instance).placement].world_from_group,
                            baked_off_[key.instance]);
      else if (accel_.instances[key.instance].transform.identity)  // baked, or placed nowhere
        placed_ = Placement(scene::Affine{}, baked_off_[key.instance]);
      else
        placed_ = Placement(placement(key.instance), 0);
    }
    const Node& node = accel_.nodes[key.ref.node()];
    const std::size_t first = stack.size();
    for (int lane = 0; lane < node.count; ++lane) {
      WideBox box = placed_.place(node, lane);
      if (const NodeRef child = node.child[lane]; child.is_instance())
        for (int a = 0; a < 3; ++a) {
          const double off = baked_off_[accel_.instance_at(key.instance, child)];
          box.lo[a] -= off;
          box.hi[a] += off;
        }
      double entry;
      if (meets(ray_, box, ray_.tmin, best_.t_hi, entry)) stack.push_back({accel_.child_key(key, lane), entry});
    }
    std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end(),
              [](const Entry& a, const Entry& b) { return a.entry > b.entry; });
  }

  void test(NodeKey leaf) {
    for (std::uint32_t b = 0; b < leaf.ref.blocks(); ++b)
      for (const std::uint32_t primitive : accel_.blocks[leaf.ref.first_block() + b].primitive)
        if (primitive != kNoPrimitive) test_named(leaf.instance, primitive & kPrimitiveMask);
  }
  void test_named(std::uint32_t instance, std::uint32_t primitive) {
    if (instance != kNoInstance) return test(instance, primitive);
    const MergedMeshes::Name name = accel_.merged.name(primitive);
    test(name.instance, name.primitive);
  }

  void test(std::uint32_t instance, std::uint32_t primitive) {
    const std::array<Vec3, 3> p = vertices(instance, primitive);
    const FilteredCrossing filtered = filtered_crossing(ray_, p, placement(instance));
    if (filtered.verdict == FilteredCrossing::Verdict::kMiss) return;
    Best found{instance, primitive, filtered.t_lo, filtered.t_hi, false, std::nullopt};
    if (filtered.verdict == FilteredCrossing::Verdict::kUnsure) {
      found.crossing = exact_crossing(ray_, p, placement(instance));
      if (!found.crossing) return;
      found.t_lo = found.t_hi = rounded_ratio<double>(found.crossing->numerator, found.crossing->denominator);
      found.t_lo = std::nextafter(found.t_lo, -HUGE_VAL);
      found.t_hi = std::nextafter(found.t_hi, HUGE_VAL);
    }
    if (!in_range(found)) return;
    if (best_.instance == kNoInstance) {
      best_ = std::move(found);
      return;
    }
    const int order = compare(found, best_);
    if (order > 0) return;
    const bool first = std::pair(instance, primitive) < std::pair(best_.instance, best_.primitive);
    if (order < 0 || first) {
      found.tie = order == 0;
      best_ = std::move(found);
    } else {
      best_.tie = true;
    }
  }

  const ExactCrossing& crossing(Best& of) const {
    if (!of.crossing) of.crossing = exact_crossing(ray_, vertices(of.instance, of.primitive), placement(of.instance));
    return *of.crossing;
  }
  bool in_range(Best& found) const {
    if (found.t_hi < ray_.tmin || found.t_lo > ray_.tmax) return false;
    if (found.t_lo < ray_.tmin && crossing(found).compare(ray_.tmin) < 0) return false;
    return found.t_hi <= ray_.tmax || crossing(found).compare(ray_.tmax) <= 0;
  }
  int compare(Best& a, Best& b) const {
    if (a.t_hi < b.t_lo) return -1;
    if (a.t_lo > b.t_hi) return 1;
    return crossing(a).compare(crossing(b));
  }

  ExactHit answer() {
    ExactHit out;
    if (best_.instance == kNoInstance) return out;
    const ExactCrossing& c = crossing(best_);
    out.hit.instance = best_.instance;
    out.hit.primitive = best_.primitive;
    out.hit.t = rounded_ratio<float>(c.numerator, c.denominator);
    out.hit.u = rounded_ratio<float>(c.weight[1], c.denominator);
    out.hit.v = rounded_ratio<float>(c.weight[2], c.denominator);
    out.t = rounded_ratio<double>(c.numerator, c.denominator);
    out.tie = best_.tie;
    return out;
  }

  const scene::Scene& scene_;
  const Accel& accel_;
  const std::vector<double>& baked_off_;
  const Ray& ray_;
  Best best_;
  Placement placed_;
  std::uint32_t placed_for_ = kNoInstance;
};

ExactHit ExactReference::closest(const Ray& ray) const {
  return valid(ray) ? Search(*this, ray).run() : ExactHit{};
}

}  // namespace carousel::accel
