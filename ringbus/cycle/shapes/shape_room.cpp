#include "ringbus/cycle/shapes/shape_room.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "ringbus/cycle/shapes/shape_blocks.h"
#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/shapes/shape_memory.h"

namespace carousel::ringbus::cycle {

std::int64_t least_shape_buffer_kib(const accel::Accel& accel, const AccuracyConfig& accuracy, const BvhConfig& bvh,
                                    const MemoryConfig& config, const CollectionsConfig& collections) {
  const ShapeMemory memory(accel, accuracy, bvh, config);
  std::optional<ShapeBlocks> blocks;
  if (collections.key == CollectionKey::kBlock)
    blocks.emplace(accel, memory, static_cast<std::uint64_t>(collections.block_bytes));
  std::uint64_t strip = 0, transform = 0;
  const auto consider = [&](accel::NodeRef ref) {
    if (ref.is_instance() || (accel.pieces && !accel.pieces->holds(ref))) return;
    const ShapeSpan span = blocks                  ? blocks->span(ref)
                           : memory.has_treelets() ? memory.treelet(ref)
                                                   : memory.strip({kNoInstance, ref});
    std::uint64_t places = ShapeBuffer::places_to_ask(span);
    for (const ShapeSpan& record : memory.gaussians({kNoInstance, ref})) places += ShapeBuffer::places(record);
    strip = std::max(strip, places);
  };
  for (std::uint32_t i = 0; i < accel.nodes.size(); ++i) {
    consider(accel::NodeRef::inner(i));
    for (int lane = 0; lane < accel.nodes[i].count; ++lane) consider(accel.nodes[i].child[lane]);
  }
  for (std::uint32_t i = 0; i < accel.instances.size(); ++i) {
    consider(accel.instances[i].root);
    transform = std::max(transform, ShapeBuffer::places(memory.transform(i)));
  }
  return static_cast<std::int64_t>(ceil_div((strip + transform) * ShapeBuffer::kPlaceBytes, 1024));
}

std::vector<ConfigIssue> check_shape_buffer(const Config& config, const accel::Accel& accel) {
  if (config.engine.kind != EngineKind::kCycle) return {};
  const std::int64_t least =
      least_shape_buffer_kib(accel, config.accuracy, config.bvh, config.memory, config.collections);
  std::vector<ConfigIssue> issues;
  const auto check = [&](std::string key, std::int64_t kib) {
    if (kib >= least) return;
    ConfigIssue& issue = issues.emplace_back();
    issue.key_path = std::move(key);
    issue.message = fmt::format(
        "a test needs a whole {} and its transform at once, and this scene's largest do not fit; expected at least "
        "{}, found {}",
        config.collections.key == CollectionKey::kBlock ? "block of memory"
        : accel.pieces                                  ? "treelet"
                                                        : "strip",
        least, kib);
  };
  check("memory.shape_buffer_kib", config.memory.shape_buffer_kib);
  for_each_own(config.topology, [&](const OwnOf& one) {
    if (const auto own = one.keys->shape_buffer_kib) check(own_place(one) + ".shape_buffer_kib", *own);
  });
  return issues;
}

}  // namespace carousel::ringbus::cycle
