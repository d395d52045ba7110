// Runs machines on the cycle engine and prints, for each configuration, a line of JSON for tests/validation/machine:
// the facts that its model cannot know (the tree, the boxes and triangles that each ray meets, the rays that shading a
// ray causes) and the engine's cycles, with which the model's are compared. Nothing of the engine's order or time gets
// into the facts: each ray is tested by itself, and a ray is named by its path, not by the state that its path has.
//
//   machine_facts CONFIG...        a configuration that is refused gives {"error": TEXT}
#include <cmath>
#include <iostream>
#include <map>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <vector>

#include <nlohmann/json.hpp>

#include "accel/box/double_slab.h"
#include "accel/box/slab.h"
#include "accel/traverse/kernels.h"
#include "accel/traverse/ray_check.h"
#include "app/host/log.h"
#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "core/config/write.h"
#include "core/program/built_in_shaders.h"
#include "core/system/error.h"
#include "core/types/wrapped_workload.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/shapes/shape_blocks.h"
#include "ringbus/cycle/shapes/shape_memory.h"

namespace carousel {

namespace {

using Json = nlohmann::json;

Json json(const std::vector<DataRead>& reads) {
  Json out = Json::array();
  for (const DataRead& read : reads) out.push_back({read.offset, read.bytes});
  return out;
}

Json number(float value) {
  return std::isfinite(value) ? Json(value) : Json();
}

/// The tree as the model sees it: every node at its place in the world, with its children by number.
class Tree {
 public:
  Tree(const accel::Accel& accel, const Config& config)
      : accel_(accel), memory_(accel, config.accuracy, config.bvh, config.memory) {
    if (config.collections.key == CollectionKey::kBlock)
      blocks_.emplace(accel, memory_, static_cast<std::uint64_t>(config.collections.block_bytes));
    add(accel.root_key());
  }

  const accel::Accel& accel() const { return accel_; }
  std::size_t number_of(accel::NodeKey key) const { return numbers_.at(key.bits()); }
  Json json() const { return nodes_; }

 private:
  std::size_t add(accel::NodeKey key) {
    const std::size_t number = nodes_.size();
    numbers_[key.bits()] = number;
    const auto strip = memory_.strip(key), transform = memory_.transform(key.instance);
    nodes_.push_back({{"key", key.bits()},
                      {"inner", key.ref.is_inner()},
                      {"procedural", key.ref.is_procedural()},
                      {"shapes", accel_.strip_size(key)},
                      {"triangles_below", accel_.triangles_below(key)},
                      {"strip", {strip.address, strip.bytes}},
                      {"longest", strip.most > 0 ? Json{strip.most} : Json::array()},
                      {"transform", {transform.address, transform.bytes}},
                      {"moves", transform.bytes > 0},
                      {"transposed", transform.bytes > 0 && accel_.instances[key.instance].transform.transposed},
                      {"promoted", transform.bytes > 0 && accel_.instances[key.instance].transform.promoted}});
    if (blocks_) {
      const auto span = blocks_->span(key.ref);
      nodes_[number]["block"] = {span.address, span.bytes, blocks_->name(key).bits()};
    }
    if (memory_.has_treelets()) {
      const auto span = memory_.treelet(key.ref);
      nodes_[number]["treelet"] = {span.address, span.bytes, accel_.pieces->piece(key.ref).exits};
    }
    Json children = Json::array();
    if (key.ref.is_inner())
      for (int lane = 0; lane < accel_.nodes[key.ref.node()].count; ++lane)
        children.push_back(add(accel_.child_key(key, lane)));
    nodes_[number]["children"] = children;
    return number;
  }

  const accel::Accel& accel_;
  ringbus::cycle::ShapeMemory memory_;
  std::optional<ringbus::cycle::ShapeBlocks> blocks_;
  Json nodes_ = Json::array();
  std::unordered_map<std::uint64_t, std::size_t> numbers_;
};

/// Passes a workload on to the engine, ray by ray, and keeps what became of each.
class RecordedWorkload final : public WrappedWorkload {
 public:
  using Name = std::tuple<std::uint64_t, std::uint32_t, std::uint32_t, std::uint32_t>;  // path, bounce, kind, index

