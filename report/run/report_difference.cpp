#include "report/run/report_difference.h"

#include <algorithm>

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;

void compare(const std::string& path, const Json* a, const Json* b, std::vector<Difference>& out) {
  if (a != nullptr && b != nullptr && *a == *b) return;
  const auto child = [&](const std::string& key) { return path.empty() ? key : path + "." + key; };
  if (a != nullptr && b != nullptr && a->is_object() && b->is_object()) {
    for (const auto& [key, value] : a->items())
      compare(child(key), &value, b->contains(key) ? &(*b)[key] : nullptr, out);
    for (const auto& [key, value] : b->items())
      if (!a->contains(key)) compare(child(key), nullptr, &value, out);
    return;
  }
  if (a != nullptr && b != nullptr && a->is_array() && b->is_array()) {
    for (std::size_t i = 0; i < std::max(a->size(), b->size()); ++i)
      compare(child(std::to_string(i)), i < a->size() ? &(*a)[i] : nullptr, i < b->size() ? &(*b)[i] : nullptr, out);
    return;
  }
  out.push_back({path, a != nullptr ? a->dump() : "", b != nullptr ? b->dump() : ""});
}

}  // namespace

std::vector<Difference> differences(const Json& a, const Json& b) {
  Json left = a, right = b;
  for (Json* report : {&left, &right}) {
    report->erase("host");
    // How many threads the host was to use is its affair too.
    if (const auto engine = Json::json_pointer("/config/engine"); report->contains(engine))
      (*report)[engine].erase("threads");
  }
  std::vector<Difference> out;
  compare("", &left, &right, out);
  return out;
}

EpochRange first_differing_epoch(const Json& a, const Json& b) {
  const Json::json_pointer at("/engine/epochs");
  if (!a.contains(at) || !b.contains(at)) return {};
  const std::size_t each = a[at].value("cycles_each", std::size_t{0});
  // Runs of very different length have epochs of different length; then the first one is as good as any.
  if (each != b[at].value("cycles_each", std::size_t{0})) return {true, 0, each};
  const Json &left = a[at]["digests"], &right = b[at]["digests"];
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i)
    if (i >= left.size() || i >= right.size() || left[i] != right[i]) return {true, i * each, (i + 1) * each};
  return {};
}

}  // namespace carousel::report
