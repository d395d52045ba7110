#include "ringbus/results/ray_life.h"

#include <algorithm>
#include <array>
#include <bit>
#include <set>

#include <fmt/format.h>

namespace carousel::ringbus {

namespace {

using Kind = RayFact::Kind;

std::string resource_text(std::uint32_t number) {
  return fmt::format("resource {}", number);
}

/// Gathers stretches of time, which may overlap.
class LifeBuilder {
 public:
  LifeBuilder(const std::vector<RayFact>& facts, const Timeline& trips, const accel::Accel& accel)
      : facts_(facts), trips_(trips), accel_(accel) {}

  std::optional<RayLife> build() {
    const RayFact* made = first(Kind::kMade);
    if (made == nullptr) return std::nullopt;
    const RayFact *done = first(Kind::kDone), *taken = first(Kind::kTaken), *shaded = first(Kind::kShaded);
    life_.begin = made->end;
    life_.complete = shaded != nullptr;
    life_.end = shaded != nullptr ? shaded->end : std::max(life_.begin, trips_.end);
    in_ring_ends_ = slot_ends_ = done != nullptr ? done->at : life_.end;
    if (shaded != nullptr) life_.hit = shaded->hit;
    placing();
    for (const RayFact& fact : facts_) {
      if (fact.kind == Kind::kIssued) trip(fact);
      if (fact.kind == Kind::kFetched || fact.kind == Kind::kWalked)
        add(fact.at, fact.end, fact.kind == Kind::kWalked ? LifeStage::kTest : LifeStage::kShapes,
            resource_text(fact.resource), std::nullopt, fact.key);
      if (fact.kind == Kind::kTested || fact.kind == Kind::kWalked) test(fact);
    }
    // The native engine hands rays over when it has a batch of them.
    if (done != nullptr && taken == nullptr && !life_.tests.empty())
      add(last_test_ends_, done->at, LifeStage::kReturn, resource_text(done->resource));
    if (done != nullptr && shaded != nullptr) {
      in_ring_ends_ = life_.end;
      const std::uint64_t arrival = taken != nullptr ? taken->at : shaded->at;
      add(done->at, arrival, LifeStage::kReturn, resource_text(done->resource));
      add(arrival, shaded->at, LifeStage::kShadeQueue, "");
      add(shaded->at, shaded->end, LifeStage::kShading, "");
    }
    partition();
    return std::move(life_);
  }

 private:
  const RayFact* first(Kind kind) const {
    const auto found = std::find_if(facts_.begin(), facts_.end(), [&](const RayFact& f) { return f.kind == kind; });
    return found == facts_.end() ? nullptr : &*found;
  }
  void add(std::uint64_t begin, std::uint64_t end, LifeStage stage, std::string part,
           std::optional<std::uint32_t> packet = std::nullopt, std::optional<accel::NodeKey> key = std::nullopt) {
    begin = std::max(begin, life_.begin);
    end = std::min(end, in_ring_ends_);
    if (begin < end) spans_.push_back({begin, end, stage, std::move(part), packet, key});
  }

  void placing() {
    std::uint64_t since = life_.begin;
    for (const RayFact& fact : facts_) {
      if (fact.kind == Kind::kPlaced) {
        life_.resource = fact.resource;
        life_.slot = fact.packet;
        add(since, fact.at, LifeStage::kSlot, "");
        add(fact.at, fact.end, LifeStage::kLoad, resource_text(fact.resource));
        since = fact.end;
      } else if (fact.kind == Kind::kAdmitted) {
        add(since, fact.at, LifeStage::kAdmission, resource_text(fact.resource));
      }
    }
  }

  void test(const RayFact& fact) {
    last_test_ends_ = std::max(last_test_ends_, fact.end);
    const int shapes = accel_.strip_size(fact.key);
    LifeTest test{fact.at, fact.resource, std::nullopt, fact.key, fact.depth, shapes, std::nullopt, std::nullopt};
    if (fact.kind == Kind::kTested) {
      test.packet = fact.packet;
      if (fact.key.ref.is_inner()) test.hit = std::popcount(fact.mask);
    }
    const auto same = [](const Hit& a, const Hit& b) {
      return a.instance == b.instance && a.primitive == b.primitive && a.t == b.t;
    };
    if (fact.hit.valid() && !same(fact.hit, nearest_)) test.found = nearest_ = fact.hit;
    life_.tests.push_back(test);
  }

  /// The time at which the ray joined the collection from which it was issued: of a child that it hit when the packet
  /// of the parent came home, or else, where it goes on with a node from its stack, when its last packet did.
  std::uint64_t joined(const RayFact& issued) const {
    std::uint64_t last = life_.begin;
    const RayFact* parent = nullptr;
    for (const RayFact& fact : facts_) {
      if (fact.at > issued.at) break;
      if (fact.kind == Kind::kAdmitted) last = fact.at;
      if (fact.kind != Kind::kRetired) continue;
      last = fact.at;
      if (!fact.key.ref.is_inner()) continue;
      for (int lane = 0; lane < accel_.strip_size(fact.key); ++lane)
        if ((fact.mask >> lane & 1) != 0 && accel_.child_key(fact.key, lane) == issued.key) parent = &fact;
    }
    return parent != nullptr ? parent->at : last;
  }