  RecordedWorkload(Workload& inner, const Tree& tree) : WrappedWorkload(inner), tree_(tree) {}

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    const std::size_t before = out.size();
    const Generated made = inner_.generate(worker, max_rays, out);
    for (std::size_t i = before; i < out.size(); ++i) {
      path_of_state_[out[i].tag.path] = camera_.size();
      camera_.push_back(name(out[i].tag));
      const PathMemory memory = inner_.path_memory(out[i].tag);
      pixels_.push_back(memory.pixel.value());
      state_bytes_ = memory.state_bytes;
      meet(out[i]);
    }
    return made;
  }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    std::vector<Name>& batch = shaded_.emplace_back();
    for (const RayResult& result : completed) {
      const Name own = name(result.tag);
      batch.push_back(own);
      Json& ray = rays_.at(own);
      const ShadeWork work = inner_.extra_work(result);
      ray["lookups"] = work.lookups;
      ray["products"] = work.products;
      ray["shader"] = inner_.shader(result);
      std::vector<SkyRead> reads;
      inner_.sky_reads(result, reads);
      ray["sky"] = Json::array();
      for (const SkyRead& read : reads) ray["sky"].push_back({read.offset, read.bytes});
      const ShadeFacts seen = inner_.shade_facts(result);
      ray["facts"] = seen.value;
      ray["reads"] = reads_of(seen);
      ray["children"] = Json::array();
      const std::size_t before = out.size();
      inner_.shade(worker, {result}, out);
      for (std::size_t i = before; i < out.size(); ++i) {
        meet(out[i]);
        rays_.at(own)["children"].push_back(name(out[i].tag));
      }
    }
  }

  std::map<Name, Json>& rays() { return rays_; }
  const std::vector<Name>& camera() const { return camera_; }
  /// By path.
  const std::vector<std::uint32_t>& pixels() const { return pixels_; }
  std::uint32_t state_bytes() const { return state_bytes_; }  ///< bytes in the state of a path
  /// The calls of shade(), in order.
  const std::vector<std::vector<Name>>& shaded() const { return shaded_; }

 private:
  Name name(const RayTag& tag) const {
    return {path_of_state_.at(tag.path), tag.bounce, static_cast<std::uint32_t>(tag.kind), tag.index};
  }
  /// Notes all boxes and triangles that the ray would meet if no hit shortened it.
  void meet(const RayRequest& request) {
    RayRecord fresh;
    accel::start_record(request, fresh);
    Json ray{{"shadow", request.tag.kind == RayKind::kShadow},
             {"range", number(fresh.hit.t)},
             {"boxes", Json::object()},
             {"triangles", Json::object()},
             {"candidates", Json::object()},
             {"calls", Json::object()}};
    meet(tree_.accel().root_key(), fresh, ray);
    rays_.emplace(name(request.tag), std::move(ray));
  }
  void meet(accel::NodeKey key, const RayRecord& fresh, Json& ray) {
    const std::string number = std::to_string(tree_.number_of(key));
    IntersectionCounts ignored;
    if (!key.ref.is_inner()) {
      Json distances = Json::array(), candidates = Json::array(), calls = Json::array();
      for (std::uint32_t i = 0; i < key.ref.triangles(); ++i) {
        RayRecord record = fresh;
        std::vector<AnyHitCall> made;
        accel::test_strip(tree_.accel(), key, 1u << i, {&record, nullptr, 1, nullptr, &made}, {}, ignored);
        distances.push_back(record.hit.valid() ? Json(record.hit.t) : Json());
        calls.push_back(made.empty() ? Json() : call(fresh, made[0].place));
        candidates.push_back(candidate(key, i, fresh));
      }
      ray["triangles"][number] = distances;
      ray["candidates"][number] = candidates;
      ray["calls"][number] = calls;
      return;
    }
    RayRecord record = fresh;
    std::uint8_t mask = 0;
    float nearest[accel::kMaxWidth], entry[accel::kMaxWidth];
    std::fill(std::begin(nearest), std::end(nearest), kInfinity);
    accel::test_strip(tree_.accel(), key, ~0u, {&record, nullptr, 1}, {&mask, nearest, entry}, ignored);
    Json entries = Json::array();
    for (int lane = 0; lane < tree_.accel().nodes[key.ref.node()].count; ++lane) {
      entries.push_back(mask >> lane & 1 ? Json(entry[lane]) : Json());
      if (mask >> lane & 1) meet(tree_.accel().child_key(key, lane), fresh, ray);
    }
    ray["boxes"][number] = entries;
  }

  /// An any-hit call, as its program finds it.
  Json call(const RayRecord& fresh, const Hit& place) const {
    const ShadeFacts seen = inner_.any_hit_facts({fresh.ray, place, fresh.tag});
    Json out{{"t", place.t}, {"facts", seen.value}, {"reads", reads_of(seen)}};
    return out;
  }
  static Json reads_of(const ShadeFacts& seen) {
    Json out{{"material", json(seen.material)}, {"vertices", json(seen.vertices)}, {"lookups", Json::array()}};
    for (const std::vector<DataRead>& lookup : seen.lookups) out["lookups"].push_back(json(lookup));
    return out;
  }

