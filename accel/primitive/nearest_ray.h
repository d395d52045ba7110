#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "accel/structure/gaussian_shapes.h"
#include "accel/structure/node.h"
#include "core/config/fields/rays.h"
#include "core/numeric/digest.h"
#include "core/types/nearest_counts.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// The order of hits: the closest hit is the first of all, whatever tests find first. Both crossings of a sphere may
/// have one distance, so places count as well.
inline bool nearer(const Hit& a, const Hit& b) {
  return std::tuple(a.t, a.instance, a.primitive, a.u, a.v) < std::tuple(b.t, b.instance, b.primitive, b.u, b.v);
}

/// A node that a ray has yet to visit.
struct WaitingNode {
  NodeKey key;
  float entry = 0;  ///< where the ray enters it
  std::uint16_t depth = 0;
};

/// The rays of one store share this.
struct NearestShared {
  NodeKey root;
  std::uint32_t nearest = 0, buffered = 0;  ///< of QueryConfig
  QueryConfig::Rounds rounds = QueryConfig::Rounds::kRestart;
  bool leaves_out = false;  ///< a round that begins again leaves out boxes that end before the hits that it has found
  const GaussianShapes* gaussians = nullptr;             ///< null: hits are those of surfaces
  std::uint32_t response_steps = 0, harmonic_steps = 0;  ///< of QueryConfig
  NearestUse use{};
  std::uint64_t sent_bytes = 0;  ///< of hits that rays have found, besides each ray's first, since they were last taken
  HitsDigest digest{};           ///< of all hits of completed rays
};

/// A ray that looks for its k nearest hits (`rays.query.nearest`): the sorted buffer beside its record, and what its
/// rounds need. Every hit that a test accepts is offered to insert(); nothing else changes the record's hit, which is
/// the bound of the tests while the ray is in flight:
///
/// - rounds: restart, or one round: the last hit of a full buffer, as no farther one is wanted;
/// - rounds: resume: the end of the ray, as farther hits and nodes are not forgotten but set aside. end() is then the
///   bound of the walk, which gives the nodes behind it to set_aside().
///
/// A round that begins again moves the start of the record's ray to the last hit, so that boxes which end before it are
/// missed. Tests of primitives take the whole ray (WholeRay). A hit may lie behind the end of its own box by a rounding
/// and would be left out with it: the test that meets it tells stray(), and the ray leaves nothing out any more. That
/// is before it could be lost, since a box that ends before the last hit of a round was entered in it. Boxes of several
/// spaces round differently, so nothing is left out where instances have transforms.
///
/// The hits of a Gaussian are where the ray meets its greatest response (GaussianShapes). They are blended from the
/// front at the end of each round, their light stays in the record, and the ray looks for no more of them when it is
/// opaque. So only the last hit that was found is kept.
///
/// When the walk has no node left it asks go_on(). A round gives the hits in the buffer away (C. Gribble et al.,
/// Multi-Hit Ray Traversal, JCGT 3(1), 2014, has one buffer for all; rounds are those of GRTX, HPCA 2026). Owned by
/// the store; the owner's thread alone calls.
class NearestRay {
 public:
  /// The buffer of a slot; `buffer` has room for NearestShared::buffered hits, and `found` for all. They are the same
  /// where one round finds all.
  /// With Gaussians `found` is the buffer.
  NearestRay(NearestShared& shared, Hit* buffer, Hit* found) : shared_(&shared), buffer_(buffer), found_(found) {}

  /// Begins with a record that accel::start_record() has made. It keeps its place in memory until finish().
  void start(RayRecord& record);
  /// Offers a hit. A hit that is offered again, as by two leaves that share its primitive, changes nothing. Returns the
  /// steps that it takes: comparisons with hits in the buffer, from its far end, and one for a hit that is set aside,
  /// which pays its way back into the buffer in advance. It may never be taken back.
  std::uint64_t insert(const Hit& hit);
  /// True if hits that lie behind the ends of their boxes have to be told.
  bool fears_strays() const { return shared_->leaves_out && !strayed_; }
  void stray() {
    shared_->use.counts.strays += !strayed_;  // a test may meet several such hits
    strayed_ = true;
  }
  /// The start of the whole ray.
  float start_of_ray() const { return tmin_; }
  /// The ray was tested against a node or a leaf.
  void visited() { ++visits_; }

