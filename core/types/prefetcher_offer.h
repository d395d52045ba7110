#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>

#include "core/types/enum_names.h"

namespace carousel {

/// The rule by which a prefetcher beside an L2 chooses lines (`prefetcher.rule`). Plugins add others.
enum class PrefetchRule { kStrides };
template <>
inline constexpr auto kEnumNames<PrefetchRule> = [] {
  using enum PrefetchRule;
  return names<PrefetchRule>({{kStrides, "strides"}});
}();
template <>
inline constexpr std::string_view kAddedAs<PrefetchRule> = "prefetcher";

/// Takes the requests of a prefetcher. They go to its L2 over a wire, one behind the other, and each takes a port of
/// the L2 for as long as another's request.
class LinesAhead {
 public:
  virtual ~LinesAhead() = default;
  /// Asks for a line, by its number in memory, below 2^48. At most PrefetcherSetup::lines in one call of a prefetcher.
  virtual void ask(std::uint64_t line) = 0;
};

/// A prefetcher that a plugin brings: a part of the machine with a clock of its own. There is one beside each L2. It is
/// called by one thread at a time, in the order of time, and its answers must depend on these calls alone.
class Prefetcher {
 public:
  static constexpr std::uint64_t kNever = ~std::uint64_t{0};

  virtual ~Prefetcher() = default;
  /// In cycle `now` it hears that a shape buffer has asked its L2 for lines, the first of which is `line`. `resource`
  /// is the place of the buffer's resource among those behind the L2. Several may come in one cycle, by resource.
  virtual void hear(std::uint64_t line, std::uint32_t resource, std::uint64_t now, LinesAhead& ahead) = 0;
  /// The next cycle in which it has something to do besides; kNever if nothing. A cycle that is over ends the run.
  virtual std::uint64_t next() const { return kNever; }
  /// Does in cycle `now`, which is next(), what there is to do.
  virtual void step(std::uint64_t now, LinesAhead& ahead) {
    static_cast<void>(now);
    static_cast<void>(ahead);
  }
};

/// What a prefetcher of a plugin is made for.
struct PrefetcherSetup {
  std::int64_t lines = 1, streams = 1, reach = 1;  ///< the keys of its section
  std::uint32_t resources = 1;                     ///< behind its L2; 1 where its size alone is asked for
};

/// A prefetcher that a plugin brings. Functions may be called by several threads.
struct PrefetcherOffer {
  /// Makes one for each L2, anew for each run.
  std::function<std::unique_ptr<Prefetcher>(const PrefetcherSetup&)> make;
  /// Bytes of its tables, from which area and energy follow.
  std::function<std::uint64_t(const PrefetcherSetup&)> table_bytes;
  double words_per_hint = 1;  ///< of 64 bits, that it reads or writes there for each request of which it hears
};

}  // namespace carousel
