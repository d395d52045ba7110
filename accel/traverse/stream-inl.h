// Traversal of many rays together: a list of rays at each node. A register full of rays of a list is tested against
// each box of the node, and the list is split among the children, without a choice that the processor would have to
// guess (Barringer, Akenine-Moeller 2014, "Dynamic ray stream traversal"). Lists are visited depth first, those with
// the nearest entries first. Rays that are few at a node go on by themselves, several in turn.
//
// With registers of fewer than sixteen lanes that takes longer than all rays by themselves
// (docs/internals/performance.md).
#if defined(CAROUSEL_ACCEL_STREAM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_STREAM_INL_H_
#undef CAROUSEL_ACCEL_STREAM_INL_H_
#else
#define CAROUSEL_ACCEL_STREAM_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <hwy/highway.h>

#include "accel/traverse/interleaved-inl.h"
#include "accel/traverse/ray_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

inline constexpr std::uint32_t kStreamRays = 2048;     ///< rays under way together; more are taken in turns
inline constexpr std::uint32_t kStreamRoom = 131'072;  ///< places in lists
inline constexpr std::uint32_t kFewRays = 8;           ///< a shorter list is not split
inline constexpr std::uint32_t kFewRaysOfLeaf = 3;     ///< a shorter list is not tested in lanes
inline constexpr std::uint32_t kLaterRays = 128;       ///< rays of short lists that wait for one another

#if HWY_MAX_BYTES >= 64

/// The rays that are to visit a node: `count` places from `begin` on, and room for a register's more. Places from
/// `free` on hold no list that is left. `changes` of hits were made before the list.
struct StreamList {
  std::uint32_t ref, begin, count, free, changes;
};

