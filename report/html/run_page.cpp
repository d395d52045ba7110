#include "report/html/run_page.h"

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/packed_series.h"
#include "report/html/run_sections.h"
#include "report/run/report_json.h"

namespace carousel::report::html {

std::string run_page(const Json& report, const Picture& picture, const Picture& heat) {
  const Json schema = report_schema();
  const std::vector<Section> sections{
      {"verdict", "The run at a glance", verdict_section(report, picture)},
      {"sampled", "Estimates for the whole frame", sampled_section(report, schema)},
      {"machine", "The machine", machine_section(report, schema)},
      {"cycles", "Use of the cycles", cycles_section(report)},
      {"ray-time", "Where a ray's cycles go", ray_time_section(report)},
      {"heat", "Slow pixels", heat_section(report, schema, heat)},
      {"waits", "Waiting, ranked", waits_section(report)},
      {"gains", "Gain of a better part", gains_section(report, schema)},
      {"bytes", "Bytes by wire", bytes_section(report, schema)},
      {"energy", "Energy and area", energy_section(report, schema)},
      {"time", "Over time", time_section(report)},
      {"latency", "Latency", latency_section(report)},
      {"collections", "Collections", collections_section(report, schema)},
      {"depth", "Depths of the tree", depth_section(report, schema)},
      {"rays", "Rays", rays_section(report, schema)},
      {"tests", "Tests a ray", tests_section(report, schema)},
      {"effects", "Effects of light", effects_section(report)},
      {"accuracy", "Correctness", accuracy_section(report, schema)},
      {"configuration", "Configuration", configuration_section(report)},
      {"values", "Every value", values_section(report, schema)},
  };
  Json facts{{"resources", number_at(report, "config.topology.resources")}};
  for (const char* key : {"shape", "form", "rings", "groups"})
    if (const Json* value = find(report, std::string("config.topology.") + key)) facts[key] = *value;
  if (const Json* nodes = find(report, "drawing")) facts["drawing"] = *nodes;
  const Json* series = find(report, "time_series");
  const std::string scene = text_at(report, "scene.name");
  return page_of(scene.empty() ? "Carousel: synthetic traffic" : "Carousel: " + scene, machine_words(report), sections,
                 facts, series ? packed_series(*series) : Html());
}

}  // namespace carousel::report::html
