#pragma once

#include <concepts>
#include <cstddef>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace carousel::report::html {

/// Text with the characters that HTML gives a meaning replaced.
std::string escaped(std::string_view text);

template <class... Parts>
class Pattern;

/// HTML that may stand in a page as it is. Only the two functions below make it. Markup comes from literals of this
/// program, and all else is escaped, so that no text of a file can end an element or begin a script.
class Html {
 public:
  Html() = default;
  const std::string& str() const { return text_; }
  bool empty() const { return text_.empty(); }
  Html& operator+=(const Html& other) {
    text_ += other.text_;
    return *this;
  }
  friend Html operator+(Html a, const Html& b) { return std::move(a += b); }

 private:
  template <class... Args>
  friend Html markup(Pattern<std::type_identity_t<Args>...> pattern, const Args&... args);
  friend Html json_script(std::string_view id, const nlohmann::ordered_json& data);
  explicit Html(std::string text) : text_(std::move(text)) {}

  std::string text_;
};

template <class T>
concept Number = std::is_arithmetic_v<T> && !std::same_as<T, char>;

// An argument of markup() as it goes into the page.
inline const std::string& part_of(const Html& html) {
  return html.str();
}
inline std::string part_of(std::string_view text) {
  return escaped(text);
}
template <Number T>
T part_of(T number) {
  return number;
}
template <class T>
using Part = std::decay_t<decltype(part_of(std::declval<const T&>()))>;

/// A literal with {} in it, as fmt::format takes them, checked against its arguments when it is compiled.
template <class... Args>
class Pattern {
 public:
  template <std::size_t N>
  consteval Pattern(const char (&literal)[N]) : text_(literal, N - 1) {
#if !defined(__clang__) || __clang_major__ > 14  // which calls no consteval constructor here; GCC checks the same lines
    [[maybe_unused]] const fmt::format_string<Part<Args>...> checked(literal);
#endif
  }
  std::string_view text() const {
    return text_;
  }

 private:
  std::string_view text_;
};

/// The pattern with its arguments: HTML as it is, text escaped, numbers as fmt writes them.
template <class... Args>
Html markup(Pattern<std::type_identity_t<Args>...> pattern, const Args&... args) {
  const std::tuple<Part<Args>...> parts(part_of(args)...);
  return std::apply(
      [&](const auto&... part) { return Html(fmt::vformat(pattern.text(), fmt::make_format_args(part...))); }, parts);
}

/// A script element with data for the page's scripts, which find it by its id. Nothing in the data can end it.
Html json_script(std::string_view id, const nlohmann::ordered_json& data);

}  // namespace carousel::report::html
