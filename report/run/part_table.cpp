#include "report/run/part_table.h"

#include <fmt/format.h>

#include "report/text/number_text.h"

namespace carousel::report {

std::string part_table(const PartCounts<Parts>& parts) {
  std::string out;
  Parts::for_each([&]<class P>(std::size_t) {
    using Counts = typename P::Counts;
    if (!parts.of<P>()) return;
    std::string counts;
    for (const Counter<Counts>& row : kCounters<Counts>)
      counts += fmt::format("{}{} {}", counts.empty() ? "" : "   ", row.name, grouped(row.value(*parts.of<P>())));
    out += fmt::format("{:<13}{}\n", P::kName, counts);
  });
  return out;
}

}  // namespace carousel::report
