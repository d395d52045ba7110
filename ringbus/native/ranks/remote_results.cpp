#include "ringbus/native/ranks/remote_results.h"

namespace carousel::ringbus {

void RemoteResults::take(std::span<const ResultOnWire> results) {
  for (std::size_t i = 0; i < results.size();) {
    const ResourceId resource = results[i].resource;
    slots_.clear();
    for (; i < results.size() && results[i].resource == resource; ++i) {
      machine_.stores.at(resource.value)->retire(results[i].slot);
      slots_.push_back(results[i].slot);
      results_.push_back(results[i].result);
    }
    machine_.control.free(resource, slots_);
  }
}

void RemoteResults::hand_over() {
  if (results_.empty()) return;
  HitBatch* const batch = completed_.try_take();
  if (batch == nullptr) return;
  batch->swap(results_);
  completed_.push(batch, batch->size());
}

}  // namespace carousel::ringbus
