// A part with a clock as a plugin, `prefetcher: {lines: 2, rule: pairs}`: which lines an L2 fetches ahead.
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "ringbus/plugin/bring.h"

namespace {

/// Remembers which line a resource asked for after another (D. Joseph and D. Grunwald, Prefetching using Markov
/// predictors, ISCA 1997, with one successor). A look-up takes three cycles, and one may begin in each.
class Pairs final : public carousel::Prefetcher {
 public:
  static constexpr std::size_t kEntriesPerStream = 64;
  static constexpr std::uint64_t kLookUpCycles = 3;

  explicit Pairs(const carousel::PrefetcherSetup& setup)
      : lines_(setup.lines), last_(setup.resources), table_(entries(setup)) {}

  void hear(std::uint64_t line, std::uint32_t resource, std::uint64_t now, carousel::LinesAhead&) override {
    at(last_[resource]) = {last_[resource], line};
    last_[resource] = line;
    look_ups_.push_back({line, now + kLookUpCycles});
  }
  std::uint64_t next() const override { return look_ups_.empty() ? kNever : look_ups_.front().done; }
  void step(std::uint64_t now, carousel::LinesAhead& ahead) override {
    std::uint64_t line = look_ups_.front().line;
    look_ups_.pop_front();
    for (LookUp& later : look_ups_)
      if (later.done <= now) later.done = now + 1;  // one a cycle
    for (std::int64_t i = 0; i < lines_; ++i) {
      const Pair& pair = at(line);
      if (pair.line != line || pair.next == line) return;
      ahead.ask(line = pair.next);
    }
  }

  static std::size_t entries(const carousel::PrefetcherSetup& setup) {
    return kEntriesPerStream * static_cast<std::size_t>(setup.streams);
  }

 private:
  struct Pair {
    std::uint64_t line = 0, next = 0;
  };
  struct LookUp {
    std::uint64_t line, done;
  };

  Pair& at(std::uint64_t line) { return table_[line % table_.size()]; }

  std::int64_t lines_;
  std::vector<std::uint64_t> last_;  // by resource
  std::vector<Pair> table_;
  std::deque<LookUp> look_ups_;
};

}  // namespace

extern "C" const carousel::PluginInfo* carousel_plugin() {
  static const carousel::PluginInfo info = carousel::plugin("pairs of lines", "1.0", [](carousel::PluginParts& parts) {
    carousel::ringbus::bring_prefetcher(
        parts, "pairs",
        {.make = [](const carousel::PrefetcherSetup& setup) { return std::make_unique<Pairs>(setup); },
         // A line's number and the next one's. A hint writes a pair; a look-up reads `lines` of them.
         .table_bytes = [](const carousel::PrefetcherSetup& setup) { return 16 * Pairs::entries(setup); },
         .words_per_hint = 6});
  });
  return &info;
}
