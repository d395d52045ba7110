#include "tests/ringbus/support/cell.h"

#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/load/validate.h"
#include "core/config/write.h"

namespace carousel::ringbus {

void Cell::set(const std::string& key, const std::string& value) {
  if (key == "test.storage")
    tight_storage = value == "least";
  else if (key == "test.non_opaque")
    non_opaque = value == "true";
  else if (key == "test.away")
    away = std::stof(value);
  else if (key != "test.link_faults" && key != "test.split_early")  // these say which other keys are given
    throw std::logic_error("no setting of the tests: " + key);
}

std::string Cell::text() const {
  static const nlohmann::ordered_json defaults = config_json(Config{}).flatten();
  std::string out = fmt::format("threads {}{}{} away {}", threads, tight_storage ? ", least storage" : "",
                                non_opaque ? ", non-opaque" : "", away);
  const nlohmann::ordered_json all = config_json(config).flatten();
  for (const auto& [pointer, value] : all.items()) {
    if (defaults.contains(pointer) && defaults[pointer] == value) continue;
    std::string key = pointer.substr(1);
    for (char& c : key)
      if (c == '/') c = '.';
    out += fmt::format(" {}={}", key, value.is_string() ? value.get<std::string>() : value.dump());
  }
  return out;
}

bool is_accepted(const Config& config) {
  Config with_scene = config;
  if (!with_scene.scene.builtin) with_scene.scene.builtin = BuiltinScene::kCornell;
  return validate_config(with_scene, KeyPositions()).empty();
}

}  // namespace carousel::ringbus
