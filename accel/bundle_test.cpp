#include "accel/bundle_test.h"

#include <bit>
#include <optional>

#include "accel/bundle_interval.h"
#include "accel/bundle_silhouette.h"
#include "accel/cull_plane.h"

namespace carousel::accel {
namespace {

/// The interval form at one level of accuracy.
template <class Real>
class IntervalForm {
 public:
  IntervalForm(const BundleRecord& bundle, float widening, bool strict) : computed_(bundle, widening) {
    if (strict) exact_.emplace(bundle, 1.0f);
  }
  bool all_miss(const Aabb& box) { return computed_.all_miss(box); }
  bool all_hit(const Aabb& box) { return computed_.all_hit(box) && (!exact_ || exact_->all_hit_exactly(box)); }
  float entry(const Aabb& box) { return computed_.entry(box); }
  unsigned edges() const { return 0; }

 private:
  BundleInterval<Real> computed_;
  std::optional<BundleInterval<double>> exact_;
};

/// The silhouette form. What it claims of all rays to hit is exact: strict or not is the same.
template <class Real>
class SilhouetteForm {
 public:
  SilhouetteForm(const BundleRecord& bundle, BoxLevel level, BundlesConfig::Edges edges)
      : silhouette_(bundle, level, edges), interval_(bundle, far_widening(level)) {}
  bool all_miss(const Aabb& box) { return silhouette_.all_miss(box, edges_); }
  bool all_hit(const Aabb& box) { return silhouette_.all_hit(box, edges_); }
  float entry(const Aabb& box) { return interval_.entry(box); }
  unsigned edges() const { return edges_; }

 private:
  BundleSilhouette silhouette_;
  BundleInterval<Real> interval_;
  unsigned edges_ = 0;
};

enum class Verdict { kMiss, kAll, kUndecided };

/// One box, in the order that is asked for.
template <class Form>
Verdict verdict(Form& form, const Aabb& box, BundlesConfig::Order order, TestCounts& counts) {
  using Order = BundlesConfig::Order;
  ++counts.bundle;
  switch (order) {
    case Order::kAllHitFirst:
      if (form.all_hit(box)) return Verdict::kAll;
      ++counts.bundle;
      return form.all_miss(box) ? Verdict::kMiss : Verdict::kUndecided;
    case Order::kAnyHitFirst:
      if (form.all_miss(box)) return Verdict::kMiss;
      ++counts.bundle;
      return form.all_hit(box) ? Verdict::kAll : Verdict::kUndecided;
    case Order::kParallel:
      ++counts.bundle;
      return form.all_miss(box) ? Verdict::kMiss : form.all_hit(box) ? Verdict::kAll : Verdict::kUndecided;
    case Order::kAllHitOnly: return form.all_hit(box) ? Verdict::kAll : Verdict::kUndecided;
    case Order::kAnyHitOnly: return form.all_miss(box) ? Verdict::kMiss : Verdict::kAll;
  }
  return Verdict::kUndecided;
}

template <class Form>
BundleAnswer answer(Form form, const Node& node, std::uint32_t lanes, BundlesConfig::Order order,
                    TestCounts& counts) {
  BundleAnswer out;
  for (lanes &= (1u << node.count) - 1; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    const Aabb box = child_box(node, lane);
    const Verdict found = verdict(form, box, order, counts);
    if (found == Verdict::kMiss) continue;
    (found == Verdict::kAll ? out.all : out.undecided) |= static_cast<std::uint8_t>(1u << lane);
    if (found == Verdict::kAll) out.entry[lane] = form.entry(box);
  }
  out.edges = static_cast<std::uint8_t>(form.edges());   // twelve a lane at most
  return out;
}

template <class Real>
BundleAnswer answer_as(BoxLevel level, const Node& node, std::uint32_t lanes, const BundleRecord& bundle,
                       const BundlesConfig& config, TestCounts& counts) {
  if (config.form == BundlesConfig::Form::kSilhouette && bundle.count != 1 && BundleSilhouette::applies(bundle))
    return answer(SilhouetteForm<Real>(bundle, level, config.edges), node, lanes, config.order, counts);
  return answer(IntervalForm<Real>(bundle, far_widening(level), config.strict), node, lanes, config.order, counts);
}

}  // namespace

BundleAnswer test_bundle(const Accel& accel, const Node& node, std::uint32_t lanes, const BundleRecord& bundle,
                         const BundlesConfig& config, TestCounts& counts) {
  const BoxLevel level = accel.accuracy.box;
  if (level == BoxLevel::kDouble) return answer_as<double>(level, node, lanes, bundle, config, counts);
  return answer_as<float>(level, node, lanes, bundle, config, counts);
}

}  // namespace carousel::accel
