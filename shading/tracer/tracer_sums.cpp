// The results of a tracer as numbers, to be added to those of others.
#include "shading/tracer/path_tracer-inl.h"

namespace carousel::shading {

std::vector<std::uint64_t> PathTracer::sums() const {
  std::vector<std::uint64_t> out;
  film_.append_sums(out);
  const Counts c = counts();
  out.insert(out.end(), c.emitted.begin(), c.emitted.end());
  out.insert(out.end(), c.completed.begin(), c.completed.end());
  out.push_back(c.saturated);
  out.push_back(c.paths);
  // Halves of the digest's words, whose sums keep the carries.
  const HitsDigest digest = hits_digest();
  for (const std::uint64_t word : {digest.lo, digest.hi}) {
    out.push_back(word & 0xffffffffu);
    out.push_back(word >> 32);
  }
  return out;
}

void PathTracer::set_sums(const std::vector<std::uint64_t>& sums) {
  const std::size_t pixels = 3 * std::size_t{film_.width()} * film_.height();
  film_.set_sums(std::span(sums).first(pixels));
  for (std::size_t w = 0; w < worker_count_; ++w) {
    workers_[w].counts = {};
    workers_[w].digest = {};
  }
  const std::uint64_t* next = sums.data() + pixels;
  Counts& counts = workers_[0].counts;
  for (std::uint64_t& count : counts.emitted) count = *next++;
  for (std::uint64_t& count : counts.completed) count = *next++;
  counts.saturated = *next++;
  counts.paths = *next++;
  std::uint64_t carry = 0, halves[4];
  for (std::uint64_t& half : halves) {
    const std::uint64_t sum = *next++ + carry;
    half = sum & 0xffffffffu;
    carry = sum >> 32;
  }
  workers_[0].digest = {halves[0] | halves[1] << 32, halves[2] | halves[3] << 32};
}

}  // namespace carousel::shading
