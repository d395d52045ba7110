#include "app/accuracy/certificate.h"

#include <algorithm>
#include <chrono>

#include "accel/certificate/properties.h"
#include "app/accuracy/spawn_property.h"

namespace carousel::app {

namespace {

constexpr std::size_t kRound = 2048;  ///< cases of a property before the next has its turn
constexpr std::size_t kPart = 64;     ///< cases of a round that are one task

void add(LevelResult& sum, const accel::Judgement& judgement, std::uint64_t number) {
  if (!judgement.applies) return;
  ++sum.cases;
  if (judgement.error > sum.worst_error) sum.worst_error = judgement.error;  // NaN does not count as an error
  if (!judgement.broken) return;
  ++sum.broken;
  if (!sum.first_broken) sum.first_broken = number;
}

void add(LevelResult& sum, const LevelResult& later) {
  sum.cases += later.cases;
  sum.broken += later.broken;
  sum.worst_error = std::max(sum.worst_error, later.worst_error);
  if (!sum.first_broken) sum.first_broken = later.first_broken;
}

/// Cases [first, first + count) of a property, added to `result` in their order.
void try_cases(PropertyResult& result, std::uint64_t seed, std::uint64_t first, std::size_t count, Executor& executor) {
  std::vector<AccuracyConfig> levels;
  for (const LevelResult& level : result.levels) levels.push_back(level.level);
  std::vector<std::vector<LevelResult>> parts((count + kPart - 1) / kPart);
  executor.parallel_for(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      parts[p].resize(levels.size());
      const std::uint64_t last = first + std::min(count, (p + 1) * kPart);
      for (std::uint64_t number = first + p * kPart; number < last; ++number) {
        std::vector<accel::Judgement> judgements(levels.size());
        result.property->judge(certificate_case(*result.property, seed, number), levels, judgements, nullptr);
        for (std::size_t l = 0; l < levels.size(); ++l) add(parts[p][l], judgements[l], number);
      }
    }
  });
  for (const std::vector<LevelResult>& part : parts)
    for (std::size_t l = 0; l < part.size(); ++l) add(result.levels[l], part[l]);
}

}  // namespace

const std::vector<accel::Property>& certified_properties() {
  static const std::vector<accel::Property> properties{
      accel::box_property(),       accel::nested_boxes_property(), accel::triangle_property(),
      accel::distance_property(),  accel::closed_mesh_property(),  accel::placed_mesh_property(),
      accel::transform_property(), accel::world_box_property(),    spawn_property()};
  return properties;
}

accel::CaseValues certificate_case(const accel::Property& property, std::uint64_t seed, std::uint64_t number) {
  accel::CaseRandom random(seed, property.number, number);
  return property.make(random);
}

std::uint64_t Certificate::violations() const {
  std::uint64_t sum = 0;
  for (const PropertyResult& result : properties)
    for (const LevelResult& level : result.levels) sum += level.promised ? level.broken : 0;
  return sum;
}

Certificate certify(std::uint64_t seed, const CertificateLimits& limits, const std::optional<AccuracyConfig>& level,
                    Executor& executor, const std::function<bool()>& stopped,
                    const std::function<void(double part, std::uint64_t cases)>& progress) {
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  Certificate out;
  out.seed = seed;
  for (const accel::Property& property : certified_properties()) {
    PropertyResult& result = out.properties.emplace_back(PropertyResult{&property, {}});
    for (const AccuracyConfig& one : level ? std::vector<AccuracyConfig>{*level} : levels_of(property)) {
      LevelResult& row = result.levels.emplace_back();
      row.level = one;
      row.promised = property.promised(one);
    }
  }
  while (limits.cases ? out.cases < *limits.cases : elapsed() < limits.seconds) {
    out.incomplete = stopped();
    if (out.incomplete) break;
    const std::size_t count = limits.cases ? std::min<std::uint64_t>(kRound, *limits.cases - out.cases) : kRound;
    for (PropertyResult& result : out.properties) try_cases(result, seed, out.cases, count, executor);
    out.cases += count;
    const double part =
        limits.cases ? static_cast<double>(out.cases) / static_cast<double>(*limits.cases) : elapsed() / limits.seconds;
    if (progress) progress(part, out.cases * out.properties.size());
  }
  out.seconds = elapsed();
  return out;
}

}  // namespace carousel::app