  /// True if the ray wants no node that it enters at `entry` in this round; the node waits for a later one.
  bool set_aside(const WaitingNode& node);
  /// The walk has no node left: the node with which it goes on, or nothing if the ray has found all that it looks for.
  std::optional<WaitingNode> go_on();
  /// Ends the ray: its record has the closest hit, or is a miss. Returns all hits in order, valid until start(); of
  /// Gaussians the closest one.
  std::span<const Hit> finish();
  /// Light from the Gaussians of a ray that is finished, and the share of the light behind them that reaches it.
  const Vec3& light() const { return light_; }
  float transmittance() const { return transmittance_; }

 private:
  bool resumes() const {
    return shared_->buffered < shared_->nearest && shared_->rounds == QueryConfig::Rounds::kResume;
  }
  /// The hits that this round may keep.
  std::uint32_t capacity() const { return std::min(shared_->buffered, shared_->nearest - found_count_); }
  bool full() const { return count_ == capacity(); }
  float end() const { return full() && count_ > 0 ? buffer_[count_ - 1].t : record_->ray.tmax; }
  std::uint64_t put(const Hit& hit);
  void set_bound();
  void end_round();
  /// Blends the hits of the round, once. True if the ray is opaque.
  bool blend();
  /// True for hits of the rounds before.
  bool was_found(const Hit& hit) const { return found_count_ > 0 && !nearer(last_, hit); }
  void refill();
  void set_hit_aside(const Hit& hit);
  void waits(std::uint64_t bytes);
  void taken_back(std::uint64_t bytes);

  NearestShared* shared_;
  Hit* buffer_;
  Hit* found_;
  RayRecord* record_ = nullptr;
  float tmin_ = 0;
  bool strayed_ = false;
  std::uint32_t count_ = 0;        ///< in the buffer
  std::uint32_t found_count_ = 0;  ///< given away by the rounds before
  Hit first_, last_;               ///< of these
  Vec3 light_{0};
  float transmittance_ = 1;
  bool blended_ = false;  ///< the hits in the buffer
  std::uint32_t round_ = 0;
  std::uint64_t visits_ = 0;         ///< of this round
  std::uint64_t waiting_bytes_ = 0;  ///< of both below
  std::vector<WaitingNode> nodes_;   ///< a heap, the nearest on top
  std::vector<Hit> hits_;            ///< likewise
};

// A record in flight has no use for its hit's place on a primitive, so that says where the ray's buffer is.
static_assert(sizeof(NearestRay*) == 2 * sizeof(float));

inline void point_to(NearestRay* ray, RayRecord& record) {
  const auto parts = std::bit_cast<std::array<float, 2>>(ray);
  record.hit.u = parts[0], record.hit.v = parts[1];
  record.tag.flags |= kRayNearest;
}
/// The buffer of a ray in flight; null if it looks for one hit.
inline NearestRay* nearest_of(const RayRecord& record) {
  if ((record.tag.flags & kRayNearest) == 0) [[likely]]
    return nullptr;
  return std::bit_cast<NearestRay*>(std::array<float, 2>{record.hit.u, record.hit.v});
}

/// Gives a record the whole ray while it lives.
class WholeRay {
 public:
  explicit WholeRay(RayRecord& record) : record_(record), start_(record.ray.tmin) {
    if (const NearestRay* const nearest = nearest_of(record)) [[unlikely]]
      record.ray.tmin = nearest->start_of_ray();
  }
  ~WholeRay() { record_.ray.tmin = start_; }
  WholeRay(const WholeRay&) = delete;
  WholeRay& operator=(const WholeRay&) = delete;

 private:
  RayRecord& record_;
  float start_;
};

}  // namespace carousel::accel
