#include "app/plugins/own_rays.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/system/plain_text.h"
#include "core/types/added_names.h"

namespace carousel::app {

OwnRays::OwnRays(OwnWorkload own, const WorkloadSetup& setup, const KeyPositions& positions) : workers_(setup.workers) {
  const auto* const offer = added_body<WorkloadOffer>(own);
  if (offer == nullptr) throw SimulationError("no such workload of a plugin");
  const auto refuse = [&](const std::string& why) {
    throw ConfigError(
        {{positions.find("workload.plugin"), "workload.plugin", fmt::format("{} {}", enum_name(own), why)}});
  };
  MadeWorkload made;
  try {
    made = offer->make(setup);
  } catch (const std::exception& error) {
    refuse(fmt::format("gives up: {}", plain_text(error.what())));
  }
  if (!made.workload) refuse("makes no workload");
  inner_ = std::move(made.workload);
  first_rays_ = std::max<std::uint64_t>(1, made.first_rays);
}

Workload::Generated OwnRays::generate(WorkerId worker, std::size_t max_rays, RayBatch& out) {
  const std::size_t before = out.size();
  const Generated made = inner_->generate(worker, max_rays, out);
  if (out.size() < before || made.rays != out.size() - before || made.rays > max_rays)
    throw SimulationError(fmt::format("the plugin's workload says that it made {} rays of at most {}, and made {}",
                                      made.rays, max_rays, out.size() - std::min(before, out.size())));
  count(worker, out, before);
  return made;
}

void OwnRays::shade(WorkerId worker, const HitBatch& completed, RayBatch& out) {
  for (const RayResult& result : completed) {
    workers_[worker.value].digest.add(hit_term(result.tag.path, 0, result.tag, result.hit));
    if (recorder_ != nullptr) recorder_->record(worker, result.tag.path, 0, result);
  }
  const std::size_t before = out.size();
  inner_->shade(worker, completed, out);
  count(worker, out, before);
}

void OwnRays::count(WorkerId worker, const RayBatch& out, std::size_t from) {
  for (std::size_t i = from; i < out.size(); ++i)
    ++workers_[worker.value].emitted[std::min(static_cast<std::size_t>(out[i].tag.kind), std::size_t{kRayKinds - 1})];
}

std::array<std::uint64_t, kRayKinds> OwnRays::emitted() const {
  std::array<std::uint64_t, kRayKinds> sum{};
  for (const Worker& worker : workers_)
    for (std::size_t kind = 0; kind < sum.size(); ++kind) sum[kind] += worker.emitted[kind];
  return sum;
}

HitsDigest OwnRays::hits_digest() const {
  HitsDigest sum;
  for (const Worker& worker : workers_) sum.add(worker.digest);
  return sum;
}

}  // namespace carousel::app
