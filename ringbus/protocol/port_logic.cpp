#include "ringbus/protocol/port_logic.h"

#include <fmt/format.h>

namespace carousel::ringbus {

std::string PortLogic::describe() const {
  std::string text = fmt::format("resource {}: {} of {} slots free, {} collections with {} memberships, {} packets out",
                                 here().value, machine_.control_of(here()).free_slots(here()), resource_.rays().slots(),
                                 resource_.collections().collections(), resource_.collections().memberships(),
                                 resource_.packets_in_flight());
  if (!admission.empty()) text += fmt::format(", {} new rays wait for storage", admission.rays());
  return text;
}

std::string PortLogic::describe(PacketId id) const {
  const Packet& packet = machine_.packet(id);
  std::string text = fmt::format("packet {} of resource {}", id.value, packet.owner.value);
  if (packet.members.empty()) return text;
  const RayIdLayout& layout = resource_.rays().layout();
  const RayId ray = packet.members[0].ray;
  return text + fmt::format(" (first ray {}:{})", layout.owner(ray).value, layout.slot(ray));
}

}  // namespace carousel::ringbus
