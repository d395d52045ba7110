#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/schema/checksum.h"
#include "report/schema/document_version.h"
#include "report/sections/costs.h"
#include "report/sections/visitor.h"

namespace carousel::report {

/// A mean over seeds of the picture.
struct VersusMean {
  double mean = 0;
  std::optional<double> error{};
};

template <class V>
void describe(V& v, const VersusMean& r) {
  v.field("mean", r.mean, "unit of the row", "mean over the seeds");
  v.field("error", r.error, "unit of the row", "half of the interval that holds the mean (95 %); absent with one seed");
}

/// How many times as much one machine has as another, by pairs of runs with one seed.
struct VersusRatio {
  double ratio = 0;
  std::optional<double> low{}, high{};

  bool surely_more() const { return low && *low > 1; }
  bool surely_less() const { return high && *high < 1; }
};

template <class V>
void describe(V& v, const VersusRatio& r) {
  v.field("ratio", r.ratio, "", "geometric mean over the seeds");
  v.field("low", r.low, "", "lower end of its interval of confidence (95 %); absent with one seed");
  v.field("high", r.high, "", "upper end of the interval");
}

struct VersusMachine {
  std::string name;
  std::uint64_t resources = 0;
  double mm2 = 0;
  VersusMean rays_per_kilocycle{}, memory_bytes_per_ray{}, nj_per_ray{};
  std::optional<double> lane_fill{};
  std::string limits{};
  double reached = 0;
};

template <class V>
void describe(V& v, const VersusMachine& r) {
  v.field("name", r.name, "", "machine, twin or twin_at_equal_area");
  v.field("resources", r.resources, "resources", "its resources");
  v.field("mm2", r.mm2, "mm2", "its area, without the memory and its pins");
  v.section("rays_per_kilocycle", r.rays_per_kilocycle, "completed rays in 1,000 cycles");
  v.section("memory_bytes_per_ray", r.memory_bytes_per_ray, "bytes from and to memory for each completed ray");
  v.section("nj_per_ray", r.nj_per_ray, "nanojoules for each completed ray");
  v.field("lane_fill", r.lane_fill, "fraction", "part of the lanes of its warps whose ray had not ended, first seed");
  v.field("limits", r.limits, "", "class of parts with the tightest bound, first seed");
  v.field("reached", r.reached, "fraction", "rate of the run over that bound");
}

/// This machine against one of the twins.
struct VersusPair {
  std::string than, verdict;
  VersusRatio speed{}, bytes{}, joules{};
};

template <class V>
void describe(V& v, const VersusPair& r) {
  v.field("than", r.than, "", "twin or twin_at_equal_area");
  v.field("verdict", r.verdict, "", "faster, slower, alike where the interval holds 1, or unsure of one seed");
  v.section("speed", r.speed, "rays a cycle of this machine over those of the twin");
  v.section("bytes", r.bytes, "bytes of memory a ray, likewise");
  v.section("joules", r.joules, "joules a ray, likewise");
}

struct VersusRun {
  std::string machine;
  std::uint64_t seed = 0, rays = 0, cycles = 0;
  double rays_per_kilocycle = 0, memory_bytes_per_ray = 0, nj_per_ray = 0;
  std::string hits{}, nearest{}, image{};
};

template <class V>
void describe(V& v, const VersusRun& r) {
  v.field("machine", r.machine, "", "machine, twin or twin_at_equal_area");
  v.field("seed", r.seed, "", "seed of the picture");
  v.field("rays", r.rays, "rays", "completed rays");
  v.field("cycles", r.cycles, "cycles", "cycles of the frame");
  v.field("rays_per_kilocycle", r.rays_per_kilocycle, "rays/1000 cycles", "their rate");
  v.field("memory_bytes_per_ray", r.memory_bytes_per_ray, "bytes/ray", "bytes from and to memory");
  v.field("nj_per_ray", r.nj_per_ray, "nJ/ray", "energy");
  v.field("hits", r.hits, "", "digest of the hits, which is the same for all machines");
  v.field("nearest", r.nearest, "",
          "digest of all hits of rays that look for several, likewise; empty if none do. Gaussians are not in it");
  v.field("image", r.image, "", "digest of the picture, likewise; empty for a list of rays");
}

/// The slower machine with one class of parts relaxed.
struct VersusTurn {
  std::string name, action;
  std::vector<std::string> sets;
  double gain = 0, speed = 0;
};

template <class V>
void describe(V& v, const VersusTurn& r) {
  v.field("name", r.name, "", "class of parts");
  v.field("action", r.action, "", "change that relaxes it");
  v.field("sets", r.sets, "", "the same change as values of --set");
  v.field("gain", r.gain, "fraction", "gain of the slower machine by it");
  v.field("speed", r.speed, "", "speed of the slower machine with it over that of the faster as it is");
}

/// The report of `carousel versus`.
struct Versus {
  std::int64_t schema_version = kDocumentVersion;
  std::uint64_t seeds = 0;
  std::string profile, slower;
  std::vector<VersusMachine> machines{};
  std::vector<VersusPair> against{};
  std::vector<VersusTurn> turns{};
  std::vector<std::string> lines{}, twin_sets{};
  std::optional<std::string> drawing{};
  std::vector<VersusRun> runs{};
  std::optional<AreaSearch> search{}, twin_search{};
  std::optional<std::string> checksum{};  ///< set where the text is written (report/read/document.h)
};

template <class V>
void describe(V& v, const Versus& r) {
  v.field("schema_version", r.schema_version, "", "version of these keys");
  v.field("seeds", r.seeds, "seeds", "seeds of the picture with which each machine was simulated");
  v.field("profile", r.profile, "", "process of joules and areas");
  v.field("slower", r.slower, "", "the slower of machine and twin, whose parts were relaxed");
  v.field("lines", r.lines, "", "the answer in five lines");
  v.section("machines", r.machines, "this machine, its conventional twin, and the twin that has as much area");
  v.section("against", r.against, "this machine against each twin");
  v.section("turns", r.turns, "the slower machine with each class of its parts relaxed, the greatest gain first");
  v.field("twin_sets", r.twin_sets, "", "keys in which the twin differs from this machine, with its values");
  v.field("drawing", r.drawing, "",
          "of a machine that is drawn: how the twin's network follows from the drawing, or why it does not");
  v.section("runs", r.runs, "every simulated frame");
  v.section("search", r.search, "the search for this machine's best split of area.budget_mm2, with area.fit: best");
  v.section("twin_search", r.twin_search, "likewise, that of the twin at equal area");
  v.field("checksum", r.checksum, "", kChecksumMeaning);
}

/// The mean of some values, and of the ratios of the values of the same seeds.
VersusMean versus_mean(const std::vector<double>& values);
VersusRatio versus_ratio(const std::vector<double>& ours, const std::vector<double>& theirs);

/// The five lines: faster or slower by how much, bytes and joules, at equal area, the part that decides, and what would
/// turn it round. Needs all else.
std::vector<std::string> versus_lines(const Versus& versus);

}  // namespace carousel::report
