#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/html/page.h"
#include "report/html/run_page.h"
#include "report/html/still.h"

namespace carousel::report::html {

// The bodies of the sections of a run's page, in its order. Each takes a checked report and gives HTML, or nothing if
// the report has nothing to show. `schema` is report_schema().

/// One screen: what limits the machine, why, what to change, what a ray costs.
/// `versus`: the report of versus of this machine, which is told beside it; null if there is none.
Html answers_section(const nlohmann::ordered_json& report, const Picture& picture,
                     const nlohmann::ordered_json* versus);
Html verdict_section(const nlohmann::ordered_json& report);
Html sampled_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html machine_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html cycles_section(const nlohmann::ordered_json& report);
Html ray_time_section(const nlohmann::ordered_json& report);
/// A sentence: where a ray spends most of its cycles; nothing without ray_time.
std::string longest_stages(const nlohmann::ordered_json& report);
Html heat_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema, const HeatMap& map);
/// The numbers of all pixels for web/src/heat_map.js; nothing if there are none, or more than a page should hold.
Html packed_heat(const nlohmann::ordered_json& report, const HeatMap& map);
Html waits_section(const nlohmann::ordered_json& report);
Html gains_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html bytes_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html energy_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
/// A series: its frames, with bars of their cycles and tests.
Html frames_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html time_section(const nlohmann::ordered_json& report);
Html latency_section(const nlohmann::ordered_json& report);
Html collections_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html depth_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html rays_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html tests_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
Html effects_section(const nlohmann::ordered_json& report);
Html accuracy_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
/// The parts that cost nothing in this run, with the keys that charge them, and the keys that have no effect in it.
Html charges_section(const nlohmann::ordered_json& report);
Html configuration_section(const nlohmann::ordered_json& report);
Html values_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);

// Pieces that several of them show.

/// The class of parts that limits the machine, with the interval of its gain, or why there is none.
std::string verdict_sentence(const nlohmann::ordered_json& report);
/// Says how the verdict changes in a larger picture, where a class gains while caches are cold; empty elsewhere.
std::string cold_sentence(const nlohmann::ordered_json& report);
/// The class that limits the machine when, if it is not always the same.
std::string phases_text(const nlohmann::ordered_json& report);
/// The gains of all classes, for still_gains().
std::vector<StillGain> still_gains_of(const nlohmann::ordered_json& report);
/// The use of the cycles by kind of part, as bars.
Html still_cycles(const nlohmann::ordered_json& report);

/// The link that is used most, the mean of all links, and both in a sentence; no text without such numbers.
struct BusiestLink {
  double use = 0, mean = 0;
  std::string text{};
};
BusiestLink busiest_link(const nlohmann::ordered_json& report);

/// A use of a unit's cycles as charts name it, such as "waits for memory" for `memory`; nothing for others.
std::string use_words(std::string_view key);

/// The machine against its conventional twin.
Html twin_card(const nlohmann::ordered_json& versus);

/// The machine in words: "8 resources in a ring".
std::string machine_words(const nlohmann::ordered_json& report);

}  // namespace carousel::report::html
