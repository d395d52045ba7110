// Traversal of many rays together: a list of rays at each node. The rays of a list are tested against the boxes of the
// node one after another, and the list is split among the children, without a choice that the processor would have to
// guess (Barringer, Akenine-Moeller 2014, "Dynamic ray stream traversal"). Lists are visited depth first, those with
// the nearest entries first. Rays that are few at a node go on by themselves, several in turn.
//
// A lane is a box. With a ray a lane, which gathers what the tests need of eight rays, the same lists took 1.03 times
// as long (docs/internals/performance.md).
#if defined(CAROUSEL_ACCEL_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_STREAM_INL_H_
#undef CAROUSEL_ACCEL_STREAM_INL_H_
#else
#define CAROUSEL_ACCEL_STREAM_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <memory>

#include <hwy/highway.h>

#include "accel/traverse/interleaved-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

inline constexpr std::uint32_t kStreamRays = 512;     ///< rays under way together; more are taken in turns
inline constexpr std::uint32_t kStreamRoom = 16'384;  ///< places in lists
inline constexpr std::uint32_t kFewRays = 8;          ///< a shorter list is not split
inline constexpr std::uint32_t kLaterRays = 32;       ///< rays of short lists that wait for one another

/// The part of a ray that its box tests read, in one cache line.
struct alignas(64) StreamRay {
  float origin[3], near[3], far[3];
  float tmin;
  float tmax;  ///< the hit's distance, or -inf once no hit is wanted any more
  std::uint8_t near_row[3], far_row[3];

  HWY_INLINE StreamRay(const SlabRay& slab, float end) : tmin(slab.tmin), tmax(end) {
    static_assert(6 * SlabRay::kRowBytes <= 256, "offsets of rows are bytes");
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = slab.origin[axis];
      near[axis] = slab.inverse_near[axis];
      far[axis] = slab.inverse_far[axis];
      near_row[axis] = static_cast<std::uint8_t>(slab.near_row[axis]);
      far_row[axis] = static_cast<std::uint8_t>(slab.far_row[axis]);
    }
  }
};

/// A ray of a list, and where it enters the list's node.
struct StreamItem {
  std::uint32_t ray;
  float entry;
};

/// The rays that are to visit a node: `count` places from `begin` on. Places from `free` on hold no list that is left.
struct StreamList {
  std::uint32_t ref, begin, count, free;
};

/// The storage of a stream, for one thread. Nothing of it is initialised.
struct StreamStorage {
  union {
    StreamRay rays[kStreamRays];
  };
  FrameStorage<SlabRay> frames[kStreamRays];
  RayRecord* records[kStreamRays];
  bool any_hit[kStreamRays];
  StreamItem items[kStreamRoom];
  StreamList lists[kStackCapacity];
  struct {
    StreamItem item;
    std::uint32_t ref;
  } later[kLaterRays];
  StreamStorage() {}
};

/// Takes rays through what is below a node.
class Stream {
 public:
  Stream(const Accel& accel, StreamStorage& storage, TraversalCounts& counts)
      : accel_(accel), s_(storage), counts_(counts) {}

  /// Traces members from `next` on through everything below `key`, as many as there is room for.
  void trace(NodeKey key, const RayMembers& members, std::size_t& next) {
    const std::uint32_t count = load(key, members, next);
    StreamList* top = s_.lists;
    *top++ = {key.ref.bits(), 0, count, count};
    // Above the instances no two walkers may have the same ray: each sets the instance of its frame.
    StreamList* const outside = s_.lists + kStackCapacity;
    StreamList* inside = key.instance != kNoInstance ? s_.lists : outside;  // lists from here on are below an instance
    while (top != s_.lists) {
      StreamList list = *--top;
      if (HWY_UNLIKELY(top < inside)) {
        walk();
        inside = outside;
      }
      list.count = keep(list);
      if (list.count == 0) continue;
      const NodeRef ref = NodeRef::from_bits(list.ref);
      if (HWY_UNLIKELY(ref.is_instance())) {
        if (NodeRef root = ref; enter(list, root)) {
          inside = top;
          *top++ = {root.bits(), list.begin, list.count, list.free};
        } else {
          put_off(list);
        }
      } else if (!ref.is_inner()) {
        test(ref, list);
      } else if (is_split(ref, list) && top <= outside - kMaxWidth) {
        top = split(accel_.nodes[ref.node()], list, top);
      } else {
        put_off(list);
      }
    }
    walk();
    for (std::uint32_t i = 0; i < count; ++i) settle(*s_.records[i]);
  }

