#pragma once

#include <cstdint>
#include <string>

#include "accel/structure/node.h"
#include "core/config/fields/collections.h"

namespace carousel::ringbus {

/// The facts of a collection that a policy may use.
struct CollectionFacts {
  accel::NodeKey key;
  std::uint32_t rays = 0;
  float entry = 0;          ///< the nearest entry into the node of any of the rays
  std::uint16_t depth = 0;  ///< depth of the node, in strips below the root
};

/// The scale by which a policy measures collections.
struct PolicyScale {
  std::uint32_t ready = 32;  ///< rays that make a collection ready
  int max_depth = 1;         ///< depth of the structure, in strips
  float scene_size = 1;
};

/// Decides which packet goes next: `collections.policy`, a row of the table in issue_policy.cpp.
///
/// Collections stand in 256 buckets (PriorityLists) and the first of the lowest bucket goes first. Ready
/// collections go before the others, unless `collections.select` is strict (CollectionStore::best).
struct IssuePolicy {
  Policy policy;
  /// The bucket of a collection, below PriorityLists::kBuckets. Called whenever rays have joined or left it.
  std::uint32_t (*bucket)(const CollectionFacts& collection, const PolicyScale& scale);
  bool newest_first = false;   ///< within a bucket; otherwise the oldest goes first
  bool reads_entries = false;  ///< packets must bring back the entries of their rays into the children
};

/// The row of a policy. Throws SimulationError where there is none.
const IssuePolicy& issue_policy(Policy policy);

/// Adds a policy that is not in the table, for programs of one's own, and returns its value for
/// `Config::collections.policy`, of which configurations know it by its name from now on; `own.policy` is ignored.
/// Throws a SimulationError for a name that there is already. A plugin brings its policies itself
/// (ringbus/plugin/bring.h).
Policy register_policy(std::string name, const IssuePolicy& own);

}  // namespace carousel::ringbus
