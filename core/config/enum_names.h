#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/config/config.h"

namespace carousel {

template <class E>
struct EnumName {
  E value;
  std::string_view name;
};

/// The one table of each enum's spellings, in the order in which texts list them.
template <class E>
inline constexpr std::array<EnumName<E>, 0> kEnumNames{};

#define CAROUSEL_ENUM(E, ...) \
  template <>                 \
  inline constexpr auto kEnumNames<E> = std::to_array<EnumName<E>>({__VA_ARGS__})

CAROUSEL_ENUM(BuiltinScene, {BuiltinScene::kCornell, "cornell"}, {BuiltinScene::kSpheres, "spheres"},
              {BuiltinScene::kTerrain, "terrain"}, {BuiltinScene::kInstances, "instances"},
              {BuiltinScene::kSliver, "sliver"});
CAROUSEL_ENUM(EngineKind, {EngineKind::kNative, "native"}, {EngineKind::kCycle, "cycle"});
CAROUSEL_ENUM(SimdTarget, {SimdTarget::kAuto, "auto"}, {SimdTarget::kScalar, "scalar"}, {SimdTarget::kSsse3, "ssse3"},
              {SimdTarget::kSse4, "sse4"}, {SimdTarget::kAvx2, "avx2"}, {SimdTarget::kAvx3, "avx3"});
CAROUSEL_ENUM(TopologyShape, {TopologyShape::kRing, "ring"}, {TopologyShape::kBidirectional, "bidirectional"},
              {TopologyShape::kMultiRing, "multi_ring"}, {TopologyShape::kHierarchical, "hierarchical"},
              {TopologyShape::kPointToPoint, "point_to_point"}, {TopologyShape::kBus, "bus"},
              {TopologyShape::kCentral, "central"}, {TopologyShape::kIndependent, "independent"});
CAROUSEL_ENUM(CentralForm, {CentralForm::kCells, "cells"}, {CentralForm::kDistributor, "distributor"});
CAROUSEL_ENUM(Visit, {Visit::kAll, "all"}, {Visit::kOwners, "owners"});
CAROUSEL_ENUM(Flow, {Flow::kCredits, "credits"}, {Flow::kBubble, "bubble"}, {Flow::kNone, "none"});
CAROUSEL_ENUM(QueueKind, {QueueKind::kSpscRing, "spsc_ring"}, {QueueKind::kMpmcRing, "mpmc_ring"},
              {QueueKind::kTbbBounded, "tbb_bounded"}, {QueueKind::kMoodycamel, "moodycamel"},
              {QueueKind::kAtomicQueue, "atomic_queue"}, {QueueKind::kBoostSpsc, "boost_spsc"},
              {QueueKind::kMutex, "mutex"});
CAROUSEL_ENUM(Placement, {Placement::kBalanced, "balanced"}, {Placement::kRoundRobin, "round_robin"},
              {Placement::kFirstTaker, "first_taker"}, {Placement::kAddressed, "addressed"});
CAROUSEL_ENUM(PacketShapes, {PacketShapes::kStrip, "strip"}, {PacketShapes::kSingle, "single"});
CAROUSEL_ENUM(PacketCarry, {PacketCarry::kReference, "reference"}, {PacketCarry::kData, "data"});
CAROUSEL_ENUM(PacketResults, {PacketResults::kMask, "mask"}, {PacketResults::kPerShape, "per_shape"},
              {PacketResults::kMessage, "message"}, {PacketResults::kImpliedOrder, "implied_order"});
CAROUSEL_ENUM(Traversal, {Traversal::kSpread, "spread"}, {Traversal::kOrdered, "ordered"},
              {Traversal::kTreelet, "treelet"});
CAROUSEL_ENUM(Policy, {Policy::kFullest, "fullest"}, {Policy::kOldest, "oldest"}, {Policy::kNewest, "newest"},
              {Policy::kDeepest, "deepest"}, {Policy::kNearest, "nearest"});
CAROUSEL_ENUM(Select, {Select::kStrict, "strict"}, {Select::kFullFirst, "full_first"});
CAROUSEL_ENUM(Home, {Home::kIssuer, "issuer"}, {Home::kHash, "hash"}, {Home::kLocal, "local"});
CAROUSEL_ENUM(WhenFull, {WhenFull::kReserve, "reserve"}, {WhenFull::kSpill, "spill"});
CAROUSEL_ENUM(TriangleLevel, {TriangleLevel::kFast, "fast"}, {TriangleLevel::kWatertight, "watertight"},
              {TriangleLevel::kDouble, "double"}, {TriangleLevel::kExact, "exact"});
CAROUSEL_ENUM(BoxLevel, {BoxLevel::kPlain, "plain"}, {BoxLevel::kConservative, "conservative"},
              {BoxLevel::kDouble, "double"});
CAROUSEL_ENUM(TransformLevel, {TransformLevel::kInverseMatrix, "inverse_matrix"},
              {TransformLevel::kTwoStep, "two_step"}, {TransformLevel::kTwoStepDouble, "two_step_double"},
              {TransformLevel::kTransposeIfRotation, "transpose_if_rotation"});
CAROUSEL_ENUM(AccuracyConfig::TransformedRay, {AccuracyConfig::TransformedRay::kRecompute, "recompute"},
              {AccuracyConfig::TransformedRay::kStore, "store"});
CAROUSEL_ENUM(AccuracyConfig::InstanceData, {AccuracyConfig::InstanceData::kForward, "forward"},
              {AccuracyConfig::InstanceData::kRt, "rt"}, {AccuracyConfig::InstanceData::kInverse, "inverse"});
CAROUSEL_ENUM(AccuracyConfig::Invert, {AccuracyConfig::Invert::kBuild, "build"},
              {AccuracyConfig::Invert::kVisit, "visit"});
CAROUSEL_ENUM(SpawnOffset, {SpawnOffset::kEpsilon, "epsilon"}, {SpawnOffset::kUlp, "ulp"},
              {SpawnOffset::kBound, "bound"});
CAROUSEL_ENUM(CullPlanesConfig::Nodes, {CullPlanesConfig::Nodes::kLeaves, "leaves"},
              {CullPlanesConfig::Nodes::kInner, "inner"}, {CullPlanesConfig::Nodes::kAll, "all"});
CAROUSEL_ENUM(CullPlanesConfig::Fit, {CullPlanesConfig::Fit::kVertices, "vertices"},
              {CullPlanesConfig::Fit::kBoxes, "boxes"});
CAROUSEL_ENUM(CullPlanesConfig::Order, {CullPlanesConfig::Order::kBoxFirst, "box_first"},
              {CullPlanesConfig::Order::kPlanesFirst, "planes_first"});
CAROUSEL_ENUM(CullPlanesConfig::Levels, {CullPlanesConfig::Levels::kBlas, "blas"},
              {CullPlanesConfig::Levels::kTlas, "tlas"}, {CullPlanesConfig::Levels::kAll, "all"});
CAROUSEL_ENUM(BundlesConfig::Form, {BundlesConfig::Form::kInterval, "interval"},
              {BundlesConfig::Form::kSilhouette, "silhouette"});
CAROUSEL_ENUM(BundlesConfig::Edges, {BundlesConfig::Edges::kSerial, "serial"},
              {BundlesConfig::Edges::kParallel, "parallel"});
CAROUSEL_ENUM(BundlesConfig::Builder::Similarity, {BundlesConfig::Builder::Similarity::kGrowth, "growth"},
              {BundlesConfig::Builder::Similarity::kSolidAngle, "solid_angle"},
              {BundlesConfig::Builder::Similarity::kComponentRange, "component_range"},
              {BundlesConfig::Builder::Similarity::kOriginBox, "origin_box"});
CAROUSEL_ENUM(BundlesConfig::Builder::Measure, {BundlesConfig::Builder::Measure::kAbsolute, "absolute"},
              {BundlesConfig::Builder::Measure::kPercent, "percent"});
CAROUSEL_ENUM(BundlesConfig::Sources, {BundlesConfig::Sources::kAll, "all"},
              {BundlesConfig::Sources::kCamera, "camera"}, {BundlesConfig::Sources::kShader, "shader"});
CAROUSEL_ENUM(BundlesConfig::Split, {BundlesConfig::Split::kTester, "tester"},
              {BundlesConfig::Split::kBuilder, "builder"});
CAROUSEL_ENUM(BundlesConfig::Order, {BundlesConfig::Order::kAllHitFirst, "all_hit_first"},
              {BundlesConfig::Order::kAnyHitFirst, "any_hit_first"}, {BundlesConfig::Order::kParallel, "parallel"},
              {BundlesConfig::Order::kAllHitOnly, "all_hit_only"}, {BundlesConfig::Order::kAnyHitOnly, "any_hit_only"});
CAROUSEL_ENUM(BundlesConfig::Lifetime, {BundlesConfig::Lifetime::kPersistent, "persistent"},
              {BundlesConfig::Lifetime::kReformed, "reformed"});
CAROUSEL_ENUM(TestersConfig::Simd::Map, {TestersConfig::Simd::Map::kRays, "rays"},
              {TestersConfig::Simd::Map::kShapes, "shapes"});
CAROUSEL_ENUM(BvhConfig::Elements, {BvhConfig::Elements::kBoxes, "boxes"}, {BvhConfig::Elements::kSpheres, "spheres"});
CAROUSEL_ENUM(BundlesConfig::AtInstances, {BundlesConfig::AtInstances::kSplit, "split"},
              {BundlesConfig::AtInstances::kRebound, "rebound"});
CAROUSEL_ENUM(BundlesConfig::Hint, {BundlesConfig::Hint::kIgnore, "ignore"}, {BundlesConfig::Hint::kObey, "obey"});
CAROUSEL_ENUM(RayFlags::Cull, {RayFlags::Cull::kNone, "none"}, {RayFlags::Cull::kBack, "back"},
              {RayFlags::Cull::kFront, "front"});
CAROUSEL_ENUM(TestersConfig::AnyHit, {TestersConfig::AnyHit::kInline, "inline"},
              {TestersConfig::AnyHit::kShader, "shader"});
CAROUSEL_ENUM(MemoryConfig::Fetch, {MemoryConfig::Fetch::kPacket, "packet"},
              {MemoryConfig::Fetch::kResource, "resource"}, {MemoryConfig::Fetch::kMulticast, "multicast"});
CAROUSEL_ENUM(ShadingConfig::Distribute, {ShadingConfig::Distribute::kFifoFill, "fifo_fill"},
              {ShadingConfig::Distribute::kLoad, "load"}, {ShadingConfig::Distribute::kRoundRobin, "round_robin"},
              {ShadingConfig::Distribute::kRandom, "random"});
CAROUSEL_ENUM(TrafficConfig::Pattern, {TrafficConfig::Pattern::kUniform, "uniform"},
              {TrafficConfig::Pattern::kTornado, "tornado"}, {TrafficConfig::Pattern::kNeighbour, "neighbour"},
              {TrafficConfig::Pattern::kHotspot, "hotspot"}, {TrafficConfig::Pattern::kBursty, "bursty"});
CAROUSEL_ENUM(Primary, {Primary::kRays, "rays"}, {Primary::kRaster, "raster"});
CAROUSEL_ENUM(FaultsConfig::Resource::Kind, {FaultsConfig::Resource::Kind::kNone, "none"},
              {FaultsConfig::Resource::Kind::kPause, "pause"}, {FaultsConfig::Resource::Kind::kSlow, "slow"},
              {FaultsConfig::Resource::Kind::kStop, "stop"});
CAROUSEL_ENUM(Verify, {Verify::kNone, "none"}, {Verify::kReference, "reference"}, {Verify::kEffects, "effects"});

#undef CAROUSEL_ENUM

/// The spelling of `value`; empty for a value outside the table.
template <class E>
constexpr std::string_view enum_name(E value) {
  for (const auto& entry : kEnumNames<E>)
    if (entry.value == value) return entry.name;
  return {};
}

template <class E>
constexpr std::optional<E> enum_value(std::string_view name) {
  for (const auto& entry : kEnumNames<E>)
    if (entry.name == name) return entry.value;
  return std::nullopt;
}

}  // namespace carousel
