// The spans that a shape buffer holds: found by address, and replaced when nobody has held them for longest.
#include "ringbus/cycle/shapes/shape_buffer.h"

namespace carousel::ringbus::cycle {

std::uint32_t ShapeBuffer::find(const ShapeSpan& span) const {
  std::uint32_t at = buckets_[bucket(span)];
  while (at != kNone && entries_[at].span != span) at = entries_[at].chain;
  return at;
}

std::uint32_t ShapeBuffer::allocate(const ShapeSpan& span, std::uint64_t places) {
  if (2 * ++used_ > buckets_.size()) grow_buckets();
  std::uint32_t index = free_entry_;
  if (index == kNone) {
    index = static_cast<std::uint32_t>(entries_.size());
    entries_.emplace_back();
  } else {
    free_entry_ = entries_[index].chain;
  }
  std::uint32_t& first = buckets_[bucket(span)];
  entries_[index] = Entry{};
  entries_[index].span = span;
  entries_[index].places = places;
  entries_[index].chain = first;
  first = index;
  free_places_ -= places;
  return index;
}

void ShapeBuffer::grow_buckets() {
  buckets_.assign(2 * buckets_.size(), kNone);
  --shift_;
  std::vector<bool> free(entries_.size());
  for (std::uint32_t at = free_entry_; at != kNone; at = entries_[at].chain) free[at] = true;
  for (std::uint32_t i = 0; i < entries_.size(); ++i) {
    if (free[i]) continue;
    std::uint32_t& first = buckets_[bucket(entries_[i].span)];
    entries_[i].chain = first;
    first = i;
  }
}

void ShapeBuffer::evict_oldest() {
  const std::uint32_t index = oldest_;
  hold(index);  // takes it from the list
  remove(index);
  ++counts_.evictions;
}

/// Frees the places of an entry that is on no list.
void ShapeBuffer::remove(std::uint32_t index) {
  Entry& entry = entries_[index];
  std::uint32_t* at = &buckets_[bucket(entry.span)];
  while (*at != index) at = &entries_[*at].chain;
  *at = entry.chain;
  entry.chain = free_entry_;
  free_entry_ = index;
  free_places_ += entry.places;
  --used_;
}

void ShapeBuffer::hold(std::uint32_t index) {
  Entry& entry = entries_[index];
  if (entry.holders++ > 0 || !entry.here) return;
  (entry.older == kNone ? oldest_ : entries_[entry.older].newer) = entry.newer;
  (entry.newer == kNone ? newest_ : entries_[entry.newer].older) = entry.older;
  idle_places_ -= entry.places;
}

void ShapeBuffer::let_go(std::uint32_t index) {
  Entry& entry = entries_[index];
  if (--entry.holders > 0 || !entry.here) return;
  if (drops_) return remove(index);
  keep(index);
}

/// Puts an entry that nobody holds at the end of those that may be replaced.
void ShapeBuffer::keep(std::uint32_t index) {
  Entry& entry = entries_[index];
  entry.older = newest_;
  entry.newer = kNone;
  (newest_ == kNone ? oldest_ : entries_[newest_].newer) = index;
  newest_ = index;
  idle_places_ += entry.places;
}

std::vector<BufferedShapes> ShapeBuffer::kept() const {
  std::vector<BufferedShapes> out;
  for (std::uint32_t at = newest_; at != kNone; at = entries_[at].older)
    out.push_back({entries_[at].span.address, entries_[at].span.bytes});
  return out;
}

void ShapeBuffer::warm(const std::vector<BufferedShapes>& shapes, double part) {
  if (drops_) return;
  for (const BufferedShapes& one : shapes) {
    const ShapeSpan span{one.address, one.bytes};
    if (WarmCaches::drawn(one.address) >= part || find(span) != kNone || free_places_ < places(span)) continue;
    const std::uint32_t index = allocate(span, places(span));
    Entry& entry = entries_[index];
    entry.here = true;
    entry.newer = oldest_;
    (oldest_ == kNone ? newest_ : entries_[oldest_].older) = index;
    oldest_ = index;
    idle_places_ += entry.places;
  }
}

/// Shapes for which another resource has asked: they are kept if they find places that nobody holds or waits for.
void ShapeBuffer::take_pushed(Cycle now) {
  while (pushed_->next() <= now) {
    const PushedShapes shapes = pushed_->take();
    const ShapeSpan span{shapes.address, shapes.size};
    ++counts_.pushed;
    if (!room_.empty() || find(span) != kNone || free_places_ + idle_places_ < places(span)) {
      ++counts_.pushed_in_vain;
      continue;
    }
    while (free_places_ < places(span)) evict_oldest();
    const std::uint32_t entry = allocate(span, places(span));
    entries_[entry].here = true;
    keep(entry);
  }
}

}  // namespace carousel::ringbus::cycle
