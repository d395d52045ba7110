#include "accel/primitive/nearest_ray.h"

#include <algorithm>

namespace carousel::accel {

namespace {

/// A key, where the ray enters, and the depth; as the stacks of rays have them.
constexpr std::uint64_t kWaitingNodeBytes = 12;

// The orders of heaps: std::push_heap() has the greatest on top.
bool farther_node(const WaitingNode& a, const WaitingNode& b) {
  return std::tuple(a.entry, a.key.bits()) > std::tuple(b.entry, b.key.bits());
}
bool farther_hit(const Hit& a, const Hit& b) {
  return nearer(b, a);
}

}  // namespace

void NearestRay::start(RayRecord& record) {
  record_ = &record;
  tmin_ = record.ray.tmin;
  strayed_ = false;
  count_ = found_count_ = round_ = 0;
  visits_ = waiting_bytes_ = 0;
  light_ = Vec3(0);
  transmittance_ = 1;
  blended_ = false;
  nodes_.clear();
  hits_.clear();
  point_to(this, record);
}

std::uint64_t NearestRay::insert(const Hit& offered) {
  NearestCounts& counts = shared_->use.counts;
  ++counts.offered;
  if (shared_->gaussians == nullptr) return put(offered);
  ++counts.responses;
  Hit hit;
  if (!shared_->gaussians->respond(record_->ray, tmin_, offered, hit)) return shared_->response_steps;
  const std::uint32_t terms = shared_->gaussians->color_terms();
  counts.color_terms += terms;
  return shared_->response_steps + std::uint64_t{shared_->harmonic_steps} * terms + put(hit);
}

std::uint64_t NearestRay::put(const Hit& hit) {
  NearestCounts& counts = shared_->use.counts;
  // A round that begins at the root again meets the hits that the rounds before have found.
  if (was_found(hit)) {
    counts.read_bytes += kBufferedHitBytes;
    return 1;
  }
  std::uint32_t at = count_;
  while (at > 0 && nearer(hit, buffer_[at - 1])) --at;
  const std::uint32_t compared = count_ - at + (at > 0 ? 1 : 0);
  counts.read_bytes += kBufferedHitBytes * compared;
  std::uint64_t steps = std::max(1u, compared);
  if (at > 0 && !nearer(buffer_[at - 1], hit)) return steps;  // it is there
  const bool evicts = at < capacity() && full();
  if (resumes() && (at == capacity() || evicts)) {
    set_hit_aside(evicts ? buffer_[count_ - 1] : hit);
    ++steps;
  }
  if (at == capacity()) return steps;
  if (evicts) {
    ++counts.evicted;
    --count_;
  }
  std::copy_backward(buffer_ + at, buffer_ + count_, buffer_ + count_ + 1);
  buffer_[at] = hit;
  ++count_;
  ++counts.inserted;
  counts.written_bytes += kBufferedHitBytes * (count_ - at);
  set_bound();
  return steps;
}

/// A primitive is named one too far, so that tests offer what differs from the last hit in its place alone.
void NearestRay::set_bound() {
  if (resumes() || !full()) return;
  record_->hit = buffer_[count_ - 1];
  ++record_->hit.primitive;
  point_to(this, *record_);
}

bool NearestRay::set_aside(const WaitingNode& node) {
  if (!resumes() || !(node.entry > end())) return false;
  nodes_.push_back(node);
  std::push_heap(nodes_.begin(), nodes_.end(), farther_node);
  ++shared_->use.counts.waiting_nodes;
  waits(kWaitingNodeBytes);
  return true;
}

void NearestRay::set_hit_aside(const Hit& hit) {
  hits_.push_back(hit);
  std::push_heap(hits_.begin(), hits_.end(), farther_hit);
  ++shared_->use.counts.waiting_hits;
  waits(kBufferedHitBytes);
}

void NearestRay::waits(std::uint64_t bytes) {
  NearestCounts& counts = shared_->use.counts;
  waiting_bytes_ += bytes;
  counts.waiting_bytes += bytes;
  counts.waiting_peak_bytes = std::max(counts.waiting_peak_bytes, waiting_bytes_);
}

void NearestRay::taken_back(std::uint64_t bytes) {
  waiting_bytes_ -= bytes;
  shared_->use.counts.waiting_bytes += bytes;
}

std::optional<WaitingNode> NearestRay::go_on() {
  for (;;) {
    if (!nodes_.empty() && !(nodes_.front().entry > end())) {
      const WaitingNode next = nodes_.front();
      std::pop_heap(nodes_.begin(), nodes_.end(), farther_node);
      nodes_.pop_back();
      taken_back(kWaitingNodeBytes);
      return next;
    }
    const bool was_full = full();
    // finish() ends the last round.
    if (!was_full || found_count_ + count_ == shared_->nearest || blend()) return std::nullopt;
    if (resumes() && nodes_.empty() && hits_.empty()) return std::nullopt;
    end_round();
    if (!resumes()) {
      record_->ray.tmin = fears_strays() ? last_.t : tmin_;
      return WaitingNode{shared_->root, 0, 0};
    }
    refill();
  }
}

bool NearestRay::blend() {
  const GaussianShapes* const gaussians = shared_->gaussians;
  if (gaussians == nullptr) return false;
  for (std::uint32_t i = 0; !blended_ && i < count_ && !(transmittance_ < gaussians->opaque_below()); ++i) {
    const float alpha = gaussians->alpha(buffer_[i]);
    light_ += transmittance_ * alpha * gaussians->color(buffer_[i], record_->ray.direction);
    transmittance_ *= 1 - alpha;
    ++shared_->use.counts.blended;
  }
  if (!blended_ && count_ > 0) {
    shared_->use.counts.read_bytes += kBlendedLightBytes;
    shared_->use.counts.written_bytes += kBlendedLightBytes;
  }
  blended_ = true;
  return transmittance_ < gaussians->opaque_below();
}

void NearestRay::end_round() {
  NearestUse& use = shared_->use;
  blend();
  if (found_ != buffer_) std::copy(buffer_, buffer_ + count_, found_ + found_count_);
  if (count_ > 0) {
    if (found_count_ == 0) first_ = buffer_[0];
    last_ = buffer_[count_ - 1];
  }
  // The first hit goes with the record.
  if (shared_->gaussians == nullptr)
    shared_->sent_bytes += kBufferedHitBytes * (count_ - (found_count_ == 0 && count_ > 0 ? 1 : 0));
  use.counts.read_bytes += kBufferedHitBytes * count_;
  ++use.counts.rounds;
  if (use.rounds.size() <= round_) use.rounds.resize(round_ + 1);
  ++use.rounds[round_].rays;
  use.rounds[round_].visits += visits_;
  found_count_ += count_;
  count_ = 0;
  blended_ = false;
  ++round_;
  visits_ = 0;
  record_->hit = Hit{};
  record_->hit.t = record_->ray.tmax;
  point_to(this, *record_);
}

/// Takes the nearest of the hits that wait, which come in their order. Their steps have been paid.
void NearestRay::refill() {
  NearestCounts& counts = shared_->use.counts;
  while (!hits_.empty() && !full()) {
    const Hit hit = hits_.front();
    std::pop_heap(hits_.begin(), hits_.end(), farther_hit);
    hits_.pop_back();
    taken_back(kBufferedHitBytes);
    if (was_found(hit) || (count_ > 0 && !nearer(buffer_[count_ - 1], hit))) continue;  // it was offered twice
    buffer_[count_++] = hit;
    ++counts.inserted;
    counts.written_bytes += kBufferedHitBytes;
  }
}

std::span<const Hit> NearestRay::finish() {
  end_round();
  shared_->use.counts.hits += found_count_;
  ++shared_->use.counts.rays;
  record_->ray.tmin = tmin_;
  record_->hit = found_count_ > 0 ? first_ : Hit{};
  record_->tag.flags &= static_cast<std::uint8_t>(~kRayNearest);
  if (shared_->gaussians == nullptr) return {found_, found_count_};
  shared_->sent_bytes += kBlendedLightBytes;
  return {&first_, std::min(found_count_, 1u)};
}

}  // namespace carousel::accel
