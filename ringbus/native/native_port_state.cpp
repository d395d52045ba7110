// The work that a port holds and waits for, at the end of a run, good or bad.
#include <algorithm>

#include <fmt/format.h>

#include "ringbus/native/native_port.h"

namespace carousel::ringbus {

bool NativePort::drained() const {
  const bool egress_empty =
      std::all_of(out_ports_.begin(), out_ports_.end(), [](const OutPort& out) { return out.egress.empty(); });
  const bool ends_empty =
      std::all_of(in_ports_.begin(), in_ports_.end(), [](const InPort& in) { return in.waiting.empty(); });
  if (packets_out() > 0 || !egress_empty || !ends_empty) return false;
  // A resource that has stopped took nothing in of what came back to it, and may have stopped when no ray needed that.
  if (logic_.stopped()) return true;
  const bool slots_free = machine_.control.free_slots(resource_.id()) == machine_.control.slots(resource_.id());
  return logic_.at_rest() && rounds_.empty() && (slots_free || closed_);
}

void NativePort::exclude(ResourceId stopped) {
  resource_.exclude(stopped);
  const std::vector<std::uint32_t>& managers = machine_.topology.manager_of();
  closed_ = !managers.empty() && managers[resource_.id().value] == stopped.value;
}

std::string NativePort::describe() const {
  std::string text = logic_.describe();
  if (!rounds_.empty()) text += fmt::format(", {} new rays wait for slots", rounds_.rays());
  for (const InPort& in : in_ports_)
    if (!in.waiting.empty())
      text += fmt::format("; {} waits for a place here, {} more behind it", logic_.describe(in.waiting.front()),
                          in.waiting.size() - 1);
  for (const OutPort& out : out_ports_) {
    if (out.egress.empty()) continue;
    text += fmt::format("; {} waits for a place in the link to resource {} (depth {}, {} more behind it)",
                        logic_.describe(out.egress.front()), out.link->to().value, out.link->capacity(),
                        out.egress.size() - 1);
  }
  return text;
}

}  // namespace carousel::ringbus
