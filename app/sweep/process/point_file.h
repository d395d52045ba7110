#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "app/sweep/plan/point.h"

namespace carousel::app {

/// The reason why a point has no result. `kind`: config, scene, file, memory, simulation, verification, signal, exit.
struct PointError {
  std::string kind, text;
};

/// The file of a finished point: `points/<digest>.json` with the varied keys, the assignments and either the report of
/// the run or the error, and, after a failed verification, both. It appears as a whole, by rename.
struct PointFile {
  std::string digest;
  nlohmann::ordered_json keys = nlohmann::ordered_json::object();
  double seconds = 0;  ///< seconds that the point's process took, by the wall clock
  std::optional<PointError> error;
  nlohmann::ordered_json report;  ///< null if there is none

  bool done() const { return !error; }
};

std::filesystem::path point_path(const std::filesystem::path& out, const std::string& digest);

/// Throws FileError.
void write_point(const std::filesystem::path& out, const SweepPoint& point, double seconds,
                 const std::optional<PointError>& error, const nlohmann::ordered_json& report);

/// Absent if there is no such file, or one that is not believed (report/read/document.h), whose point then runs again.
std::optional<PointFile> read_point(const std::filesystem::path& file);

/// A value of a key as JSON: a number or a switch where the text is one.
nlohmann::ordered_json value_json(const std::string& text);
nlohmann::ordered_json keys_json(const Choice& keys);

}  // namespace carousel::app
