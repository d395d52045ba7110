"""Command lines that run in a moment in a folder with the files of example_files.py, in this order. The first line of a
command that has an option is its example; a new option needs a line here, or a word in one."""

LINES = {
    "run": [
        "carousel run small.yaml --set image.width=16 --out out/a --heat log --hits",
        "carousel run small.yaml --out out/b --force --strict --no-html --quiet",
        "carousel run small.yaml --out out/charged --charge-all --json --log-level error",
        "carousel run small.yaml --out out/dumped --dump-rays all.csv --dump-trees small.trees --dump-memory memory.csv --log-file run.log",
        "carousel run small.yaml --out out/half --set sampling.fraction=0.5 --set image.width=48 --set image.height=32 --audit",
        "carousel run small.yaml --out out/traced --trace small.pftrace --trace-window 0:5000 --trace-sample 2 --trace-events 1000",
    ],
    "sweep": [
        "carousel sweep small.yaml --vary packets.rays=8,16 --set image.seed=2 --result packets.latency.p99 --pareto cycles,bytes --out out/sweep --quiet",
        "carousel sweep small.yaml --vary packets.rays=8..16:5 --vary memory.l2_kib=8..64*2 --points 3 --seed 5 --exclude 'packets.rays=8,memory.l2_kib<=8' --out out/cube --json",
        "carousel sweep small.yaml --vary packets.rays=8,16 --repeat 2 --jobs 1 --scene builtin:cornell --scene builtin:sliver --out out/scenes --log-level error",
        "carousel sweep small.yaml --vary packets.rays=8,16 --shard 1/2 --out out/first && carousel sweep small.yaml --vary packets.rays=8,16 --shard 2/2 --out out/second",
        "carousel sweep small.yaml --vary packets.rays=8,16 --merge out/first --merge out/second --out out/merged",
        "carousel sweep small.yaml --vary packets.rays=8,16 --set image.width=48 --set image.height=32 --sampled=0.5 --out out/sampled --log-file sweep.log",
        "carousel sweep small.yaml --vary packets.rays=8,16 --dry-run --out out/sweep",
        "carousel sweep small.yaml --vary packets.rays=8,16 --retry-failed --out out/scenes-again",
        "echo '{\"packets.rays\": 8}' | carousel sweep small.yaml --ask --tell --out out/asked",
    ],
    "check": [
        "carousel check small.yaml --set image.width=16 --strict --log-level error",
        "carousel check small.yaml --graph",
        "carousel check small.yaml --json --log-file check.log",
    ],
    "stress": [
        "carousel stress --queue spsc_ring,mutex --pattern stream --bytes 8,64 --messages 1000 --repetitions 1 --seconds 1 --capacity 16 --seed 2 --out out/queues --log-level error",
        "carousel stress small.yaml --set engine.kind=native --set topology.resources=2 --queue mutex --in topology.link.queue --depths 4,16 --messages 1000 --repetitions 1 --pairs 1 --seconds 1 --out out/stress --force --json",
        "carousel stress --queue spsc_ring --plugin build/libown_queue.so --pattern stream --messages 1000 --repetitions 1 --seconds 1 --out out/own --quiet --log-file stress.log",
    ],
    "accuracy": [
        "carousel accuracy small.yaml --set image.width=4 --rays 200 --hard-rays 100 --repetitions 1 --seeds 2 --seed 3 --table --out out/levels",
        "carousel accuracy --certify --seconds 1 --out out/certificate --quiet",
        "carousel accuracy --certify --cases 200 --out out/certificate --force --json",
        "carousel accuracy --reproduce 'box conservative origin=0,0,-2 direction=0,0,1 tmin=0 tmax=inf lo=-1,-1,-1 hi=1,1,1' --log-level error --log-file accuracy.log",
    ],
    "inspect": [
        "carousel inspect moving.gltf --json --log-level error",
        "carousel inspect moving.gltf --frame triangle --set image.width=64 --log-file inspect.log",
    ],
    "compare": [
        "carousel compare small out/a --all --html compared.html --log-level error",
        "carousel compare small out/a --only '*latency*' --json --log-file compare.log",
        "carousel compare small small --expect identical",
    ],
    "versus": [
        "carousel versus small.yaml --set topology.resources=2 --seeds 1 --no-search --charge-all --out out/versus --quiet --log-level error",
        "carousel versus small.yaml --set topology.resources=2 --seeds 1 --no-search --out out/versus --force --json --log-file versus.log",
    ],
    "follow": [
        "carousel follow small.yaml --set image.width=8 --pixel 4,4 --sample 0 --bounce 0 --quiet --log-level error",
        "carousel follow small.yaml --pixel 4,4 --shadow --json",
        "carousel follow small.yaml --ray 0 --log-file follow.log",
    ],
    "report": [
        "carousel report small --out small.html --log-level error --log-file report.log",
        "carousel report out/sweep --point $(basename -s .json out/sweep/points/*.json | head -n 1)",
    ],
    "serve": ["carousel serve small out --port 18123 --log-level error --log-file serve.log"],
    "schema": [
        "carousel schema config --plugin build/libown_queue.so --log-level error",
        "carousel schema config --graph drawn.yaml",
        "carousel schema report --markdown --log-file schema.log",
    ],
    "completion": ["source <(carousel completion bash --log-level error --log-file completion.log)"],
    "man": ["carousel man --log-level error --log-file man.log >carousel.1"],
}
