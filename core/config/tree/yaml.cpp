#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <sstream>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "core/config/tree/tree_builder.h"

namespace carousel::config {

namespace {

bool all_of(std::string_view text, std::string_view allowed) {
  return !text.empty() && text.find_first_not_of(allowed) == text.npos;
}

/// Decimal digits of an integer of the core schema (decimal, 0x, 0o), or nothing. A number that does not
/// fit 64 bits keeps its digits: the reader of the field refuses it with the field's range.
std::string decimal_text(std::string_view text) {
  const bool minus = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  if (all_of(text, "0123456789")) return (minus ? "-" : "") + std::string(text);
  const bool hex = text.size() > 2 && text.substr(0, 2) == "0x", octal = text.size() > 2 && text.substr(0, 2) == "0o";
  if (!hex && !octal) return {};
  const std::string_view digits = text.substr(2);
  if (!all_of(digits, hex ? "0123456789abcdefABCDEF" : "01234567")) return {};
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, hex ? 16 : 8);
  if (error != std::errc{} || end != digits.data() + digits.size()) return "99999999999999999999";
  return (minus ? "-" : "") + std::to_string(value);
}

/// Text of a real of the core schema that std::from_chars reads, or nothing.
std::string real_text(std::string_view text) {
  const bool minus = !text.empty() && text[0] == '-';
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  const std::string sign = minus ? "-" : "";
  if (text == ".inf" || text == ".Inf" || text == ".INF") return sign + "inf";
  if (text == ".nan" || text == ".NaN" || text == ".NAN") return "nan";
  // from_chars would also read names such as "infinity".
  if (!all_of(text, "0123456789.eE+-") || text.find_first_of("0123456789") == text.npos) return {};
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument || end != text.data() + text.size()) return {};
  return sign + std::string(text);
}

/// A plain scalar by YAML 1.2's core schema; `yes` and `off` are texts there.
void resolve_plain(const std::string& text, Node& node) {
  node.text = text;
  if (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL") {
    node.kind = Node::Kind::kNull;
  } else if (text == "true" || text == "True" || text == "TRUE") {
    node.kind = Node::Kind::kBool;
    node.text = "true";
  } else if (text == "false" || text == "False" || text == "FALSE") {
    node.kind = Node::Kind::kBool;
    node.text = "false";
  } else if (std::string number = decimal_text(text); !number.empty()) {
    node.kind = Node::Kind::kInt;
    node.text = std::move(number);
  } else if (std::string real = real_text(text); !real.empty()) {
    node.kind = Node::Kind::kFloat;
    node.text = std::move(real);
  } else {
    node.kind = Node::Kind::kString;
  }
}

class YamlHandler final : public YAML::EventHandler {
 public:
  YamlHandler(const std::string& name, std::vector<ConfigIssue>& issues) : builder_(name, issues) {}

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (documents_++ > 0) builder_.fail(at(mark), "a second document; a configuration is one YAML document");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node node;
    node.position = at(mark);
    add(std::move(node), anchor);
  }

  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    Node node;
    node.position = at(mark);
    if (tag == "!" || tag == "tag:yaml.org,2002:str") {  // "!" is how yaml-cpp marks quoted text
      node.kind = Node::Kind::kString;
      node.text = text;
    } else if (tag.empty() || tag == "?") {
      resolve_plain(text, node);
    } else {
      builder_.fail(node.position, "tag '" + tag + "' has no meaning here");
    }
    add(std::move(node), anchor);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end()) builder_.fail(at(mark), "an alias inside of what it stands for");
    add(found->second, YAML::NullAnchor);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    begin(Node::Kind::kSeq, mark, tag, anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    begin(Node::Kind::kMap, mark, tag, anchor);
  }
  void OnMapEnd() override { end(); }

  TreeBuilder& builder() { return builder_; }

 private:
  SourcePosition at(const YAML::Mark& mark) const { return builder_.at(mark.line + 1, mark.column + 1); }

  void add(Node node, YAML::anchor_t anchor) {
    if (builder_.wants_key()) {
      if (node.kind == Node::Kind::kSeq || node.kind == Node::Kind::kMap) fail_key(node.position, node.kind);
      return builder_.key(node.text, node.position);
    }
    const Node& kept = builder_.value(std::move(node));
    if (anchor != YAML::NullAnchor) anchors_[anchor] = kept;
  }

  [[noreturn]] void fail_key(const SourcePosition& position, Node::Kind kind) {
    // yaml-cpp takes a bracket that is never closed for the beginning of a key.
    builder_.fail(position, std::string("expected a name as the key, found ") +
                                (kind == Node::Kind::kSeq ? "a list" : "a map") + " (or is a bracket not closed?)");
  }

  void begin(Node::Kind kind, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    if (!tag.empty() && tag != "?" && tag != "!") builder_.fail(at(mark), "tag '" + tag + "' has no meaning here");
    if (builder_.wants_key()) fail_key(at(mark), kind);
    builder_.begin(kind, at(mark));
    open_anchors_.push_back(anchor);
  }

  void end() {
    const Node& kept = builder_.end();
    if (open_anchors_.back() != YAML::NullAnchor) anchors_[open_anchors_.back()] = kept;
    open_anchors_.pop_back();
  }

  TreeBuilder builder_;
  int documents_ = 0;
  std::vector<YAML::anchor_t> open_anchors_;
  std::map<YAML::anchor_t, Node> anchors_;
};

/// Line and column, from 1.
struct Place {
  int line, column;
};

/// The first tab before the text of a line, up to the line in which the parser gave up (from 0).
std::optional<Place> tab_in_indentation(std::string_view text, int last_line) {
  int line = 0;
  for (std::size_t begin = 0; begin < text.size() && line <= last_line; ++line) {
    const std::size_t first = std::min(text.find_first_not_of(' ', begin), text.size());
    if (first < text.size() && text[first] == '\t') return Place{line + 1, static_cast<int>(first - begin) + 1};
    begin = std::min(text.find('\n', begin), text.size() - 1) + 1;
  }
  return std::nullopt;
}

}  // namespace

Node parse_yaml(std::string_view text, const std::string& name, std::vector<ConfigIssue>& issues) {
  check_text(text, name);
  YamlHandler handler(name, issues);
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(handler)) {
    }
  } catch (const YAML::Exception& error) {
    if (const std::optional<Place> tab = tab_in_indentation(text, error.mark.line))
      handler.builder().fail(handler.builder().at(tab->line, tab->column),
                             "a tab is used for indentation, which YAML does not allow; expected spaces");
    handler.builder().fail(handler.builder().at(error.mark.line + 1, error.mark.column + 1), error.msg);
  }
  return handler.builder().take_root();
}

}  // namespace carousel::config
