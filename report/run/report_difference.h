#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace carousel::report {

/// A place where two reports differ; a missing value is empty.
struct Difference {
  std::string path, a, b;
};

/// A place where several reports differ; the value of a report that does not have it is empty. A long list of numbers
/// is one place: the first that differs.
struct ManyDifference {
  std::string path;
  std::vector<std::string> values;  ///< by report
};

/// The places where reports differ outside of `host`, of config.engine.threads and of the folders of the files that the
/// configuration names, in the order of the first.
std::vector<ManyDifference> differences(const std::vector<const nlohmann::ordered_json*>& reports);

/// As above for two reports. The runs are identical when there is none.
std::vector<Difference> differences(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

/// The first epoch whose digests differ, and its length; the shorter list's end counts as a difference.
struct EpochRange {
  bool found = false;
  std::size_t first_cycle = 0, end_cycle = 0;
};
EpochRange first_differing_epoch(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

}  // namespace carousel::report