  /// The way of a packet with the ray, from its collection until it retires.
  void trip(const RayFact& issued) {
    ++life_.packets;
    const auto packet = std::optional(issued.packet);
    add(joined(issued), issued.at, LifeStage::kCollection, resource_text(issued.resource), std::nullopt, issued.key);
    std::uint64_t retired = in_ring_ends_;
    std::set<std::uint32_t> tested_at;
    for (const RayFact& fact : facts_) {
      if (fact.trip != issued.trip || fact.at < issued.at) continue;
      if (fact.kind == Kind::kRetired) {
        retired = std::min(retired, fact.at);
        break;
      }
      if (fact.kind == Kind::kTested) tested_at.insert(fact.resource);
      // Without the marks of a simulated clock.
      if (fact.kind == Kind::kTested && fact.end > fact.at)
        add(fact.at, fact.end, LifeStage::kTest, resource_text(fact.resource), packet, issued.key);
    }
    const auto in_trip = [&](std::uint64_t begin, std::uint64_t end, LifeStage stage, const std::string& part) {
      add(begin, std::min(end, retired), stage, part, packet, issued.key);
    };
    std::uint64_t now = issued.at;
    LifeStage next = LifeStage::kIssueQueue;  // the stage until the next slice
    std::string part = resource_text(issued.resource);
    for (const Slice& slice : trips_.slices) {
      if (issued.trip == 0 || slice.trip != issued.trip) continue;
      const SliceTrack& track = trips_.tracks[slice.track];
      in_trip(now, slice.begin, next, part);
      if (slice.kind == SliceKind::kLink) {
        life_.hops += slice.begin < retired;
        const std::string link = track.name.substr(0, track.name.find(':'));
        const std::uint64_t arrival = std::max(slice.at, slice.end);
        in_trip(slice.begin, arrival, LifeStage::kLink, link);
        now = std::max(now, arrival);
        next = LifeStage::kInput;
        part = link;
        continue;
      }
      part = track.part;
      next = LifeStage::kEgress;
      if (slice.kind == SliceKind::kTest) {
        const bool own =
            std::any_of(tested_at.begin(), tested_at.end(), [&](std::uint32_t r) { return resource_text(r) == part; });
        const std::uint64_t read = std::max(now, slice.begin);
        const std::uint64_t begun = std::clamp(slice.at, read, std::max(read, slice.end));
        in_trip(read, begun, own ? LifeStage::kShapes : LifeStage::kOtherTest, part);
        in_trip(begun, slice.end, own ? LifeStage::kTest : LifeStage::kOtherTest, part);
      } else {
        in_trip(slice.begin, slice.end, LifeStage::kDispatch, part);
      }
      now = std::max(now, slice.end);
    }
    in_trip(now, retired, next, part);
  }

  /// Accounts each moment to one of the spans that hold it.
  void partition() {
    std::set<std::uint64_t> borders{life_.begin, life_.end};
    for (const LifeSpan& span : spans_) borders.insert({span.begin, span.end});
    std::uint64_t begin = life_.begin;
    for (const std::uint64_t end : borders) {
      if (end <= begin || end > life_.end) continue;
      const LifeSpan* best = nullptr;
      for (const LifeSpan& span : spans_)
        if (span.begin <= begin && span.end >= end && (best == nullptr || span.stage < best->stage)) best = &span;
      LifeSpan one = best != nullptr ? *best : LifeSpan{};
      if (best == nullptr && life_.resource && end <= slot_ends_) one.part = resource_text(*life_.resource);
      one.begin = begin;
      one.end = end;
      begin = end;
      LifeSpan* last = life_.spans.empty() ? nullptr : &life_.spans.back();
      if (last != nullptr && last->stage == one.stage && last->part == one.part && last->packet == one.packet &&
          last->key == one.key)
        last->end = end;
      else
        life_.spans.push_back(std::move(one));
    }
  }

  const std::vector<RayFact>& facts_;
  const Timeline& trips_;
  const accel::Accel& accel_;
  RayLife life_;
  std::uint64_t in_ring_ends_ = 0, slot_ends_ = 0, last_test_ends_ = 0;
  Hit nearest_{};
  std::vector<LifeSpan> spans_;
};

}  // namespace

std::string_view stage_text(LifeStage stage) {
  constexpr std::array<std::string_view, 16> kTexts{"in test",
                                                    "waits for shapes",
                                                    "dispatch reads the packet",
                                                    "tests of other rays",
                                                    "on a link",
                                                    "in an input queue",
                                                    "waits for a link",
                                                    "in the issue queue",
                                                    "in a collection",
                                                    "waits for room at the root",
                                                    "is loaded",
                                                    "waits for a slot",
                                                    "on its way to shading",
                                                    "waits for a shader worker",
                                                    "is shaded",
                                                    "waits for its warp or an answer"};
  return kTexts[static_cast<std::size_t>(stage)];
}

std::optional<RayLife> ray_life(const std::vector<RayFact>& facts, const Timeline& trips, const accel::Accel& accel) {
  return LifeBuilder(facts, trips, accel).build();
}

}  // namespace carousel::ringbus
