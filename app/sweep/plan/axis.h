#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace carousel::app {

/// A key of the configuration and the text of its value, as --set takes them.
using KeyValue = std::pair<std::string, std::string>;

/// Keys that vary together, and the values that they take.
struct Axis {
  std::vector<std::string> keys;
  std::vector<std::vector<std::string>> levels;  ///< a value a key each

  /// A range of which only a number of values is asked for. A hypercube draws from the whole of it.
  struct Span {
    double low = 0, high = 0;
    bool logarithmic = false, integral = false;
    /// The value at `part` of the way, in [0, 1].
    std::string at(double part) const;
  };
  std::optional<Span> span;
};

/// An axis as on the command line: `key=a,b,c`, `key=1..8`, `key=1..64*2`, `key=8..64+8`, `key=0..1:5`,
/// `key=log:64..4096:7`, `key1,key2=(a,b),(c,d)`. Throws ConfigError.
Axis parse_axis(const std::string& text);

/// An axis as under `vary` in a configuration: each value is one of the forms above without its key. `where` is the
/// text that messages show.
Axis make_axis(const std::string& keys, const std::vector<std::string>& values, const std::string& where);

/// The scenes of `--scene`, files or builtin:<name>: an axis of the key `scene`.
Axis scene_axis(const std::vector<std::string>& scenes);

/// Points that are left out: those for which all conditions hold, as in `key=8,other>=2`.
struct Exclusion {
  struct Condition {
    std::string key, comparison, value;
  };
  std::vector<Condition> conditions;
  bool holds(const std::vector<KeyValue>& point) const;
};

/// Throws ConfigError for text that is no list of conditions, or that names a key that no axis varies.
Exclusion parse_exclusion(const std::string& text, const std::vector<Axis>& axes);

/// Splits at a character that stands outside of brackets and quotation marks.
std::vector<std::string> split_outside(const std::string& text, char separator);

/// The number that the whole text is, if it is one.
std::optional<double> number_of(const std::string& text);

}  // namespace carousel::app
