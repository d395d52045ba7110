#include "ringbus/cycle/parcels/fetch_doors.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

namespace {

template <class Message>
Parcel shape_parcel(const Message& message, DoorPlace to) {
  Parcel parcel;
  parcel.stop = to.node;
  parcel.door = to.door;
  parcel.size_bytes = message.bytes();
  parcel.body = message;
  return parcel;
}

}  // namespace

void FetchDoor::collect(Cycle now, std::vector<Parcel>& out) {
  while (client_.requests->next() <= now) split(client_.requests->take(), out);
}

void FetchDoor::split(const FetchRequest& request, std::vector<Parcel>& out) {
  const std::uint64_t begin = request.skipped, end = begin + request.written;  // bytes that are written
  for (FetchRequest& part : parts_) part.lines = 0;
  std::uint32_t parts = 0;
  for (std::uint64_t i = 0; i < request.lines; ++i) {
    const std::uint64_t line = request.first_line + i;
    FetchRequest& part = parts_[turns_.node_of(line)];
    if (part.lines++ == 0) {
      part = request;
      part.first_line = turns_.local(line);
      part.lines = 1;
      part.written = 0;
      part.skipped = i == 0 ? request.skipped : 0;
      ++parts;
    }
    const std::uint64_t from = std::max(begin, i * line_bytes_), to = std::min(end, (i + 1) * line_bytes_);
    part.written += from < to ? static_cast<std::uint32_t>(to - from) : 0;
  }
  const bool asks = request.written == 0;
  const std::uint32_t tag = asks ? waiting_.take({request.tag, parts, 0}) : 0;
  const std::uint64_t first = turns_.node_of(request.first_line);
  for (std::uint64_t i = 0; i < banks_.size(); ++i) {
    const std::uint64_t bank = (first + i) % banks_.size();
    if (parts_[bank].lines == 0) continue;
    parts_[bank].tag = tag;
    out.push_back(shape_parcel(parts_[bank], banks_[bank]));
  }
}

void FetchDoor::deliver(Parcel&& parcel, Cycle now) {
  const auto& answer = std::get<FetchAnswer>(parcel.body);
  Waiting& waiting = waiting_[answer.tag];
  waiting.size += answer.size;
  if (--waiting.parts > 0) return;
  client_.answers->send(now + kDoorCycles, {waiting.tag, waiting.size});
  waiting_.give_back(answer.tag);
}

void CacheDoor::collect(Cycle now, std::vector<Parcel>& out) {
  while (client_.answers->next() <= now) out.push_back(shape_parcel(client_.answers->take(), asker_));
}

void CacheDoor::deliver(Parcel&& parcel, Cycle now) {
  client_.requests->send(now + kDoorCycles, std::get<FetchRequest>(parcel.body));
}

}  // namespace carousel::ringbus::cycle
