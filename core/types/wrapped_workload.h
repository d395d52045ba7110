#pragma once

#include "core/types/workload.h"

namespace carousel {

/// A workload that passes every call on to another one. Derived classes look at some of the calls, or change them.
class WrappedWorkload : public Workload {
 public:
  /// Keeps a reference.
  explicit WrappedWorkload(Workload& inner) : inner_(inner) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    return inner_.generate(worker, max_rays, out);
  }
  ShadeWork extra_work(const RayResult& result) const override { return inner_.extra_work(result); }
  std::uint32_t shader(const RayResult& result) const override { return inner_.shader(result); }
  ShadeFacts shade_facts(const RayResult& result) const override { return inner_.shade_facts(result); }
  ShadeFacts any_hit_facts(const RayResult& call) const override { return inner_.any_hit_facts(call); }
  PathMemory path_memory(const RayTag& tag) const override { return inner_.path_memory(tag); }
  void sky_reads(const RayResult& result, std::vector<SkyRead>& out) const override { inner_.sky_reads(result, out); }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    inner_.shade(worker, completed, out);
  }

 protected:
  Workload& inner_;
};

}  // namespace carousel
