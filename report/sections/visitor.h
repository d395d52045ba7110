#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/statistics/counters.h"
#include "report/text/ratio.h"

namespace carousel::report {

// Each section of the report is a struct with a function `describe(visitor, section)` beside it, which names every
// field with its unit and meaning. The JSON writer and the schema writer are such visitors. A visitor V offers
//   field(key, value, unit, meaning)                numbers, switches, texts, lists of texts, triples
//   section(key, value, meaning)                    structs and lists of structs
//   section_if(present, key, value, meaning)        a struct that only some runs have
//   any(key, value, meaning)                        JSON that has a schema of its own
// A value may be a std::optional, which is left out of the file when absent. Native runs leave out in this way all that
// needs a simulated clock. Counter structs of core/statistics describe themselves by their lists.
using carousel::describe;

/// Describes counters that only some runs have, as keys of the section.
template <class V, CounterStruct S>
void describe_if_any(V& v, const std::optional<S>& counts) {
  for (const Counter<S>& row : kCounters<S>)
    v.field(row.name, counts ? std::optional(row.value(*counts)) : std::nullopt, row.unit, row.meaning);
}

}  // namespace carousel::report
