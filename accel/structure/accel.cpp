#include "accel/structure/accel.h"

namespace carousel::accel {

int Accel::strip_size(NodeKey key) const {
  if (partition && !partition->here(key.ref)) return instances[key.instance].strip_size;  // the root of the only one
  return key.ref.is_inner() ? nodes[key.ref.node()].count : static_cast<int>(key.ref.triangles());
}

std::uint32_t Accel::triangles_below(NodeKey key) const {
  return key.ref.is_inner() ? nodes[key.ref.node()].triangles : key.ref.triangles();
}

}  // namespace carousel::accel
