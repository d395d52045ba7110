#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "report/html/page.h"

namespace carousel::report::html {

// The bodies of the sections of a run's page, in its order. Each takes report.json and gives HTML, or nothing if the
// report has nothing to show. `schema` is report_schema().

std::string verdict_section(const nlohmann::ordered_json& report, const Picture& picture);
std::string sampled_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string machine_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string cycles_section(const nlohmann::ordered_json& report);
std::string waits_section(const nlohmann::ordered_json& report);
std::string gains_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string bytes_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string energy_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string time_section(const nlohmann::ordered_json& report);
std::string latency_section(const nlohmann::ordered_json& report);
std::string collections_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string depth_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string rays_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string tests_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string effects_section(const nlohmann::ordered_json& report);
std::string accuracy_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);
std::string configuration_section(const nlohmann::ordered_json& report);
std::string values_section(const nlohmann::ordered_json& report, const nlohmann::ordered_json& schema);

/// The machine in words: "8 resources in a ring".
std::string machine_words(const nlohmann::ordered_json& report);

}  // namespace carousel::report::html
