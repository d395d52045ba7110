#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "accel/structure/accel.h"
#include "ringbus/results/ray_log.h"
#include "ringbus/results/slice_log.h"

namespace carousel::ringbus {

/// A stage of a ray's life. A ray may be in several at once, as a member of several collections: its time is accounted
/// to the first of them in this order.
enum class LifeStage : std::uint8_t {
  kTest,        ///< it is tested
  kShapes,      ///< the shapes that it is to be tested with are on their way
  kDispatch,    ///< a resource looks through its packet
  kOtherTest,   ///< its packet is held by tests of other rays
  kLink,        ///< its packet is on a link
  kInput,       ///< its packet waits in an input queue
  kEgress,      ///< its packet waits for a link
  kIssueQueue,  ///< its packet waits to be issued
  kCollection,  ///< it waits in a collection
  kAdmission,   ///< it waits for room in the root's collection
  kLoad,        ///< its record is loaded, and its ID on its way
  kSlot,        ///< it waits for a slot
  kReturn,      ///< its hit is on its way to shading
  kShadeQueue,  ///< its hit waits for a shader worker
  kShading,     ///< its hit is shaded
  kOther,       ///< it waits for something else, such as other rays of its warp, or the opacity of what it hit
};
std::string_view stage_text(LifeStage stage);

/// A stretch of time that a ray spent in one stage.
struct LifeSpan {
  std::uint64_t begin = 0, end = 0;
  LifeStage stage = LifeStage::kOther;
  std::string part;                     ///< resource N or link N; empty: of shading
  std::optional<std::uint32_t> packet;  ///< that it was a member of
  std::optional<accel::NodeKey> key;    ///< the node that it waited for, or was tested with
  friend bool operator==(const LifeSpan&, const LifeSpan&) = default;
};

/// A test of the ray.
struct LifeTest {
  std::uint64_t at = 0;
  std::uint32_t resource = 0;
  std::optional<std::uint32_t> packet;  ///< absent where there are none
  accel::NodeKey key;
  std::uint16_t depth = 0;
  int shapes = 0;            ///< children of the node, or triangles of the leaf
  std::optional<int> hit;    ///< children that it hit and that packets are issued for; absent where there are none
  std::optional<Hit> found;  ///< a nearer hit than those before
};

/// The life of a ray: its spans follow one another without a gap from `begin` to `end`.
struct RayLife {
  std::uint64_t begin = 0, end = 0;  ///< when it was made, and when its hit had been shaded
  bool complete = false;             ///< false: the run ended before
  std::vector<LifeSpan> spans;
  std::vector<LifeTest> tests;
  std::uint64_t packets = 0, hops = 0;
  std::optional<std::uint32_t> resource, slot;  ///< place of its record
  Hit hit{};
};

/// Puts together the notes of a run about the ray; absent if it never was.
std::optional<RayLife> ray_life(const std::vector<RayFact>& facts, const Timeline& trips, const accel::Accel& accel);

}  // namespace carousel::ringbus
