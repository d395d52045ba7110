#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/config/config.h"

namespace carousel {

/// The keys of one class of parts, which the search for the bottleneck relaxes together. The rows of these keys say so
/// (core/config/fields/field.h).
struct Relaxation {
  std::string part;    ///< the class, as the report names it
  std::string action;  ///< "twice memory.l2_kib": its keys and how they change
  std::vector<std::string> keys;
  config::Relaxed how;
};

/// The classes of a machine whose rows apply, as far as `feels(key)`, in the order of the keys.
std::vector<Relaxation> relaxations(const Config& config, const std::function<bool(const std::string& key)>& feels);

/// Relaxes the keys of a class once, those of resources that differ as well. A value that stands for auto is taken for
/// what it stands for.
void relax(Config& config, const Relaxation& relaxation);

}  // namespace carousel
