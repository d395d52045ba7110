#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/types/vec.h"

namespace carousel {

// The configuration tree (DESIGN.md section 8, a contract): plain structs, filled once and then only read.
// Field defaults stand here; unit, range and meaning stand beside them in core/config/fields.h, from which
// parser, schema, documentation and error texts are derived.

enum class BuiltinScene { kCornell, kSpheres, kTerrain, kInstances, kSliver };
enum class EngineKind { kNative, kCycle };
enum class SimdTarget { kAuto, kScalar, kSsse3, kSse4, kAvx2, kAvx3 };
enum class TopologyShape {
  kRing,
  kBidirectional,
  kMultiRing,
  kHierarchical,
  kPointToPoint,
  kBus,
  kCentral,
  kIndependent
};
enum class CentralForm { kCells, kDistributor };
enum class Visit { kAll, kOwners };
enum class Flow { kCredits, kBubble, kNone };
enum class QueueKind { kSpscRing, kMpmcRing, kTbbBounded, kMoodycamel, kAtomicQueue, kBoostSpsc, kMutex };
enum class Placement { kBalanced, kRoundRobin, kFirstTaker, kAddressed };
enum class PacketShapes { kStrip, kSingle };
enum class PacketCarry { kReference, kData };
enum class PacketResults { kMask, kPerShape, kMessage, kImpliedOrder };
enum class Traversal { kSpread, kOrdered, kTreelet };
enum class Policy { kFullest, kOldest, kNewest, kDeepest, kNearest };
enum class Select { kStrict, kFullFirst };
enum class Home { kIssuer, kHash, kLocal };
enum class WhenFull { kReserve, kSpill };
enum class TriangleLevel { kFast, kWatertight, kDouble, kExact };
enum class BoxLevel { kPlain, kConservative, kDouble };
enum class TransformLevel { kInverseMatrix, kTwoStep, kTwoStepDouble, kTransposeIfRotation };
enum class SpawnOffset { kEpsilon, kUlp, kBound };
enum class Primary { kRays, kRaster };
enum class Verify { kNone, kReference, kEffects };

struct SkyConfig {
  Vec3 color{0.6f, 0.7f, 0.9f};  ///< linear RGB
  float strength = 1;            ///< radiance multiplier; 0 is no sky
};

struct SceneConfig {
  std::string file;                     ///< glTF file; relative to the config's folder, then to the working one
  std::optional<BuiltinScene> builtin;  ///< exactly one of file and builtin
  bool procedural = false;              ///< built-in spheres: as such, not as triangles
  std::int64_t triangles = 20000;       ///< built-in spheres, terrain, sliver: about this many in all
  std::int64_t instances = 1000;        ///< built-in instances
  std::int64_t seed = 1;                ///< built-in scenes
  std::int64_t camera = 0;              ///< index among the scene's cameras
  std::optional<SkyConfig> sky;         ///< absent: the built-in scene's own, or for a file the default above
};

struct CameraConfig {
  float aperture = 0;  ///< lens diameter
  float focus_distance = 1;
};

struct ImageConfig {
  std::int64_t width = 256, height = 256;
  std::int64_t samples = 4;
  std::int64_t max_depth = 4;  ///< surfaces a path may visit; 1 is direct light only
  std::int64_t seed = 1;
};

struct EngineConfig {
  EngineKind kind = EngineKind::kNative;
  std::optional<std::int64_t> threads;  ///< absent: `auto`, the machine's cores
  std::int64_t clock_mhz = 1000;
  SimdTarget simd = SimdTarget::kAuto;
  bool what_if = true;
};

struct LinkConfig {
  QueueKind queue = QueueKind::kSpscRing;
  std::int64_t depth = 16;
  std::int64_t latency_cycles = 4;
  std::int64_t bytes_per_cycle = 32;
};

struct TesterUnits {
  std::int64_t units = 1;
  std::int64_t interval_cycles = 1;
  std::int64_t latency_cycles = 4;
};

struct TestersConfig {
  TesterUnits box{8, 1, 4}, triangle{4, 1, 4}, plane{8, 1, 4}, bundle{1, 1, 4}, transform{1, 1, 4};
  TesterUnits procedural{1, 1, 8}, any_hit_unit{1, 1, 8};
  struct Simd {
    std::int64_t lanes = 8;
    enum class Map { kRays, kShapes } map = Map::kRays;
  } simd;
  std::int64_t contexts = 1;
  enum class AnyHit { kInline, kShader } any_hit = AnyHit::kInline;
};

/// What one resource has otherwise than the rest.
struct ResourceOverride {
  std::int64_t resource = 0;
  TestersConfig testers;
};

struct TopologyConfig {
  std::int64_t resources = 8;
  TopologyShape shape = TopologyShape::kRing;
  std::int64_t rings = 2;
  std::int64_t groups = 4;
  CentralForm form = CentralForm::kCells;
  Visit visit = Visit::kAll;
  Flow flow = Flow::kCredits;
  LinkConfig link;
  std::vector<ResourceOverride> overrides;
};

struct RaysConfig {
  std::int64_t slots_per_resource = 1024;
  Placement placement = Placement::kBalanced;
  std::int64_t reads_per_cycle = 0;
};

struct PacketsConfig {
  std::int64_t rays = 32;
  PacketShapes shapes = PacketShapes::kStrip;
  PacketCarry carry = PacketCarry::kReference;
  PacketResults results = PacketResults::kMask;
  std::int64_t ids_per_cycle = 16;
};

struct CollectionsConfig {
  std::int64_t ready = 32;
  Traversal traversal = Traversal::kSpread;
  Policy policy = Policy::kNearest;
  Select select = Select::kFullFirst;
  Home home = Home::kIssuer;
  std::int64_t capacity = 65536;
  WhenFull when_full = WhenFull::kReserve;
};

struct BvhConfig {
  std::int64_t width = 8;
  std::int64_t leaf_triangles = 4;
  std::int64_t treelet_triangles = 2048;
  enum class Elements { kBoxes, kSpheres } elements = Elements::kBoxes;
  std::int64_t mixed_triangles = 0;
};

struct AccuracyConfig {
  TriangleLevel triangle = TriangleLevel::kWatertight;
  BoxLevel box = BoxLevel::kConservative;
  TransformLevel transform = TransformLevel::kTwoStep;
  SpawnOffset spawn = SpawnOffset::kBound;
  // How the cycle engine's hardware gets there; no hit depends on these.
  enum class TransformedRay { kRecompute, kStore } transformed_ray = TransformedRay::kRecompute;
  enum class InstanceData { kForward, kRt, kInverse };
  std::optional<InstanceData> instance_data;  ///< absent: what `transform` reads
  enum class Invert { kBuild, kVisit };
  std::optional<Invert> invert;  ///< absent: as `instance_data` needs
};

struct CullPlanesConfig {
  std::int64_t count = 0;
  enum class Nodes { kLeaves, kInner, kAll } nodes = Nodes::kLeaves;
  bool shared_normals = false;
  enum class Fit { kVertices, kBoxes } fit = Fit::kVertices;
  enum class Order { kBoxFirst, kPlanesFirst } order = Order::kBoxFirst;
  enum class Levels { kBlas, kTlas, kAll } levels = Levels::kBlas;
};

struct BundlesConfig {
  std::int64_t size = 0;
  enum class Form { kInterval, kSilhouette } form = Form::kInterval;
  enum class Edges { kSerial, kParallel } edges = Edges::kSerial;
  enum class Order { kAllHitFirst, kAnyHitFirst, kParallel, kAllHitOnly, kAnyHitOnly } order = Order::kAllHitFirst;
  bool strict = false;
  enum class Lifetime { kPersistent, kReformed } lifetime = Lifetime::kPersistent;
  struct Builder {
    std::int64_t open = 16, rays_per_cycle = 2, age = 64;
    enum class Similarity { kGrowth, kSolidAngle, kComponentRange, kOriginBox } similarity = Similarity::kGrowth;
    enum class Measure { kAbsolute, kPercent } measure = Measure::kAbsolute;
    double threshold = 0.1;
    bool same_origin = false, same_signs = true;
  } builder;
  enum class Sources { kAll, kCamera, kShader } sources = Sources::kAll;
  enum class Split { kTester, kBuilder } split = Split::kTester;
  std::int64_t min_rays = 2;
  struct SplitBelow {
    std::int64_t depth = 255;
    double box_size = 0;
  } split_below;
  struct SplitAbove {
    double spread = 0, silhouette_area = 0;  ///< 0: whatever they are
  } split_above;
  enum class AtInstances { kSplit, kRebound } at_instances = AtInstances::kSplit;
  enum class Hint { kIgnore, kObey } hint = Hint::kIgnore;
};

struct MemoryConfig {
  std::int64_t l2_kib = 1024, line_bytes = 64, ways = 8, shared_by = 4;
  std::int64_t l2_latency_cycles = 30, dram_latency_cycles = 200, dram_bytes_per_cycle = 32;
  enum class Fetch { kPacket, kResource, kMulticast } fetch = Fetch::kPacket;
  std::int64_t fetch_ahead = 2, shape_buffer_kib = 4;
};

/// What the shaders' rays of one kind want (core/types/ray.h).
struct RayFlags {
  enum class Cull { kNone, kBack, kFront } cull = Cull::kNone;
  bool force_opaque = false;
};

struct ShadingConfig {
  std::int64_t workers = 2;
  struct Effects {
    enum class Choice { kAuto, kAll, kList } choice = Choice::kAuto;
    std::vector<std::string> names;  ///< for kList
  } effects;
  bool idle_resources_shade = false;
  std::int64_t cycles_per_shade = 20;
  enum class Distribute { kFifoFill, kLoad, kRoundRobin, kRandom } distribute = Distribute::kFifoFill;
  std::int64_t cycles_per_any_hit = 10, cycles_per_effect = 5;
  RayFlags camera_rays{}, bounce_rays{}, shadow_rays{};
};

struct TrafficConfig {
  enum class Pattern { kUniform, kTornado, kNeighbour, kHotspot, kBursty } pattern = Pattern::kUniform;
  double rate = 0.1;
  std::int64_t packets = 100000;
  std::int64_t packet_bytes = 32;
  std::int64_t inject_cycles = 1, eject_cycles = 1;
  double warmup_fraction = 0.1;
  std::int64_t hotspot = 0;        ///< resource, for hotspot
  double hotspot_fraction = 0.25;  ///< for hotspot
  std::int64_t burst_packets = 8;  ///< mean, for bursty
};

struct WorkloadConfig {
  enum class Kind { kRays, kRaysFrom, kTraffic } kind = Kind::kRays;
  std::string rays_from;  ///< ray CSV; relative to the config's folder, then to the working one
  TrafficConfig traffic;
};

/// What goes wrong on request, drawn from `seed`.
struct FaultsConfig {
  std::int64_t seed = 1;
  struct Links {
    double drop = 0, duplicate = 0, corrupt = 0, reorder = 0, delay = 0;  ///< fractions of the frames on a link
    std::int64_t delay_cycles = 100;
    bool any() const { return drop > 0 || duplicate > 0 || corrupt > 0 || reorder > 0 || delay > 0; }
  } links;
  struct Resource {
    enum class Kind { kNone, kPause, kSlow, kStop } kind = Kind::kNone;
    std::int64_t number = 0;
    std::int64_t after_rays = 0;           ///< completed there
    std::int64_t cycles = 100'000;         ///< of a pause
    std::int64_t factor = 4;               ///< kSlow
    bool recover = true;                   ///< kStop
    std::int64_t silence_cycles = 10'000;  ///< kStop, under virtual time
  } resource;
  bool compare = false;  ///< virtual time: simulate once more without faults
  bool any() const { return links.any() || resource.kind != Resource::Kind::kNone; }
};

struct Config {
  std::int64_t schema_version = 1;
  SceneConfig scene;
  CameraConfig camera;
  ImageConfig image;
  EngineConfig engine;
  TopologyConfig topology;
  RaysConfig rays;
  PacketsConfig packets;
  CollectionsConfig collections;
  BvhConfig bvh;
  AccuracyConfig accuracy;
  CullPlanesConfig cull_planes;
  BundlesConfig bundles;
  TestersConfig testers;
  MemoryConfig memory;
  ShadingConfig shading;
  FaultsConfig faults;
  Verify verify = Verify::kNone;
  WorkloadConfig workload;
  std::map<std::string, std::vector<std::string>> vary;  ///< key path to values; for sweep
  Primary primary = Primary::kRays;
};

}  // namespace carousel
