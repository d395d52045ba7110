#include "accel/box/bundle_intersect.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <type_traits>

#include "accel/box/bundle_interval.h"
#include "accel/box/bundle_silhouette.h"
#include "accel/structure/cull_plane.h"

namespace carousel::accel {
namespace {

// Boxes are tested four at a time.
constexpr int kGroup = 4;
using Float4 = float __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));
template <class Real>
using Lanes = std::conditional_t<std::is_same_v<Real, float>, Float4, Double4>;

template <class Real>
BoxPlanes<Lanes<Real>> planes_of(const Node& node, int first) {
  BoxPlanes<Lanes<Real>> planes;
  for (int axis = 0; axis < 3; ++axis) {
    Float4 lo, hi;
    std::memcpy(&lo, &node.plane[axis][first], sizeof(lo));
    std::memcpy(&hi, &node.plane[axis + 3][first], sizeof(hi));
    planes.lo[axis] = __builtin_convertvector(lo, Lanes<Real>);
    planes.hi[axis] = __builtin_convertvector(hi, Lanes<Real>);
  }
  return planes;
}

template <class Mask>
std::uint32_t bits_of(const Mask& mask) {
  std::uint32_t bits = 0;
  for (int lane = 0; lane < kGroup; ++lane) bits |= static_cast<std::uint32_t>(mask[lane] & 1) << lane;
  return bits;
}

/// The interval form at one level of accuracy. Lanes of its functions are those from `first` on; they answer for
/// `lanes` and maybe others.
template <class Real>
class IntervalForm {
 public:
  IntervalForm(const BundleRecord& bundle, float widening, bool strict) : computed_(bundle, widening) {
    if (strict) exact_.emplace(bundle, 1.0f);
  }
  std::uint32_t all_miss(const Node& node, int first, std::uint32_t lanes) {
    passes_ += static_cast<unsigned>(std::popcount(lanes));
    return bits_of(computed_.all_miss(planes_of<Real>(node, first)));
  }
  std::uint32_t all_hit(const Node& node, int first, std::uint32_t lanes) {
    passes_ += static_cast<unsigned>(std::popcount(lanes));
    std::uint32_t hit = bits_of(computed_.all_hit(planes_of<Real>(node, first)));
    if (exact_ && (hit & lanes) != 0) hit &= bits_of(exact_->all_hit_exactly(planes_of<double>(node, first)));
    return hit;
  }
  void entries(const Node& node, int first, std::uint32_t lanes, float* out) {
    const Lanes<Real> entry = computed_.entry(planes_of<Real>(node, first));
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      out[lane] = round_up(entry[lane]);
    }
  }
  unsigned edges() const { return 0; }
  unsigned passes() const { return passes_; }

 private:
  BundleInterval<Real> computed_;
  std::optional<BundleInterval<double>> exact_;
  unsigned passes_ = 0;
};

/// The silhouette form. Its claims that all rays hit are exact, with or without `strict`.
template <class Real>
class SilhouetteForm {
 public:
  SilhouetteForm(const BundleRecord& bundle, BoxLevel level, BundlesConfig::Edges edges)
      : silhouette_(bundle, level, edges),
        interval_(bundle, far_widening(level), false),
        edge_by_edge_(edges == BundlesConfig::Edges::kSerial) {}
  std::uint32_t all_miss(const Node& node, int first, std::uint32_t lanes) {
    return of_each(lanes, [&](int lane) { return silhouette_.all_miss(child_box(node, first + lane), edges_); });
  }
  std::uint32_t all_hit(const Node& node, int first, std::uint32_t lanes) {
    return of_each(lanes, [&](int lane) { return silhouette_.all_hit(child_box(node, first + lane), edges_); });
  }
  void entries(const Node& node, int first, std::uint32_t lanes, float* out) {
    interval_.entries(node, first, lanes, out);
  }
  unsigned edges() const { return edges_; }
  unsigned passes() const { return passes_; }

 private:
  template <class Holds>
  std::uint32_t of_each(std::uint32_t lanes, const Holds& holds) {
    std::uint32_t out = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const unsigned before = edges_;
      if (holds(lane)) out |= 1u << lane;
      // A box whose distance or direction decides takes a pass as well.
      passes_ += edge_by_edge_ ? std::max(1u, edges_ - before) : 1u;
    }
    return out;
  }

  BundleSilhouette silhouette_;
  IntervalForm<Real> interval_;
  bool edge_by_edge_;
  unsigned edges_ = 0, passes_ = 0;
};

