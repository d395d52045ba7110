// The runs whose pages are looked at: small, one for each kind of machine and of report.
const small = ['image.width=24', 'image.height=16', 'image.samples=1', 'scene.triangles=2000', 'engine.what_if=false'];
const cycle = [...small, 'engine.kind=cycle'];
const shape = (name, ...more) => ({config: 'demo', sets: [...cycle, `topology.shape=${name}`, ...more]});

export const machines = {
  ring: {config: 'demo', sets: cycle},
  bidirectional: shape('bidirectional'),
  several_rings: shape('multi_ring', 'topology.rings=3'),
  hierarchy: shape('hierarchical', 'topology.resources=12'),
  bus: shape('bus'),
  point_to_point: shape('point_to_point'),
  independent: shape('independent'),
  many: shape('ring', 'topology.resources=96', 'rays.slots_per_resource=256'),
  verdict: {config: 'demo', sets: [...cycle, 'engine.what_if=true', 'topology.resources=2', 'image.width=16']},
  bundles: {config: 'bundles', sets: cycle},
  cull_planes: {config: 'cull_planes', sets: cycle},
  faults: shape('ring', 'faults={links: {drop: 0.02, delay: 0.02}, compare: true}', 'verify=reference'),
  native: {config: 'demo', sets: small},
  traffic: {config: 'traffic', sets: ['workload.traffic.packets=2000']},
};
