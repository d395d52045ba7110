#include "report/read/strict_json.h"

#include <cstddef>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostLevels = 64, kMostKeys = 10'000;

/// Builds the value from the parser's events.
class Builder : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& value) override {
    const Json& object = *open_.back();
    if (object.contains(value)) throw JsonFault(path_below(path(), value), "the key stands twice");
    if (object.size() >= kMostKeys) throw JsonFault(path(), fmt::format("expected at most {} keys", kMostKeys));
    keys_.back() = std::move(value);
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 5: syntax error while ..."
    std::string message = error.what();
    if (const std::size_t bracket = message.find("] "); bracket != message.npos) message.erase(0, bracket + 2);
    throw JsonFault("", std::move(message));
  }

  Json take() { return std::move(root_); }

 private:
  template <class T>
  bool put(T&& value) {
    place() = std::forward<T>(value);
    return true;
  }
  bool open(Json container) {
    if (open_.size() == kMostLevels) throw JsonFault(path(), fmt::format("expected at most {} levels", kMostLevels));
    Json& at = place();
    at = std::move(container);
    // A container does not grow while one inside it is open, so that the pointers stay valid.
    open_.push_back(&at);
    keys_.emplace_back();
    return true;
  }
  bool close() {
    open_.pop_back();
    keys_.pop_back();
    return true;
  }
  /// A new value in the innermost container.
  Json& place() {
    if (open_.empty()) return root_;
    Json& container = *open_.back();
    if (container.is_array()) return container.emplace_back(nullptr);
    return container[keys_.back()];
  }
  std::string path() const {
    std::string out;
    for (std::size_t i = 0; i + 1 < open_.size(); ++i)
      out = open_[i]->is_array() ? path_below(out, open_[i]->size() - 1) : path_below(out, keys_[i]);
    return out;
  }

  Json root_;
  std::vector<Json*> open_;
  std::vector<std::string> keys_;  ///< the latest key of each of them
};

}  // namespace

JsonFault::JsonFault(std::string path, std::string message)
    : std::runtime_error((path.empty() ? "" : path + ": ") + message),
      path_(std::move(path)),
      message_(std::move(message)) {}

std::string path_below(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

std::string path_below(const std::string& path, std::size_t index) {
  return fmt::format("{}[{}]", path, index);
}

std::string found_text(const Json& value) {
  constexpr std::size_t kLongest = 60;
  if (value.is_array()) return "a list";
  if (value.is_object()) return "an object";
  if (!value.is_string()) return value.dump();
  std::string text = value.get<std::string>();
  if (text.size() > kLongest) {
    std::size_t cut = kLongest;
    while (cut > 0 && (static_cast<unsigned char>(text[cut]) & 0xc0) == 0x80) --cut;  // not inside a character
    text = text.substr(0, cut) + "...";
  }
  return "'" + text + "'";
}

Json strict_json(std::string_view text) {
  Builder builder;
  Json::sax_parse(text, &builder);
  return builder.take();
}

}  // namespace carousel::report