struct Verdicts {
  std::uint32_t all, undecided;
  unsigned first_passes;
};

/// Tests four boxes in the configured order; each test counts for the lanes it is applied to.
template <class Form>
Verdicts verdicts(Form& form, const Node& node, int first, std::uint32_t lanes, BundlesConfig::Order order,
                  IntersectionCounts& counts) {
  using Order = BundlesConfig::Order;
  const auto hit_among = [&](std::uint32_t among) {
    counts.bundle += static_cast<std::uint64_t>(std::popcount(among));
    return among == 0 ? 0 : among & form.all_hit(node, first, among);
  };
  const auto possible_among = [&](std::uint32_t among) {
    counts.bundle += static_cast<std::uint64_t>(std::popcount(among));
    return among == 0 ? 0 : among & ~form.all_miss(node, first, among);
  };
  switch (order) {
    case Order::kAllHitFirst: {
      const std::uint32_t all = hit_among(lanes);
      const unsigned passes = form.passes();
      return {all, possible_among(lanes & ~all), passes};
    }
    case Order::kAnyHitFirst: {
      const std::uint32_t possible = possible_among(lanes);
      const unsigned passes = form.passes();
      const std::uint32_t all = hit_among(possible);
      return {all, possible & ~all, passes};
    }
    case Order::kParallel: {
      const std::uint32_t all = hit_among(lanes);
      const unsigned passes = form.passes();
      const std::uint32_t possible = possible_among(lanes);
      return {all & possible, possible & ~all, passes};
    }
    case Order::kAllHitOnly: {
      const std::uint32_t all = hit_among(lanes);
      return {all, lanes & ~all, form.passes()};
    }
    case Order::kAnyHitOnly: {
      const std::uint32_t possible = possible_among(lanes);
      return {possible, 0, form.passes()};
    }
  }
  return {0, lanes, 0};
}

template <class Form>
BundleAnswer answer(Form form, const Node& node, std::uint32_t lanes, BundlesConfig::Order order,
                    IntersectionCounts& counts) {
  BundleAnswer out;
  lanes &= (1u << node.count) - 1;
  for (int first = 0; first < kMaxWidth; first += kGroup) {
    const std::uint32_t group = lanes >> first & ((1u << kGroup) - 1);
    if (group == 0) continue;
    const unsigned before = form.passes();
    const Verdicts found = verdicts(form, node, first, group, order, counts);
    out.first_passes = static_cast<std::uint8_t>(out.first_passes + found.first_passes - before);
    out.second_passes = static_cast<std::uint8_t>(out.second_passes + form.passes() - found.first_passes);
    out.all |= static_cast<std::uint8_t>(found.all << first);
    out.undecided |= static_cast<std::uint8_t>(found.undecided << first);
    if (found.all != 0) form.entries(node, first, found.all, out.entry + first);
  }
  out.edges = static_cast<std::uint8_t>(form.edges());  // twelve a lane at most
  return out;
}

template <class Real>
BundleAnswer answer_as(BoxLevel level, const Node& node, std::uint32_t lanes, const BundleRecord& bundle,
                       const BundlesConfig& config, IntersectionCounts& counts) {
  if (config.form == BundlesConfig::Form::kSilhouette && bundle.count != 1 && BundleSilhouette::applies(bundle)) {
    const std::uint64_t before = counts.bundle;
    BundleAnswer out = answer(SilhouetteForm<Real>(bundle, level, config.edges), node, lanes, config.order, counts);
    out.silhouettes = true;
    counts.silhouettes += counts.bundle - before;
    counts.edges += out.edges;
    counts.reciprocals += static_cast<std::uint64_t>(std::popcount(out.all));
    return out;
  }
  counts.reciprocals += kDirectionDivisions;
  return answer(IntervalForm<Real>(bundle, far_widening(level), config.strict), node, lanes, config.order, counts);
}

}  // namespace

BundleAnswer test_bundle(const Accel& accel, const Node& node, std::uint32_t lanes, const BundleRecord& bundle,
                         const BundlesConfig& config, IntersectionCounts& counts) {
  const BoxLevel level = accel.accuracy.box;
  if (level == BoxLevel::kDouble) return answer_as<double>(level, node, lanes, bundle, config, counts);
  return answer_as<float>(level, node, lanes, bundle, config, counts);
}

}  // namespace carousel::accel
