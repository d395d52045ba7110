#include "report/stress/stress_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report {

namespace {

std::string ns_text(double ns) {
  if (ns < 1e4) return fmt::format("{:.0f} ns", ns);
  if (ns < 1e7) return fmt::format("{:.1f} us", ns * 1e-3);
  return fmt::format("{:.1f} ms", ns * 1e-6);
}

std::string latency_text(const StressRow& row) {
  const std::optional<StressLatency>& l = row.round_trip ? row.round_trip : row.transit;
  if (!l) return "-";
  return fmt::format("{} / {} / {} / {}", ns_text(l->p50), ns_text(l->p99), ns_text(l->p99_9), ns_text(l->max));
}

void alone(const Stress& s, std::string& out) {
  std::string block;
  for (const StressRow& row : s.rows) {
    const std::string name =
        fmt::format("{}, {} bytes, {} threads, capacity {}", row.pattern, row.message_bytes, row.threads, row.capacity);
    // A pattern of many queues at once may have one row with fewer threads; the block is told by pattern and size.
    const std::string key = fmt::format("{} {}", row.pattern, row.message_bytes);
    if (key != block) {
      block = key;
      out += fmt::format("\n{}\n  {:<14}{:>10}{:>18}  {:<44}{:>6}{:>9}{:>9}{:>9}{:>10}\n", name, "", "Mmsg/s",
                         "least-most",
                         row.round_trip ? "round trip p50 / p99 / p99.9 / max" : "transit p50 / p99 / p99.9 / max",
                         "fair", "push ref", "pop ref", "blocked", "memory");
    }
    out += fmt::format(
        "  {:<14}{:>10.3g}{:>18}  {:<44}{:>6.2f}{:>9}{:>9}{:>9}{:>10}{}\n", row.queue, row.rate_median * 1e-6,
        fmt::format("{:.3g}-{:.3g}", row.rate_least * 1e-6, row.rate_most * 1e-6), latency_text(row), row.fairness,
        percent(row.push_refused), percent(row.pop_refused), percent(row.blocked), bytes_text(row.memory_bytes),
        row.found.empty()      ? ""
        : row.expected.empty() ? "  BROKEN: " + row.found + " (" + row.detail + ")"
                               : "  expected: " + row.found + " (" + row.expected + ")");
  }
}

void inside(const Stress& s, std::string& out) {
  if (s.ring.empty()) return;
  out += fmt::format("\ninside the ring, {}\n  {:<14}{:>6}{:>12}{:>18}{:>10}{:>10}{:>11}\n", s.ring_key, "", "depth",
                     "rays/s", "least-most", "of best", "refused", "occupancy");
  for (const StressRingRow& row : s.ring)
    out +=
        fmt::format("  {:<14}{:>6}{:>12}{:>18}{:>10}{:>10}{:>11.1f}{}\n", row.queue, row.depth, scaled(row.rate_median),
                    scaled(row.rate_least) + "-" + scaled(row.rate_most), percent(row.relative), percent(row.refused),
                    row.occupancy_mean, row.same_digest ? "" : "  BROKEN: other hits or another image");
  if (!s.ring_verdict.empty()) out += s.ring_verdict + "\n";
}

}  // namespace

std::string stress_table(const Stress& s) {
  std::string out = singular(fmt::format("{} cores, {} repetitions of each, in turn, {}{}\n", s.cores, s.repetitions,
                                         seconds_text(s.seconds), s.incomplete ? ", incomplete" : ""));
  alone(s, out);
  inside(s, out);
  const bool found = std::any_of(s.rows.begin(), s.rows.end(), [](const StressRow& row) { return !row.found.empty(); });
  out += s.broken() ? "\nbroken\n"
         : found    ? "\nnothing but what is expected of a design\n"
                    : "\nnothing lost, doubled, reordered or torn; nothing stuck\n";
  return out;
}

}  // namespace carousel::report
