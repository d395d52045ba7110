#include "ringbus/resource/collections/collection_store.h"

#include <algorithm>
#include <iterator>

namespace carousel::ringbus {

CollectionStore::CollectionStore(const Settings& settings)
    : settings_(settings),
      policy_(&issue_policy(settings.policy)),
      scale_{settings.ready, settings.max_depth, settings.scene_size} {}

std::uint32_t CollectionStore::bucket(const Collection& c) const {
  return policy_->bucket({c.key, c.count, c.entry, c.depth}, scale_);
}

void CollectionStore::enlist(std::uint32_t index, std::uint32_t bucket) {
  PriorityLists& list = this->list(collections_[index]);
  if (policy_->newest_first)
    list.push_front(index, bucket);
  else
    list.push_back(index, bucket);
}

void CollectionStore::relist(std::uint32_t index, bool was_ready) {
  Collection& c = collections_[index];
  c.ready = settings_.select == Select::kStrict || c.count >= settings_.ready || c.ripe;
  const std::uint32_t bucket = this->bucket(c);
  if (c.ready == was_ready && list(c).bucket_of(index) == bucket) return;
  (was_ready ? ready_ : partial_).remove(index);
  enlist(index, bucket);
}

std::uint32_t CollectionStore::new_collection(accel::NodeKey key, std::uint16_t depth, float entry,
                                              std::uint8_t shape) {
  std::uint32_t index;
  if (free_collections_.empty()) {
    index = static_cast<std::uint32_t>(collections_.size());
    collections_.emplace_back();
    ready_.resize(collections_.size());
    partial_.resize(collections_.size());
  } else {
    index = free_collections_.back();
    free_collections_.pop_back();
  }
  const std::uint32_t waits = collections_[index].waits;
  collections_[index] = {key, 0, 0, 0, now_, entry, depth, settings_.select == Select::kStrict, false, waits, shape};
  begin_to_wait(index);
  table_.insert(key, index, shape);
  ++statistics_.created;
  statistics_.peak = std::max<std::uint64_t>(statistics_.peak, table_.size());
  enlist(index, bucket(collections_[index]));
  return index;
}

void CollectionStore::begin_to_wait(std::uint32_t index) {
  collections_[index].since = now_;
  if (settings_.ripe_after == 0) return;
  collections_[index].ripe = false;
  waiting_.push_back({now_, index, ++collections_[index].waits});
}

void CollectionStore::ripen() {
  for (std::optional<std::uint64_t> at; (at = next_ripe()) && *at <= now_; waiting_.pop_front()) {
    Collection& c = collections_[waiting_.front().collection];
    c.ripe = true;
    relist(waiting_.front().collection, c.ready);
  }
}

std::optional<std::uint64_t> CollectionStore::next_ripe() {
  for (; !waiting_.empty(); waiting_.pop_front()) {
    const Waiting& first = waiting_.front();
    const Collection& c = collections_[first.collection];
    if (c.waits == first.waits && c.count > 0 && !c.ready) return first.since + settings_.ripe_after;
  }
  return std::nullopt;
}

std::uint32_t CollectionStore::new_block() {
  const bool spilled = blocks_used_ - blocks_spilled_ >= settings_.capacity_blocks;
  ++blocks_used_;
  std::uint32_t block;
  if (!free_blocks_.empty()) {
    block = free_blocks_.back();
    free_blocks_.pop_back();
  } else {
    block = static_cast<std::uint32_t>(next_block_.size());
    next_block_.push_back(0);
    spilled_as_.push_back(kNotSpilled);
    block_rays_.resize(block_rays_.size() + settings_.block_rays);
    joined_.resize(block_rays_.size());
  }
  if (!spilled) return block;
  ++blocks_spilled_;
  if (free_numbers_.empty()) {
    spilled_as_[block] = numbers_++;
  } else {
    spilled_as_[block] = free_numbers_.back();
    free_numbers_.pop_back();
  }
  return block;
}

void CollectionStore::free_block(std::uint32_t block) {
  free_blocks_.push_back(block);
  --blocks_used_;
  if (spilled_as_[block] == kNotSpilled) return;
  free_numbers_.push_back(spilled_as_[block]);
  spilled_as_[block] = kNotSpilled;
  --blocks_spilled_;
}

void CollectionStore::add(accel::NodeKey key, std::uint16_t depth, float entry, std::span<const RayId> rays,
                          std::uint8_t shape) {
  if (rays.empty()) return;
  const std::optional<std::uint32_t> found = table_.find(key, shape);
  const std::uint32_t index = found ? *found : new_collection(key, depth, entry, shape);
  Collection& c = collections_[index];
  c.entry = std::min(c.entry, entry);
  const std::uint32_t b = settings_.block_rays;
  for (std::size_t done = 0; done < rays.size();) {
    const std::uint32_t filled = c.count % b;
    if (filled == 0) {
      const std::uint32_t block = new_block();
      (c.count == 0 ? c.head : next_block_[c.tail]) = block;
      c.tail = block;
    }
    const std::size_t n = std::min<std::size_t>(b - filled, rays.size() - done);
    std::copy_n(rays.begin() + static_cast<std::ptrdiff_t>(done), n,
                block_rays_.begin() + std::ptrdiff_t{c.tail} * b + filled);
    std::fill_n(joined_.begin() + std::ptrdiff_t{c.tail} * b + filled, n, static_cast<std::uint32_t>(now_));
    c.count += static_cast<std::uint32_t>(n);
    done += n;
    if (const std::uint32_t spilled = spilled_as_[c.tail]; spilled != kNotSpilled) {
      statistics_.spilled += n;
      if (settings_.reports_spills) spills_.written.push_back({spilled, filled, static_cast<std::uint32_t>(n)});
    }
  }
  memberships_ += rays.size();
  statistics_.memberships_peak = std::max<std::uint64_t>(statistics_.memberships_peak, memberships_);
  relist(index, c.ready);
}

std::optional<CollectionId> CollectionStore::best(bool partial) const {
  std::optional<std::uint32_t> index = ready_.first();
  if (!index && partial) index = partial_.first();
  if (!index) return std::nullopt;
  return CollectionId(*index);
}

std::optional<CollectionId> CollectionStore::deepest() const {
  std::optional<CollectionId> best;
  for (std::uint32_t i = 0; i < collections_.size(); ++i)
    if (collections_[i].count > 0 && (!best || collections_[i].depth > collections_[best->value].depth))
      best = CollectionId(i);
  return best;
}

std::uint32_t CollectionStore::front_rays(CollectionId id) const {
  return std::min(collections_[id.value].count, settings_.packet_rays);
}

std::uint32_t CollectionStore::front_blocks(CollectionId id) const {
  return (front_rays(id) + settings_.block_rays - 1) / settings_.block_rays;
}

void CollectionStore::take(CollectionId id, std::vector<RayId>& rays, std::vector<std::uint32_t>* joined) {
  Collection& c = collections_[id.value];
  // The chain is filled at the tail and takes go by whole blocks, so all blocks but the last are full. The remainder of
  // `count` in the tail relies on that.
  const std::uint32_t n = front_rays(id);
  ages_.add(now_ - c.since);
  rays.clear();
  if (joined != nullptr) joined->clear();
  while (rays.size() < n) {
    const auto place = std::ptrdiff_t{c.head} * settings_.block_rays;
    const auto first = block_rays_.begin() + place;
    const auto ids = std::min<std::uint32_t>(settings_.block_rays, n - static_cast<std::uint32_t>(rays.size()));
    rays.insert(rays.end(), first, first + ids);
    if (joined != nullptr) joined->insert(joined->end(), joined_.begin() + place, joined_.begin() + place + ids);
    const std::uint32_t freed = c.head;
    c.head = next_block_[freed];
    if (settings_.reports_spills && spilled_as_[freed] != kNotSpilled)
      spills_.read.push_back({spilled_as_[freed], 0, ids});
    free_block(freed);
  }
  c.count -= n;
  memberships_ -= n;
  if (c.count == 0) {
    list(c).remove(id.value);
    table_.erase(c.key, c.shape);
    free_collections_.push_back(id.value);
  } else {
    begin_to_wait(id.value);
    relist(id.value, c.ready);
  }
}

void CollectionStore::discard() {
  const Statistics kept = statistics_;
  const Log2Histogram ages = ages_;
  const std::uint64_t now = now_;
  *this = CollectionStore(settings_);
  statistics_ = kept;
  ages_ = ages;
  now_ = now;
}

}  // namespace carousel::ringbus
