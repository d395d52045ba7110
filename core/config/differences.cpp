#include "core/config/differences.h"

#include <nlohmann/json.hpp>

#include "core/config/write.h"

namespace carousel {

namespace {

using Json = nlohmann::ordered_json;

void collect(const Json& from, const Json& to, const std::string& key, std::vector<std::string>& out) {
  if (from == to) return;
  if (!to.is_object()) {
    out.push_back(key + "=" + (to.is_string() ? to.get<std::string>() : to.dump()));
    return;
  }
  for (const auto& [name, value] : to.items())
    collect(from.contains(name) ? from[name] : Json(), value, key.empty() ? name : key + "." + name, out);
}

}  // namespace

std::vector<std::string> config_differences(const Config& from, const Config& to) {
  std::vector<std::string> out;
  collect(config_json(from), config_json(to), "", out);
  return out;
}

}  // namespace carousel