  /// The entry into the box of a triangle that the ray meets in 32 bits, up to which its closest hit lets the distance
  /// be computed in 64; nothing if it is not met.
  Json candidate(accel::NodeKey key, std::uint32_t triangle, const RayRecord& fresh) const {
    RayRecord record = fresh;
    IntersectionCounts counts;
    const accel::Accel& accel = tree_.accel();
    accel::test_strip(accel, key, 1u << triangle, {&record, nullptr, 1}, {}, counts);
    if (counts.refined == 0) return {};
    const accel::TriangleBlock& block = accel.blocks[key.ref.first_block() + triangle / accel::kBlockTriangles];
    Aabb box;
    for (const auto& vertex : block.vertex) {
      const std::uint32_t lane = triangle % accel::kBlockTriangles;
      box.extend({vertex[0][lane], vertex[1][lane], vertex[2][lane]});
    }
    const accel::InstanceTransform transform =
        key.instance == kNoInstance ? accel::InstanceTransform{} : accel.instances[key.instance].transform;
    const Ray model = transform.to_model(fresh.ray);
    float entry;
    if (accel.accuracy.box == BoxLevel::kDouble)
      accel::slab(accel::DoubleSlabRay(model), box, fresh.hit.t, entry);
    else
      accel::slab(accel::SlabRay(model, accel::far_widening(accel.accuracy.box)), box, fresh.hit.t, entry);
    return entry;
  }

  const Tree& tree_;
  std::unordered_map<std::uint32_t, std::uint64_t> path_of_state_;
  std::map<Name, Json> rays_;
  std::vector<Name> camera_;
  std::vector<std::uint32_t> pixels_;
  std::uint32_t state_bytes_ = 0;
  std::vector<std::vector<Name>> shaded_;
};

const char* name_of(ringbus::cycle::StepKind kind) {
  using enum ringbus::cycle::StepKind;
  switch (kind) {
    case kNewRays:
      return "new_rays";
    case kIssue:
      return "issue";
    case kTake:
      return "take";
    case kTested:
      return "tested";
    case kTestedRay:
      return "tested_ray";
    case kRetire:
      return "retire";
    case kComplete:
      return "complete";
    case kShade:
      return "shade";
    case kPlace:
      return "place";
  }
  return "";
}

Json run(const std::string& file) {
  app::Prepared prepared = app::prepare_config(read_config_file(file).text, file);
  const Config& config = prepared.config();
  const app::RenderJob job(prepared);
  const Tree tree(prepared.accel, config);
  RecordedWorkload workload(job.workload(), tree);
  ringbus::RunOptions options;
  options.trace = {0, ringbus::kNever};
  const ringbus::RunResult result =
      ringbus::run_cycle(config, prepared.accel, prepared.scene_size(), workload, options);
  Json steps = Json::array();
  std::size_t batch = 0;
  for (const ringbus::cycle::Step& step : result.cycle->steps) {
    steps.push_back({step.at, step.node, name_of(step.kind), step.packet, step.rays});
    if (step.kind != ringbus::cycle::StepKind::kShade) continue;
    for (const RecordedWorkload::Name& name : workload.shaded()[batch]) workload.rays().at(name)["shaded"] = step.at;
    ++batch;
  }
  Json rays = Json::array();
  for (auto& [name, ray] : workload.rays()) {
    ray["name"] = name;
    rays.push_back(std::move(ray));
  }
  Json built_in = Json::array();
  for (std::size_t kind = 0; kind < kShaderKinds; ++kind) built_in.push_back(built_in_shader(kind));
  return {{"config", Json(config_json(config))},   {"built_in", std::move(built_in)},
          {"scene_size", prepared.scene_size()},   {"width", prepared.accel.width},
          {"max_depth", prepared.accel.max_depth}, {"ways", prepared.accel.most_ways()},
          {"levels", prepared.accel.levels()},     {"nodes", tree.json()},
          {"camera", workload.camera()},           {"pixels", workload.pixels()},
          {"state_bytes", workload.state_bytes()}, {"rays", std::move(rays)},
          {"cycles", result.cycle->cycles},        {"steps", std::move(steps)}};
}

}  // namespace

}  // namespace carousel

int main(int count, char** arguments) {
  carousel::app::start_log({}, true);  // on stderr: the facts are on stdout
  for (int i = 1; i < count; ++i) {
    try {
      std::cout << carousel::run(arguments[i]).dump() << std::endl;
    } catch (const std::exception& error) {
      std::cout << carousel::Json{{"error", error.what()}}.dump() << std::endl;
    }
  }
}
