"""The whole machine."""
from .clock import Clock, Trace
from .dram import BankedMemory
from .graph import GraphTopology, connect_graph, rings_of_rings
from .memory import Memory, ShapePort, caches_of, own_caches
from .network import Topology, connect
from .parcels import Parcels
from .prefetcher import prefetchers_of
from .ray_data import RayData
from .shading import Shading
from .tile import Control, Tile
from .traversal import Spread
from .tree import Node


def memory(config, caches):
    banks = config["memory"]["dram"]["preset"] != "pipe"
    return (BankedMemory if banks else Memory)(config, caches)


class Machine:
    def __init__(self, facts):
        config = facts["config"]
        if config["topology"]["shape"] == "hierarchical":
            config = {**config, "topology": rings_of_rings(config["topology"])}
        stacks = config["topology"].get("trace") == "stacks" and config["topology"]["shape"] == "graph"
        if stacks:
            config = {**config, "topology": {**config["topology"], "shape": "independent"}}
        self.config = config
        self.facts, self.clock, self.trace = facts, Clock(), Trace()
        self.nodes = [Node(i, fact) for i, fact in enumerate(facts["nodes"])]
        graph = config["topology"]["shape"] == "graph" and config["topology"]["resources"] > 1
        self.topology = (GraphTopology if graph else Topology)(config)
        self.initial_tests = Spread(config, facts, self.nodes).tests_at(0)
        resources, link = self.topology.resources, config["topology"]["link"]
        places = config["testers"]["contexts"] + 1
        ends = (connect_graph(self.clock, self.topology, places) if graph else
                connect(self.clock, self.topology, link, places))
        shapes = [ShapePort(config, self.clock) for _ in range(resources)]
        controls = [Control(config, self.clock) for _ in range(resources)]
        if self.topology.shape == "independent":
            from .independent import IndependentTile
            self.tiles = [IndependentTile(r, self, shapes[r], controls[r]) for r in range(resources)]
        else:
            self.tiles = [Tile(r, self, ends[r], shapes[r], controls[r]) for r in range(resources)]
        self.ray_data = RayData(config, facts, self.clock)
        parcels = Parcels(config, self.clock, shapes, controls) if stacks else None
        if parcels and parcels.groups_of("cache"):
            own = own_caches(config, self.clock, shapes)
            l2 = parcels.join_caches(own)
            caches = own + l2
        else:
            l2, caches = caches_of(config, self.clock, shapes, self.ray_data.ports)
        askers = (parcels.join_memories(l2) if parcels else []) or [l2]
        self.shading = Shading(self, parcels.join_rays() if parcels else controls)
        prefetchers = prefetchers_of(config, self.clock, shapes, l2)
        self.parts = [*self.tiles, *ends[resources:], *caches, *prefetchers, *(memory(config, one) for one in askers),
                      self.shading, *(parcels.relays if parcels else [])]

    def run(self):
        """The cycle at which each ray has been shaded, by its name."""
        while self.clock.heap:
            now = self.clock.next()
            for part in self.parts:
                part.step(now)
        return self.shading.shaded
