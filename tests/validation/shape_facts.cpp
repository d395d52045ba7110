// Prints, for each configuration, a line of JSON with the bytes of its compressed blocks of triangles and with its
// opacity micromaps, which tests/validation/shape_model.py reads in its own way.
//
//   shape_facts CONFIG...        a configuration that is refused gives {"error": TEXT}
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "accel/packed/packed_leaves.h"
#include "app/host/log.h"
#include "app/run/prepare.h"
#include "core/config/write.h"
#include "core/system/error.h"

namespace carousel {

namespace {

using Json = nlohmann::json;

/// The leaves of an instance: the block that each begins in, how many it has, and its triangles there.
void add_leaves(const accel::Accel& accel, accel::NodeRef ref, Json& out) {
  if (!ref.is_inner()) {
    const accel::PackedLeaves::Place& place = accel.packed->place(ref);
    if (!ref.is_procedural())
      out.push_back({place.begin / accel::kPackedBytes, place.blocks, place.first, place.triangles});
    return;
  }
  const accel::Node& node = accel.nodes[ref.node()];
  for (int lane = 0; lane < node.count; ++lane) add_leaves(accel, node.child[lane], out);
}

Json packed(const app::Prepared& prepared) {
  const accel::Accel& accel = prepared.accel;
  Json blocks = Json::array(), instances = Json::array();
  for (const accel::PackedBlock& block : accel.packed->blocks()) {
    std::string bytes;
    for (const std::uint64_t word : block.bits)
      for (int byte = 0; byte < 8; ++byte) bytes += fmt::format("{:02x}", word >> 8 * byte & 0xff);
    blocks.push_back(bytes);
  }
  for (std::size_t i = 0; i < prepared.scene.instances.size(); ++i) {
    instances.push_back(Json::array());
    add_leaves(accel, accel.instances[i].root, instances.back());
  }
  const PackedLeafCounts& counts = accel.packed->counts();
  return {{"blocks", blocks},
          {"instances", instances},
          {"triangles", counts.triangles},
          {"vertices", counts.vertices},
          {"raw_blocks", counts.raw_blocks}};
}

Json micromaps(const scene::OpacityMicromaps& maps) {
  return {{"level", maps.grid.level},
          {"mesh_of", maps.mesh_of},
          {"first_of", maps.first_of},
          {"entries", maps.entries},
          {"states", maps.states},
          {"bytes", maps.size_bytes()},
          {"triangles", {maps.transparent, maps.opaque, maps.unknown, maps.maps()}}};
}

Json facts_of(const std::string& file) {
  const app::Prepared prepared = app::prepare_config(read_config_file(file).text, file);
  Json out = Json::object();
  if (prepared.accel.packed) out["packed"] = packed(prepared);
  if (prepared.micromaps) out["micromaps"] = micromaps(*prepared.micromaps);
  return out;
}

}  // namespace

}  // namespace carousel

int main(int count, char** arguments) {
  carousel::app::start_log({}, true);  // on stderr: the facts are on stdout
  for (int i = 1; i < count; ++i) {
    try {
      std::cout << carousel::facts_of(arguments[i]).dump() << std::endl;
    } catch (const std::exception& error) {
      std::cout << carousel::Json{{"error", error.what()}}.dump() << std::endl;
    }
  }
}
