"""The small runs whose reports give the examples of docs/reference/report, by name: settings as `key=YAML`, and then the
options of `carousel run`. The first run that has a number gives its example, so a new number needs a run only if no run
here has it. Files are those of example_files.py. Pictures are 16 by 12 pixels of one sample where nothing else is said."""

SIZE = ["image.width=16", "image.height=12", "image.samples=1"]
TERRAIN = ["scene.builtin=terrain", "scene.triangles=400", "engine.kind=cycle"] + SIZE
CORNELL = ["scene.builtin=cornell", "engine.kind=cycle"] + SIZE
INSTANCES = ["scene.builtin=instances", "scene.instances=20", "engine.kind=cycle"] + SIZE
GAUSSIANS = ["scene.builtin=gaussians", "scene.gaussians.count=200", "engine.kind=cycle"] + SIZE
ENERGY = ["energy.profile=n45"]
TRAFFIC = ["engine.kind=cycle", "workload.traffic.rate=0.2", "workload.traffic.packets=1000"]
FOUR = ["topology.shape=graph", "topology.nodes=[{name: r, count: 4}]"]
PLACED = "{name: r, count: 4, at: [0, 0], step: [2, 2], columns: 2}"
LANES = ["testers.simd.lanes=8"]

RUNS = {
    "ring": (["scene.builtin=terrain", "scene.triangles=2000", "engine.kind=cycle", "image.width=64", "image.height=48",
              "image.samples=1", "rays.slots_per_resource=32", "topology.resources=4", "memory.l1_kib=4",
              "memory.dram.preset=gddr6_14", "verify=reference"] + ENERGY, ["--heat", "linear"]),
    "larger-frame": (["scene.builtin=terrain", "scene.triangles=2000", "engine.kind=cycle", "image.width=96", "image.height=64",
                      "image.samples=1", "image.max_depth=2", "rays.slots_per_resource=32", "topology.resources=4"], []),
    "few-rays": (CORNELL, []),
    "frames": (TERRAIN + ["frames.count=3", "frames.step=4", "memory.dram_latency_cycles=20", "memory.dram_bytes_per_cycle=1024",
                          "frames.builder.bytes_per_cycle=4096", "frames.builder.boxes_per_cycle=1024",
                          "frames.builder.requests=4096"] + ENERGY, []),
    "clusters": (TERRAIN + ["frames.count=3", "frames.update=clusters", "frames.builder.asks=l2"], []),
    "best-split": (CORNELL + ["area.fit=best", "area.budget_mm2=20"] + ENERGY, []),
    "clocks": (CORNELL + FOUR[:1] + [f"topology.nodes=[{PLACED}]", "topology.links=[{mesh: [2, 2]}]", "clocks.noc=1500"] + ENERGY, []),
    "pools": (CORNELL + FOUR[:1] + ["topology.nodes=[{name: r, count: 4}, {name: s, kind: shading, serves: 'r[0..1]'}, "
                                    "{name: t, kind: shading}]",
                                    "topology.links=[{ring: 'r[*]'}, {from: 'r[*]', all_to: 's, t', both: true, "
                                    "carries: [new_rays, completed_rays]}]"], []),
    "stops": (CORNELL + FOUR + ["topology.links=[{ring: 'r[*]', both: true, stops: {rule: slots}}]"], []),
    "spill": (CORNELL + ["collections.when_full=spill", "collections.capacity=64", "memory.path_state=memory",
                         "memory.ray_records=master", "memory.film=memory"], []),
    "write-back": (CORNELL + ["collections.when_full=spill", "collections.capacity=64", "memory.path_state=memory",
                              "memory.film=memory", "memory.l2_write=back"], []),
    "banks": (INSTANCES + ["rays.banks=2", "accuracy.transformed_ray=store"], []),
    "bundles": (TERRAIN + ["bundles.size=8", "bundles.form=silhouette"] + ENERGY, []),
    "planes": (TERRAIN + ["cull_planes.count=3"] + ENERGY, []),
    "nearest": (GAUSSIANS + ["rays.query.nearest=8"] + ENERGY, []),
    "warps": (INSTANCES + ["topology.shape=independent", "testers.simt.warp=8", "bvh.treelets.bytes=1024",
                           "testers.simt.prefetch=treelet", "testers.simt.compaction=repack", "memory.l1_kib=4"] + ENERGY, []),
    "lanes": (CORNELL + LANES + ENERGY, []),
    "lanes-planes": (["scene.builtin=foliage", "scene.triangles=400"] + CORNELL[1:] + LANES + [
        "cull_planes.count=3", "bvh.micromaps.states=four"], []),
    "lanes-spheres": (["scene.builtin=spheres", "scene.procedural=true"] + CORNELL[1:] + LANES + ENERGY, []),
    "lanes-blocks": (TERRAIN + LANES + ["scene.quantise=12", "bvh.leaves=blocks"], []),
    "lanes-bundles": (TERRAIN + LANES + ["bundles.size=8"], []),
    "lanes-nearest": (TERRAIN + LANES + ["rays.query.nearest=8"], []),
    "distributor": (CORNELL + ["topology.shape=central", "topology.form=distributor", "topology.resources=1",
                               "testers.contexts=4"] + ENERGY, []),
    "strips": (TERRAIN + ["bvh.leaves=strips", "bvh.storage=quantised"], []),
    "foliage": (["scene.builtin=foliage", "scene.triangles=400"] + CORNELL[1:] + ["bvh.micromaps.states=four"] + ENERGY, []),
    "levels": (["scene.builtin=instances", "scene.instances=50", "scene.levels=4", "bvh.levels=4"] + CORNELL[1:], []),
    "own-primitive": (CORNELL + ["scene.objects=[{primitive: ball, at: [0, 1, 0], scale: 0.5}]",
                                 "primitives.ball.bounds={low: [-1, -1, -1], high: [1, 1, 1]}",
                                 "primitives.ball.program=['load t, 1', 'hit t, dx, dy, dz']"] + ENERGY, []),
    "shaders": (CORNELL + ["shading.program.default=built_in", "shading.instruction_cache.bytes=512",
                           "shading.data_cache.bytes=4096", "shading.translation.page_bytes=4096", "shading.lanes=4",
                           "shading.sort=shader"] + ENERGY, []),
    "raster": (TERRAIN + ["primary=raster", "raster.time=cycles"] + ENERGY, []),
    "raster-frames": (TERRAIN + ["primary=raster", "raster.time=cycles", "frames.count=2"], []),
    "sampled": (["scene.builtin=terrain", "scene.triangles=400", "engine.kind=cycle", "image.width=48", "image.height=32",
                 "image.samples=1", "sampling.fraction=0.5"] + ENERGY, ["--audit"]),
    "prefetcher": (["scene.builtin=terrain", "scene.triangles=2000"] + CORNELL[1:] + ["prefetcher.lines=2"] + ENERGY, []),
    "effects-proof": (CORNELL + ["verify=effects"], []),
    "faults": (CORNELL + ["topology.visit=owners", "faults.links.drop=0.01", "faults.compare=true"], []),
    "stopped": (CORNELL + ["faults.resource.kind=stop", "faults.resource.after_rays=10", "faults.resource.silence_cycles=1000",
                           "faults.compare=true"], []),
    "requests": (["engine.kind=cycle", "workload.memory_trace=requests.csv", "memory.dram.preset=gddr6_14"], []),
    "traffic": (TRAFFIC, []),
    "traffic-stops": (TRAFFIC + FOUR + ["topology.links=[{ring: 'r[*]', both: true, stops: {rule: slots}}]",
                                        "workload.traffic.reply_bytes=32"], []),
    "traffic-clocks": (TRAFFIC + FOUR + ["topology.links=[{line: 'r[*]', both: true}]", "clocks.noc=1500"], []),
    "native": (["scene.builtin=cornell", "engine.threads=1", "memory.l2_kib=64"] + SIZE, []),
    "native-stopped": (["scene.builtin=cornell", "engine.threads=1", "faults.resource.kind=stop",
                        "faults.resource.after_rays=10"] + SIZE, []),
    "plugin": (["scene.builtin=cornell", "engine.kind=cycle", "engine.plugins=[build/libown_workload.so]", "workload.plugin=scanner"], []),
    "ranks": (["scene.builtin=cornell", "engine.transport=mpi", "engine.threads=1", "topology.resources=2"] + SIZE, []),
}
PROCESSES = {"ranks": 2}   # started with mpirun

# Numbers that differ from run to run, between machines or between builds, by the beginning of their keys; and the runs
# whose numbers do. The pages keep those that they have, if these are of the same kind.
VARY = ("carousel", "host", "checksum", "config", "plugins", "shading.proof")
VARYING_RUNS = ("native", "native-stopped", "ranks")

# Numbers that no run has, and why.
NONE = {"memory.own_caches.ahead": "no part asks caches of the resources' own for lines ahead yet",
        **{f"area.search.trials[].frame_{_what}": "trials of frames of more than 200,000 paths alone are sampled, which take minutes"
           for _what in ("cycles", "nj_per_ray")}}
