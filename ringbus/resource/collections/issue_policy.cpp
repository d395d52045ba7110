#include "ringbus/resource/collections/issue_policy.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <utility>

#include "core/config/fields/collections.h"
#include "core/system/error.h"
#include "core/types/added_names.h"
#include "ringbus/resource/collections/priority_lists.h"

namespace carousel::ringbus {

namespace {

constexpr std::uint32_t kLastBucket = PriorityLists::kBuckets - 1;

std::uint32_t one_bucket(const CollectionFacts&, const PolicyScale&) {
  return 0;
}

std::uint32_t fullest(const CollectionFacts& c, const PolicyScale& scale) {
  return kLastBucket - std::min(kLastBucket, c.rays * 128 / scale.ready);
}

std::uint32_t deepest(const CollectionFacts& c, const PolicyScale& scale) {
  return std::min<std::uint32_t>(kLastBucket, scale.max_depth > c.depth ? scale.max_depth - c.depth : 0);
}

// The exponent and three bits of the fraction: eight steps an octave.
std::uint32_t octave_eighths(float x) {
  return std::bit_cast<std::uint32_t>(x > 0 ? x : 0.0f) >> 20;
}

// Eight buckets an octave: 27 octaves below the scene's size and 5 above.
std::uint32_t nearest(const CollectionFacts& c, const PolicyScale& scale) {
  const std::uint32_t top = octave_eighths(scale.scene_size > 0 ? scale.scene_size : 1.0f);
  const std::uint32_t base = top > 27 * 8 ? top - 27 * 8 : 0, here = octave_eighths(c.entry);
  return here > base ? std::min(kLastBucket, here - base) : 0;
}

// A new policy has two places: its function and row here, and its value and name in core/config/fields/collections.h
// (docs/guides/extending.md). Schema, documentation, error messages and tests follow.
constexpr std::array kPolicies{
    IssuePolicy{.policy = Policy::kFullest, .bucket = fullest},
    IssuePolicy{.policy = Policy::kOldest, .bucket = one_bucket},
    IssuePolicy{.policy = Policy::kNewest, .bucket = one_bucket, .newest_first = true},
    IssuePolicy{.policy = Policy::kDeepest, .bucket = deepest},
    IssuePolicy{.policy = Policy::kNearest, .bucket = nearest, .reads_entries = true},
};
static_assert(kPolicies.size() == kEnumNames<Policy>.size(), "a row for each policy");

}  // namespace

const IssuePolicy& issue_policy(Policy policy) {
  const auto row =
      std::find_if(kPolicies.begin(), kPolicies.end(), [&](const IssuePolicy& r) { return r.policy == policy; });
  if (row != kPolicies.end()) return *row;
  if (const auto* own = added_body<IssuePolicy>(policy)) return *own;
  throw SimulationError("no such policy of collections");
}

Policy register_policy(std::string name, const IssuePolicy& own) {
  for (const auto& [known, policy] : named_values<Policy>({}))
    if (known == name) throw SimulationError("there is a policy of the name " + name + " already");
  return add_named<Policy>({std::move(name), "", std::make_shared<IssuePolicy>(own)});
}

}  // namespace carousel::ringbus
