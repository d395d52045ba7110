#include "ringbus/cycle/parcels/line_doors.h"

namespace carousel::ringbus::cycle {

namespace {

constexpr std::uint64_t kFlags = kWriteLine | kWholeLine;

Parcel line_parcel(std::uint64_t line, DoorPlace to, std::uint64_t bytes) {
  Parcel parcel;
  parcel.stop = to.node;
  parcel.door = to.door;
  parcel.size_bytes = bytes;
  parcel.body = LineMessage{line};
  return parcel;
}

}  // namespace

void AskDoor::collect(Cycle now, std::vector<Parcel>& out) {
  while (ends_.requests->next() <= now) {
    const std::uint64_t request = ends_.requests->take(), line = own_.global(request & ~kFlags);
    // What is written travels with its address.
    const std::uint64_t bytes = kAddressBytes + ((request & kWriteLine) != 0 ? line_bytes_ : 0);
    out.push_back(line_parcel(turns_.local(line) | (request & kFlags), banks_[turns_.node_of(line)], bytes));
  }
}

void AskDoor::deliver(Parcel&& parcel, Cycle now) {
  ends_.answers->send(now + kDoorCycles, own_.turns.local(std::get<LineMessage>(parcel.body).line));
}

void AnswerDoor::collect(Cycle now, std::vector<Parcel>& out) {
  while (ends_.answers->next() <= now)
    out.push_back(line_parcel(own_.global(ends_.answers->take()), asker_, line_bytes_));
}

void AnswerDoor::deliver(Parcel&& parcel, Cycle now) {
  ends_.requests->send(now + kDoorCycles, std::get<LineMessage>(parcel.body).line);
}

}  // namespace carousel::ringbus::cycle
