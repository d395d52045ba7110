#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace carousel::report {

/// One thing wrong with a JSON text.
class JsonFault : public std::runtime_error {
 public:
  /// `path` is the place of the value, as in links[0].from; empty if the whole text is meant.
  JsonFault(std::string path, std::string message);
  const std::string& path() const { return path_; }
  const std::string& message() const { return message_; }

 private:
  std::string path_, message_;
};

/// A path one step further down: a key of an object, or the index of a list's item.
std::string path_below(const std::string& path, std::string_view key);
std::string path_below(const std::string& path, std::size_t index);

/// A value as the end of a message that says what was found: "'text'", "12", "a list".
std::string found_text(const nlohmann::ordered_json& value);

/// Reads a JSON text (RFC 8259). Throws a JsonFault for what is no JSON, for a key that stands twice in an object, for
/// numbers beyond the range of a double, for more than 64 levels and for more than 10,000 keys of one object.
nlohmann::ordered_json strict_json(std::string_view text);

}  // namespace carousel::report
