#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/sweep/plan/content.h"
#include "app/sweep/plan/design.h"
#include "core/config/load/load.h"

namespace carousel::app {

/// One run of a sweep.
struct SweepPoint {
  Choice keys;                    ///< the varied keys
  std::vector<std::string> sets;  ///< the assignments that make its configuration
  std::string digest;             ///< digest of configuration, program and files: the name of its file
  std::string group;              ///< equal for points that share scene and acceleration structure
  std::size_t threads = 1;        ///< that its simulation uses

  /// "key=value, key=value", of the first eight keys.
  std::string text() const;
};

/// Makes points of choices.
class PointMaker {
 public:
  /// `sets` apply to all points.
  PointMaker(ConfigText source, std::filesystem::path config_folder, std::vector<std::string> sets);

  /// Reads and validates the configuration of a choice. Throws ConfigError, whose messages name the point's keys.
  SweepPoint make(const Choice& choice);

  const ConfigText& source() const { return source_; }

 private:
  ConfigText source_;
  std::vector<std::string> sets_;
  ContentDigests content_;
  std::string program_;
};

/// Makes the points of all choices; of points with equal configurations one is kept. Throws one ConfigError for all
/// that are wrong, each message once, with the first point that it is about.
std::vector<SweepPoint> make_points(PointMaker& maker, const std::vector<Choice>& choices);

/// All that scene and acceleration structure depend on.
std::string scene_group(const Config& config);

/// The threads that simulate a point: those of the configuration, or else one with the cycle engine, since points run
/// side by side.
std::size_t point_threads(const Config& config);

}  // namespace carousel::app
