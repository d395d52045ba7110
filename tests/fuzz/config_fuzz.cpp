// libFuzzer entry: whatever the bytes, load_config returns or throws ConfigError, nothing else. The first
// byte chooses the front end and whether the rest of the first line is a --set.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/load/load.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::vector<std::string> sets;
  if (data[0] & 2) {
    const std::size_t line = std::min(text.find('\n'), text.size());
    sets.emplace_back(text.substr(0, line));
    text.remove_prefix(std::min(line + 1, text.size()));
  }
  try {
    carousel::load_config({std::string(text), data[0] & 1 ? "fuzz.json" : "fuzz.yaml"}, sets);
  } catch (const carousel::ConfigError&) {
  }
  return 0;
}
