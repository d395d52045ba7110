#pragma once

#include "core/statistics/byte_row.h"
#include "report/sections/visitor.h"

namespace carousel::report {

template <class V>
void describe(V& v, const ByteRow& r) {
  v.field("what", r.what, "", "kind of message");
  v.field("from", r.from, "", "parts that send it");
  v.field("to", r.to, "", "parts that receive it");
  v.field("over", r.over, "", "wires or ports that it occupies");
  v.field("width_bytes_per_cycle", r.width, "bytes/cycle",
          "width of each of these wires or ports; that of DRAM is rounded to whole bytes");
  v.field("bytes", r.bytes, "bytes", "bytes sent; a checked build compares them with the bytes received");
  v.field("messages", r.messages, "messages", "messages sent");
}

}  // namespace carousel::report