 private:
  HWY_NOINLINE std::uint32_t load(NodeKey key, const RayMembers& members, std::size_t& next) {
    std::uint32_t n = 0;
    while (next < members.count && n < kStreamRays) {
      RayRecord& record = member<8>(members, next++);
      if (record.tag.flags & kRayDone) continue;
      LocalRay<SlabRay>* const frame = &s_.frames[n].ray;
      enter_frame(accel_, key.instance, record, frame, counts_);
      new (&s_.rays[n]) StreamRay(frame->slab, record.hit.t);
      s_.records[n] = &record;
      s_.any_hit[n] = takes_any_hit(record.tag);
      s_.items[n] = {n, frame->slab.tmin};
      ++n;
    }
    return n;
  }

  /// Drops the rays that have found something nearer, and returns how many are left.
  HWY_INLINE std::uint32_t keep(const StreamList& list) {
    StreamItem* const items = s_.items + list.begin;
    std::uint32_t left = 0;
    for (std::uint32_t i = 0; i < list.count; ++i) {
      const StreamItem item = items[i];
      items[left] = item;
      left += !(item.entry > s_.rays[item.ray].tmax);
    }
    return left;
  }

  /// The ray's range after a test.
  HWY_INLINE void note(std::uint32_t ray) {
    const Hit& hit = s_.records[ray]->hit;
    s_.rays[ray].tmax = s_.any_hit[ray] && hit.valid() ? -kInfinity : hit.t;
  }

  HWY_INLINE void test(NodeRef leaf, const StreamList& list) {
    for (std::uint32_t i = list.begin; i < list.begin + list.count; ++i) {
      const std::uint32_t ray = s_.items[i].ray;
      count_leaf(leaf, counts_);
      if (test_leaf(accel_, leaf, ~0u, s_.frames[ray].ray, s_.records[ray]->hit)) note(ray);
    }
  }

  /// enter_instance() for a list.
  HWY_NOINLINE bool enter(const StreamList& list, NodeRef& ref) {
    const NodeRef instance = ref;
    for (std::uint32_t i = list.begin; i < list.begin + list.count; ++i) {
      ref = instance;
      if (!enter_instance(accel_, ref, s_.frames[s_.items[i].ray].ray)) return false;
    }
    return true;
  }

  HWY_INLINE bool is_split(NodeRef ref, const StreamList& list) const {
    return list.count >= kFewRays && list.free + kMaxWidth * list.count <= kStreamRoom &&
           accel_.nodes[ref.node()].direct == 0;
  }

  /// Lets the rays of a list wait for others that go on by themselves.
  HWY_INLINE void put_off(const StreamList& list) {
    for (std::uint32_t i = list.begin; i < list.begin + list.count; ++i) {
      s_.later[later_++] = {s_.items[i], list.ref};
      if (later_ == kLaterRays) walk();
    }
    prefetch(accel_, NodeRef::from_bits(list.ref));
  }

  HWY_NOINLINE void walk() {
    std::uint32_t next = 0;
    take_turns<Nodes::kPlain, SlabRay>(
        accel_, stacks_, counts_,
        [&](Walker<SlabRay>& walker, std::size_t, NodeRef& from) HWY_ATTR {
          while (next < later_) {
            const auto& start = s_.later[next++];
            const std::uint32_t ray = start.item.ray;
            if (start.item.entry > s_.rays[ray].tmax) continue;
            walker.ray = ray;
            walker.frame = &s_.frames[ray].ray;
            walker.record = s_.records[ray];
            walker.any_hit = s_.any_hit[ray];
            from = NodeRef::from_bits(start.ref);
            return true;
          }
          return false;
        },
        [&](const Walker<SlabRay>& walker) HWY_ATTR { note(walker.ray); });
    later_ = 0;
  }