/// The storage of a stream, for one thread. Nothing of it is initialised.
struct StreamStorage {
  union {
    StreamRay rays[kStreamRays];
  };
  FrameStorage<SlabRay> frames[kStreamRays];
  RayRecord* records[kStreamRays];
  bool any_hit[kStreamRays];
  // The places: numbers of rays, and where they enter the list's node.
  std::uint32_t ids[kStreamRoom + kMostRayLanes];
  float entries[kStreamRoom + kMostRayLanes];
  StreamList lists[kStackCapacity];
  struct {
    std::uint32_t ray, ref;
    float entry;
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
    *top++ = {key.ref.bits(), 0, count, count + kMostRayLanes, changes_};
    // Above the instances no two walkers may have the same ray: each sets the instance of its frame.
    StreamList* const outside = s_.lists + kStackCapacity;
    StreamList* inside = key.instance != kNoInstance ? s_.lists : outside;  // lists from here on are below an instance
    while (top != s_.lists) {
      StreamList list = *--top;
      if (HWY_UNLIKELY(top < inside)) {
        walk();
        inside = outside;
      }
      if (list.changes != changes_) list.count = keep(list);
      if (list.count == 0) continue;
      const NodeRef ref = NodeRef::from_bits(list.ref);
      if (HWY_UNLIKELY(ref.is_instance())) {
        if (NodeRef root = ref; enter(list, root)) {
          inside = top;
          *top++ = {root.bits(), list.begin, list.count, list.free, changes_};
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
      RayRecord& record = member<16>(members, next++);
      if (record.tag.flags & kRayDone) continue;
      LocalRay<SlabRay>* const frame = &s_.frames[n].ray;
      enter_frame(accel_, key.instance, record, frame, counts_);
      new (&s_.rays[n]) StreamRay(*frame, record.hit.t);
      s_.records[n] = &record;
      s_.any_hit[n] = takes_any_hit(record.tag);
      s_.ids[n] = n, s_.entries[n] = frame->slab.tmin;
      ++n;
    }
    return n;
  }

  /// Drops the rays that have found something nearer, and returns how many are left.
  HWY_INLINE std::uint32_t keep(const StreamList& list) {
    const RayTag d;
    const hn::RebindToUnsigned<RayTag> du;
    const hn::RebindToSigned<RayTag> di;
    std::uint32_t* const ids = s_.ids + list.begin;
    float* const entries = s_.entries + list.begin;
    std::uint32_t left = 0;
    fill_up(list);
    for (std::uint32_t i = 0; i < list.count; i += kRayLanes) {
      const auto id = hn::LoadU(du, ids + i);
      const auto entry = hn::LoadU(d, entries + i);
      const auto end = hn::GatherIndex(d, &s_.rays[0].tmax, hn::BitCast(di, hn::ShiftLeft<4>(id)));
      const auto stays = hn::And(hn::Not(hn::Gt(entry, end)), hn::FirstN(d, list.count - i));
      hn::StoreU(hn::Compress(id, hn::RebindMask(du, stays)), du, ids + left);
      hn::StoreU(hn::Compress(entry, stays), d, entries + left);
      left += static_cast<std::uint32_t>(hn::CountTrue(d, stays));
    }
    return left;
  }

  /// Names some ray in the places behind the list.
  HWY_INLINE void fill_up(const StreamList& list) {
    const hn::RebindToUnsigned<RayTag> du;
    hn::StoreU(hn::Set(du, s_.ids[list.begin]), du, s_.ids + list.begin + list.count);
  }

  /// The rays of the list from the `i`-th on.
  struct Rows {
    const StreamRay* at[kRayLanes];
    HWY_INLINE Rows(const StreamStorage& s, const StreamList& list, std::uint32_t i) {
      for (std::size_t lane = 0; lane < kRayLanes; ++lane) at[lane] = &s.rays[s.ids[list.begin + i + lane]];
    }
  };

  /// The ray's range after a test.
  HWY_INLINE void note(std::uint32_t ray) {
    const Hit& hit = s_.records[ray]->hit;
    s_.rays[ray].tmax = s_.any_hit[ray] && hit.valid() ? -kInfinity : hit.t;
    ++changes_;
  }

  HWY_NOINLINE void test(NodeRef leaf, const StreamList& list) {
    const bool in_lanes = accel_.accuracy.triangle == TriangleLevel::kWatertight && !leaf.is_procedural();
    if (!in_lanes || list.count < kFewRaysOfLeaf) return put_off(list);
    counts_.triangle += std::uint64_t{leaf.triangles()} * list.count;
    fill_up(list);
    for (std::uint32_t i = 0; i < list.count; i += kRayLanes) {
      const Rows rows(s_, list, i);
      const TriangleLanes lanes(rows.at);
      const std::uint32_t all = ray_bits(hn::FirstN(RayTag(), list.count - i));
      for (std::uint32_t b = 0; b < leaf.blocks(); ++b) {
        const TriangleBlock& block = accel_.blocks[leaf.first_block() + b];
        const std::uint32_t triangles =
            std::min(leaf.triangles() - b * kBlockTriangles, std::uint32_t{kBlockTriangles});
        RayMask crossing = lanes.may_cross(block, 0);
        for (std::uint32_t l = 1; l < triangles; ++l) crossing = hn::Or(crossing, lanes.may_cross(block, l));
        for (std::uint32_t left = ray_bits(crossing) & all; left != 0; left &= left - 1) {
          const std::uint32_t ray = s_.ids[list.begin + i + static_cast<std::uint32_t>(std::countr_zero(left))];
          if (test_block(block, s_.frames[ray].ray, s_.records[ray]->hit)) note(ray);
        }
      }
    }
  }

  HWY_NOINLINE bool test_block(const TriangleBlock& block, const LocalRay<SlabRay>& frame, Hit& hit) {
    return watertight_block(accel_, block, ~0u, frame, hit);
  }

  /// enter_instance() for a list.
  HWY_NOINLINE bool enter(const StreamList& list, NodeRef& ref) {
    const NodeRef instance = ref;
    for (std::uint32_t i = list.begin; i < list.begin + list.count; ++i) {
      ref = instance;
      if (!enter_instance(accel_, ref, s_.frames[s_.ids[i]].ray)) return false;
    }
    return true;
  }

  HWY_INLINE bool is_split(NodeRef ref, const StreamList& list) const {
    return list.count >= kFewRays && list.free + kMaxWidth * (list.count + kMostRayLanes) <= kStreamRoom &&
           accel_.nodes[ref.node()].direct == 0;
  }

  /// Lets the rays of a list wait for others that go on by themselves.
  HWY_INLINE void put_off(const StreamList& list) {
    for (std::uint32_t i = list.begin; i < list.begin + list.count; ++i) {
      s_.later[later_++] = {s_.ids[i], list.ref, s_.entries[i]};
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
            const std::uint32_t ray = start.ray;
            if (start.entry > s_.rays[ray].tmax) continue;
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
    const RayTag d;
    const hn::RebindToUnsigned<RayTag> du;
    const std::uint32_t room = list.count + kMostRayLanes;
    std::uint32_t ends[kMaxWidth];
    RayVec sums[kMaxWidth];
    for (std::uint32_t c = 0; c < kMaxWidth; ++c) {
      ends[c] = list.free + c * room;
      sums[c] = hn::Zero(d);
    }
    fill_up(list);
    for (std::uint32_t i = 0; i < list.count; i += kRayLanes) {
      const Rows rows(s_, list, i);
      const BoxLanes lanes(rows.at);
      const auto all = hn::FirstN(d, list.count - i);
      const auto ids = hn::LoadU(du, s_.ids + list.begin + i);
      for (std::uint32_t c = 0; c < node.count; ++c) {
        RayVec entry;
        const auto met = hn::And(lanes.meet(node, c, entry), all);
        hn::StoreU(hn::Compress(ids, hn::RebindMask(du, met)), du, s_.ids + ends[c]);
        hn::StoreU(hn::Compress(entry, met), d, s_.entries + ends[c]);
        sums[c] = hn::Add(sums[c], hn::IfThenElseZero(met, entry));
        ends[c] += static_cast<std::uint32_t>(hn::CountTrue(d, met));
      }
    }
    counts_.box += std::uint64_t{node.count} * list.count;
    return push_children(node, list, ends, sums, top);
  }

  HWY_INLINE StreamList* push_children(const Node& node, const StreamList& list, const std::uint32_t* ends,
                                       const RayVec* sums, StreamList* top) {
    const RayTag d;
    StreamList* const bottom = top;
    float means[kMaxWidth];
    const std::uint32_t room = list.count + kMostRayLanes, free = list.free + kMaxWidth * room;
    for (std::uint32_t c = 0; c < node.count; ++c) {
      const std::uint32_t begin = list.free + c * room, count = ends[c] - begin;
      if (count == 0) continue;
      const float mean = hn::GetLane(hn::SumOfLanes(d, sums[c])) / static_cast<float>(count);
      std::ptrdiff_t at = top++ - bottom;
      for (; at > 0 && means[at - 1] < mean; --at) {
        bottom[at] = bottom[at - 1];
        means[at] = means[at - 1];
      }
      bottom[at] = {node.child[c].bits(), begin, count, free, changes_};
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
  std::uint32_t changes_ = 0;  // of hits
};

/// Traces the members together, each through everything below `key`, in a structure of plain nodes.
inline void trace_in_stream(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& total) {
  static thread_local const std::unique_ptr<StreamStorage> storage(new StreamStorage);
  TraversalCounts counts(members.culls);
  Stream stream(accel, *storage, counts);
  for (std::size_t next = 0; next < members.count;) stream.trace(key, members, next);
  total += counts;
}
#else
inline void trace_in_stream(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& total) {
  trace_in_turn<Nodes::kPlain, SlabRay>(accel, key, members, total);
}
#endif

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
