// A plugin that does wrong what the environment says, for the messages of those who refuse it.
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string>

#include "ringbus/plugin/bring.h"

namespace {

using namespace carousel;

std::string fault() {
  const char* const text = std::getenv("CAROUSEL_TEST_FAULT");
  return text == nullptr ? "" : text;
}

std::uint32_t any_bucket(const ringbus::CollectionFacts&, const ringbus::PolicyScale&) {
  return 0;
}

std::uint32_t beyond(const RayRequest&, const ringbus::PlacementFacts& facts) {
  return static_cast<std::uint32_t>(facts.free_slots.size());
}

/// Takes what cannot go on, or what is not there.
std::size_t hasty(std::span<const WaitingPacket> packets) {
  for (std::size_t i = 0; i < packets.size(); ++i)
    if (!packets[i].may_go && fault() == "hasty") return i;
  return packets.size();
}

/// Sends packets to where they come from, or nowhere.
std::size_t lost(const RouterQuestion& question) {
  if (fault() == "nowhere") return question.links.size();
  return question.at % 2 == 0 ? 0 : question.links.size() - 1;
}

/// Says that it made a ray, and made none.
class Liar final : public Workload {
 public:
  Generated generate(WorkerId, std::size_t, RayBatch&) override { return {1, true}; }
  void shade(WorkerId, const HitBatch&, RayBatch&) override {}
};

MadeWorkload make(const WorkloadSetup&) {
  if (fault() == "no workload") throw std::runtime_error("there are no beams today");
  return {std::make_unique<Liar>(), 1};
}

/// Breaks the contract of a prefetcher in the way that the environment names.
class Breaker final : public Prefetcher {
 public:
  void hear(std::uint64_t line, std::uint32_t, std::uint64_t now, LinesAhead& ahead) override {
    if (fault() == "greedy")
      for (std::uint64_t i = 0; i < 5; ++i) ahead.ask(line + i);
    if (fault() == "nowhere") ahead.ask(~std::uint64_t{0});
    heard_ = now;
  }
  std::uint64_t next() const override { return fault() == "late" && heard_ > 0 ? heard_ - 1 : kNever; }

 private:
  std::uint64_t heard_ = 0;
};

std::unique_ptr<Prefetcher> make_breaker(const PrefetcherSetup&) {
  return fault() == "no prefetcher" ? nullptr : std::make_unique<Breaker>();
}

void bring(PluginParts& parts) {
  const ringbus::IssuePolicy policy{.policy = {}, .bucket = any_bucket};
  if (fault() == "nothing") return;
  if (fault() == "throws") throw std::runtime_error("no licence");
  if (fault() == "null") return ringbus::bring_policy(parts, "lazy", {});
  if (fault() == "twice") ringbus::bring_policy(parts, "lazy", policy);
  if (fault() == "taken") ringbus::bring_policy(parts, "oldest", policy);
  if (fault() == "badly named") ringbus::bring_policy(parts, "My Policy", policy);
  if (fault() == "another's") ringbus::bring_policy(parts, "broad_first", policy);
  ringbus::bring_policy(parts, "lazy", policy);
  ringbus::bring_placement(parts, "beyond", {.choose = beyond});
  ringbus::bring_router(parts, "lost", {.choose = lost});
  ringbus::bring_dispatch(parts, "hasty", {.choose = hasty});
  ringbus::bring_prefetcher(parts, "breaker",
                            {.make = make_breaker, .table_bytes = [](const PrefetcherSetup&) { return 64; }});
  ringbus::bring_workload(parts, "liar", {.options = {}, .make = make});
}

}  // namespace

extern "C" const PluginInfo* carousel_plugin() {
  static PluginInfo info = plugin("faulty", "0.1", bring);
  if (fault() == "compiler") info.compiler = "compiler 1.0";
  if (fault() == "no description") return nullptr;
  if (fault() == "nameless") info.name = "";
  return &info;
}