  /// Tests the rays of `list` against the node's boxes, and pushes the children's lists, the nearest on top by the mean
  /// of its entries.
  HWY_NOINLINE StreamList* split(const Node& node, const StreamList& list, StreamList* top) {
    const SlabLanes::Tag d;
    const hn::RebindToUnsigned<SlabLanes::Tag> du;
    constexpr std::size_t kLanes = hn::MaxLanes(d);
    StreamItem* out[kMaxWidth];
    for (std::uint32_t c = 0; c < kMaxWidth; ++c) out[c] = s_.items + list.free + c * list.count;
    SlabLanes::Vec sum[kMaxWidth / kLanes];
    for (SlabLanes::Vec& each : sum) each = hn::Zero(d);
    const std::uint32_t lanes = child_lanes(node);
    const char* const planes = reinterpret_cast<const char*>(&node.plane[0][0]);
    const auto plane = [&](std::uint8_t row, std::size_t i)
                           HWY_ATTR { return hn::Load(d, reinterpret_cast<const float*>(planes + row) + i); };
    for (std::uint32_t i = list.begin; i < list.begin + list.count; ++i) {
      const std::uint32_t id = s_.items[i].ray;
      const StreamRay& ray = s_.rays[id];
      std::uint32_t mask = 0;
      alignas(64) StreamItem met[kMaxWidth];
      // Operation for operation what slab_node() does.
      for (std::size_t l = 0; l < kMaxWidth; l += kLanes) {
        auto near = hn::Set(d, ray.tmin), far = hn::Set(d, ray.tmax);
        for (int axis = 0; axis < 3; ++axis) {
          const auto origin = hn::Set(d, ray.origin[axis]);
          near = keep_max(hn::Mul(hn::Sub(plane(ray.near_row[axis], l), origin), hn::Set(d, ray.near[axis])), near);
          far = keep_min(hn::Mul(hn::Sub(plane(ray.far_row[axis], l), origin), hn::Set(d, ray.far[axis])), far);
        }
        const auto hit = hn::Le(near, far);
        sum[l / kLanes] = hn::Add(sum[l / kLanes], hn::IfThenElseZero(hit, near));
        hn::StoreInterleaved2(hn::BitCast(d, hn::Set(du, id)), near, d, reinterpret_cast<float*>(met + l));
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hit, bits);
        mask |= std::uint32_t{bits[0]} << l;
      }
      mask &= lanes;
      // Every child's list is written, and grows if the ray meets it.
#pragma GCC unroll 8
      for (int c = 0; c < kMaxWidth; ++c) {
        *out[c] = met[c];
        out[c] += mask >> c & 1u;
      }
    }
    counts_.box += std::uint64_t{node.count} * list.count;
    alignas(64) float sums[kMaxWidth];
    for (std::size_t l = 0; l < kMaxWidth; l += kLanes) hn::Store(sum[l / kLanes], d, sums + l);
    return push_children(node, list, out, sums, top);
  }

  HWY_INLINE StreamList* push_children(const Node& node, const StreamList& list, StreamItem* const* ends,
                                       const float* sums, StreamList* top) {
    StreamList* const bottom = top;
    float means[kMaxWidth];
    const std::uint32_t free = list.free + kMaxWidth * list.count;
    for (std::uint32_t c = 0; c < node.count; ++c) {
      const std::uint32_t begin = list.free + c * list.count;
      const auto count = static_cast<std::uint32_t>(ends[c] - (s_.items + begin));
      if (count == 0) continue;
      const float mean = sums[c] / static_cast<float>(count);
      std::ptrdiff_t at = top++ - bottom;
      for (; at > 0 && means[at - 1] < mean; --at) {
        bottom[at] = bottom[at - 1];
        means[at] = means[at - 1];
      }
      bottom[at] = {node.child[c].bits(), begin, count, free};
      means[at] = mean;
      prefetch(accel_, node.child[c]);
    }
    return top;
  }

  const Accel& accel_;
  StreamStorage& s_;
  TraversalCounts& counts_;
  TraceStacks stacks_;
  std::uint32_t later_ = 0;
};

/// Traces the members together, each through everything below `key`, in a structure of plain nodes.
inline void trace_in_stream(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& total) {
  static thread_local const std::unique_ptr<StreamStorage> storage(new StreamStorage);
  TraversalCounts counts(members.culls);
  Stream stream(accel, *storage, counts);
  for (std::size_t next = 0; next < members.count;) stream.trace(key, members, next);
  total += counts;
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
