#include "bench/rays/options.h"

#include <CLI/CLI.hpp>

#include "core/config/config.h"
#include "core/types/enum_names.h"

namespace carousel::bench {

std::map<std::string, std::string> Options::describe() const {
  return {{"rays.slots_per_resource", std::to_string(ring.slots)},
          {"packets.rays", std::to_string(ring.packet_rays)},
          {"collections.ready", std::to_string(ring.ready)},
          {"collections.capacity", std::to_string(ring.capacity)},
          {"collections.policy", std::string(enum_name(ring.policy))},
          {"collections.select", std::string(enum_name(ring.select))},
          {"bvh.treelet_triangles", std::to_string(ring.treelet_triangles)},
          {"engine.lanes", std::string(enum_name(ring.lanes))},
          {"rays.sort", std::string(enum_name(ring.sort))},
          {"bvh.leaf_triangles", std::to_string(bvh.leaf_triangles)},
          {"bvh.merge", std::string(enum_name(bvh.merge))},
          {"bvh.quality", std::string(enum_name(bvh.quality))},
          {"bvh.width", std::to_string(bvh.width)},
          {"topology.link.depth", std::to_string(ring.link_depth)},
          {"topology.link.queue", std::string(enum_name(ring.queue))},
          {"image", std::to_string(image_side) + " x " + std::to_string(image_side)},
          {"Embree frequency_level", field.frequency_level},
          {"Embree build quality", field.quality == EmbreeQuality::kHigh ? "high" : "medium"}};
}

namespace {

// A smoke test, small enough for every push: one scene of each kind, few rays, one repetition.
void make_quick(Options& o) {
  o.builtins = {"terrain", "spheres"};
  o.sizes = {10'000};
  o.image_side = 128;
  o.repetitions = 1;
  o.field.all_forms = true;
}

template <class E>
void add_enum(CLI::App& app, const std::string& flag, E& value, const std::string& meaning) {
  std::map<std::string, E> names;
  for (const EnumName<E>& one : kEnumNames<E>) names.emplace(one.name, one.value);
  app.add_option(flag, value, meaning)->transform(CLI::CheckedTransformer(names));
}

}  // namespace

std::optional<Options> parse_options(int argc, char** argv, int& exit_status) {
  Options o;
  bool medium = false, no_build = false;
  CLI::App app("Ray throughput of the ring, the depth-first tracer and Embree, in one run", "bench_rays");
  app.add_flag("--quick", o.quick, "a smoke test: small scenes, few rays, one repetition, all contestants");
  app.add_option("--builtin", o.builtins, "built-in scenes: terrain, spheres, sliver")->delimiter(',');
  app.add_option("--triangles", o.sizes, "triangles of each")->delimiter(',')->check(CLI::Range(1, 1 << 28));
  app.add_option("--scene", o.files, "glTF files to measure; besides built-in scenes if those are named too")
      ->check(CLI::ExistingFile);
  app.add_option("--sets", o.sets, "ray sets: primary, shadow, bounce, shuffled, shuffled-any")
      ->delimiter(',')
      ->check(CLI::IsMember({"primary", "shadow", "bounce", "shuffled", "shuffled-any"}));
  app.add_option("--image", o.image_side, "side of the primary rays' image")->check(CLI::Range(1, 8192));
  app.add_option("--seed", o.seed, "of the bounce directions");
  app.add_option("--threads", o.threads, "thread counts")->delimiter(',')->check(CLI::Range(1, 1024));
  app.add_option("--repetitions", o.repetitions, "interleaved rounds")->check(CLI::Range(1, 1000));
  app.add_flag("--all", o.field.all_forms, "every traversal, eight owners, statistics, Embree 16-wide");
  app.add_option("--vary", o.field.variations, "both treelet rings again with a change, e.g. treelet=512;ready=128");
  app.add_option("--only", o.field.only, "only contestants whose name holds this text");
  app.add_flag("--no-build", no_build, "leave out the build times");
  app.add_flag("--embree-medium", medium, "Embree's medium build quality instead of high");
  app.add_option("--embree-frequency-level", o.field.frequency_level, "simd128, simd256 or simd512");
  app.add_option("--slots", o.ring.slots, "rays.slots_per_resource");
  app.add_option("--packet-rays", o.ring.packet_rays, "packets.rays");
  app.add_option("--ready", o.ring.ready, "collections.ready");
  app.add_option("--capacity", o.ring.capacity, "collections.capacity");
  app.add_option("--treelet", o.ring.treelet_triangles, "bvh.treelet_triangles");
  app.add_option("--link-depth", o.ring.link_depth, "topology.link.depth");
  app.add_option("--leaf", o.bvh.leaf_triangles, "bvh.leaf_triangles");
  app.add_option("--width", o.bvh.width, "bvh.width");
  add_enum(app, "--merge", o.bvh.merge, "bvh.merge");
  add_enum(app, "--quality", o.bvh.quality, "bvh.quality");
  add_enum(app, "--policy", o.ring.policy, "collections.policy");
  add_enum(app, "--select", o.ring.select, "collections.select");
  add_enum(app, "--lanes", o.ring.lanes, "engine.lanes");
  add_enum(app, "--sort", o.ring.sort, "rays.sort");
  add_enum(app, "--queue", o.ring.queue, "topology.link.queue");
  app.add_option("--json", o.json, "write the results here");
  app.add_option("--markdown", o.markdown, "write the tables between the markers of these documents");
  app.add_option("--from", o.from, "draw these results; nothing is measured")->check(CLI::ExistingFile);
  app.add_option("--micro", o.micro, "with --from: bench_kernels' JSON, drawn too")->check(CLI::ExistingFile);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    exit_status = app.exit(error) == 0 ? 0 : 2;
    return std::nullopt;
  }
  if (medium) o.field.quality = EmbreeQuality::kMedium;
  if (!o.files.empty() && app.count("--builtin") == 0) o.builtins.clear();
  o.build = !no_build;
  if (o.quick) make_quick(o);
  return o;
}

}  // namespace carousel::bench
