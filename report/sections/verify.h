#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

struct Verify {
  std::uint64_t compared = 0, mismatches = 0;
  std::string example;
};

template <class V>
void describe(V& v, const Verify& r) {
  v.field("compared", r.compared, "rays", "rays traced again, depth first");
  v.field("mismatches", r.mismatches, "rays", "rays whose hit differs in a bit");
  v.field("example", r.example, "", "one of the mismatches, or nothing");
}

struct Digest {
  std::string hits;
  std::optional<std::string> image{};
};

template <class V>
void describe(V& v, const Digest& r) {
  v.field("hits", r.hits, "", "128 bits over all rays and their hits, in any order");
  v.field("image", r.image, "", "hash of the linear picture; absent when no picture was made");
}

}  // namespace carousel::report
