#include <nlohmann/json.hpp>

#include "core/config/tree/tree_builder.h"

namespace carousel::config {

namespace {

/// nlohmann's events carry no positions. They come in the order of the text, which the lexer has accepted up
/// to the event, so a cursor that skips one token an event knows where each begins.
class JsonHandler {
 public:
  JsonHandler(std::string_view text, const std::string& name, std::vector<ConfigIssue>& issues)
      : text_(text), name_(name), builder_(name, issues) {}

  bool null() { return scalar(Node::Kind::kNull, ""); }
  bool boolean(bool value) { return scalar(Node::Kind::kBool, value ? "true" : "false"); }
  bool number_integer(std::int64_t) { return number(); }
  bool number_unsigned(std::uint64_t) { return number(); }
  bool number_float(double, const std::string&) { return number(); }
  bool string(std::string& value) { return scalar(Node::Kind::kString, value); }
  bool binary(nlohmann::json::binary_t&) { return false; }

  bool start_object(std::size_t) { return start(Node::Kind::kMap); }
  bool start_array(std::size_t) { return start(Node::Kind::kSeq); }
  bool end_object() { return finish(); }
  bool end_array() { return finish(); }
  bool key(std::string& value) {
    builder_.key(value, next_token());
    return true;
  }

  bool parse_error(std::size_t offset, const std::string&, const nlohmann::json::exception& error) {
    std::string message = error.what();
    // "[json.exception.parse_error.101] parse error at line 1, column 5: syntax error while ..."
    const std::size_t meaning = message.find("syntax error");
    if (meaning != message.npos)
      message.erase(0, meaning);
    else if (const std::size_t bracket = message.find("] "); bracket != message.npos)
      message.erase(0, bracket + 2);
    builder_.fail(position_at(text_, offset > 0 ? offset - 1 : 0, name_), std::move(message));
  }

  TreeBuilder& builder() { return builder_; }

 private:
  static bool is_number_char(char c) {
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E';
  }

  /// Skips what separates tokens, then one token; returns where it began and sets token_.
  SourcePosition next_token() {
    static constexpr std::string_view kBetween = " \t\r\n,:";
    while (cursor_ < text_.size() && kBetween.find(text_[cursor_]) != kBetween.npos) advance();
    const SourcePosition position = builder_.at(line_, column_);
    const std::size_t begin = cursor_;
    const char first = cursor_ < text_.size() ? text_[cursor_] : ' ';
    advance();
    if (first == '"') {
      while (cursor_ < text_.size() && text_[cursor_] != '"') {
        if (text_[cursor_] == '\\') advance();
        advance();
      }
      advance();
    } else if (is_number_char(first)) {
      while (cursor_ < text_.size() && is_number_char(text_[cursor_])) advance();
    } else if (first >= 'a' && first <= 'z') {
      while (cursor_ < text_.size() && text_[cursor_] >= 'a' && text_[cursor_] <= 'z') advance();
    }
    token_ = text_.substr(begin, cursor_ - begin);
    return position;
  }

  void advance() {
    if (cursor_ >= text_.size()) return;
    if (text_[cursor_++] == '\n') {
      ++line_;
      column_ = 1;
    } else {
      ++column_;
    }
  }

  bool scalar(Node::Kind kind, std::string text) {
    Node node;
    node.position = next_token();
    node.kind = kind;
    node.text = std::move(text);
    builder_.value(std::move(node));
    return true;
  }

  /// The text itself, not the parser's number: an integer too long for 64 bits is still an integer.
  bool number() {
    Node node;
    node.position = next_token();
    node.text = token_;
    node.kind = token_.find_first_of(".eE") == token_.npos ? Node::Kind::kInt : Node::Kind::kFloat;
    builder_.value(std::move(node));
    return true;
  }

  bool start(Node::Kind kind) {
    builder_.begin(kind, next_token());
    return true;
  }

  bool finish() {
    next_token();
    builder_.end();
    return true;
  }

  std::string_view text_, token_;
  std::string name_;
  TreeBuilder builder_;
  std::size_t cursor_ = 0;
  int line_ = 1, column_ = 1;
};

}  // namespace

Node parse_json(std::string_view text, const std::string& name, std::vector<ConfigIssue>& issues) {
  check_text(text, name);
  JsonHandler handler(text, name, issues);
  nlohmann::json::sax_parse(text, &handler);
  return handler.builder().take_root();
}

}  // namespace carousel::config
