#include "report/html/run_page.h"

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/machine_places.h"
#include "report/html/packed_series.h"
#include "report/html/run_sections.h"
#include "report/run/report_json.h"

namespace carousel::report::html {

std::string run_page(const Json& report, const Picture& picture, const HeatMap& heat, const Json* versus) {
  const Json schema = report_schema();
  // The list of all sections, in their order, each with its tab.
  const std::vector<Section> sections{
      {"answers", "The run at a glance", answers_section(report, picture, versus)},
      {"machine", "The machine", machine_section(report, schema), "Machine"},
      {"cycles", "Use of the cycles", cycles_section(report), "Machine"},
      {"waits", "Waiting, ranked", waits_section(report), "Machine"},
      {"gains", "Gain of a better part", gains_section(report, schema), "Gains"},
      {"bytes", "Bytes by wire", bytes_section(report, schema), "Bytes and energy"},
      {"energy", "Energy and area", energy_section(report, schema), "Bytes and energy"},
      {"frames", "Frames", frames_section(report, schema), "Frames"},
      {"time", "Over time", time_section(report), "Over time"},
      {"latency", "Latency", latency_section(report), "Over time"},
      {"rays", "Rays", rays_section(report, schema), "Rays"},
      {"collections", "Collections", collections_section(report, schema), "Rays"},
      {"depth", "Depths of the tree", depth_section(report, schema), "Tests"},
      {"tests", "Tests a ray", tests_section(report, schema), "Tests"},
      {"effects", "Effects of light", effects_section(report), "Tests"},
      {"sampled", "Estimates for the whole frame", sampled_section(report, schema)},
      {"ray-time", "Where a ray's cycles go", ray_time_section(report), "Rays"},
      {"heat", "Slow pixels", heat_section(report, schema, heat), "Rays"},
      {"verdict", "This run", verdict_section(report), "This run"},
      {"accuracy", "Correctness", accuracy_section(report, schema), "This run"},
      {"charges", "Not charged", charges_section(report), "This run"},
      {"configuration", "Configuration", configuration_section(report), "This run"},
      {"values", "Every value", values_section(report, schema), "This run"},
  };
  Json facts{{"resources", number_at(report, "config.topology.resources")}};
  for (const char* key : {"shape", "form", "rings", "groups"})
    if (const Json* value = find(report, std::string("config.topology.") + key)) facts[key] = *value;
  if (const Json* nodes = find(report, "drawing")) facts["drawing"] = *nodes;
  Json& places = facts["places"] = Json::array();
  for (const Place& place : machine_places(report).at) places.push_back({place.x, place.y});
  const Json* series = find(report, "time_series");
  const std::string scene = text_at(report, "scene.name");
  std::string machine = machine_words(report);
  if (const double frames = number_at(report, "frames.count"); frames > 0)
    machine += fmt::format("; a series of {} frames, of which this page shows the last", frames);
  const bool rays = !find(report, "traffic") && !find(report, "memory_trace") && !scene.empty();
  return page_of(rays                           ? "Carousel: " + scene
                 : find(report, "memory_trace") ? "Carousel: a trace of memory requests"
                                                : "Carousel: synthetic traffic",
                 machine, sections, facts, (series ? packed_series(*series) : Html()) + packed_heat(report, heat));
}

}  // namespace carousel::report::html
