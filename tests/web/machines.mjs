// The pages that are looked at: small, one for each kind of page; and for soak, one for each kind of machine.
const small = ['image.width=24', 'image.height=16', 'image.samples=1', 'scene.triangles=2000', 'engine.what_if=false'];
const cycle = [...small, 'engine.kind=cycle'];
const machine = (config, sets) => ({command: 'run', config, sets});
const shape = (name, ...more) => machine('demo', [...cycle, `topology.shape=${name}`, ...more]);

export const pages = {
  // All sections of a simulated machine: gains, cull planes, faults, verification, energy and area.
  // `drawn`: charts that must be there; others are left out where there is too little to show.
  machine: {...machine('demo', [...cycle, 'image.width=48', 'image.height=48', 'engine.what_if=true', 'topology.resources=2', 'rays.slots_per_resource=4', 'cull_planes.count=2',
    'verify=reference', 'faults={links: {drop: 0.02, delay: 0.02}, compare: true}', 'energy.profile=n45']),
    drawn: ['fig-energy', 'fig-area', 'fig-ray-time', 'fig-ray-time-kinds']},
  // A picture wider than a phone, with the costs of its pixels.
  slow_pixels: {...machine('demo', [...cycle, 'image.width=480', 'image.height=3', 'topology.resources=2']), options: ['--heat', 'log'],
    drawn: ['fig-ray-time-kinds']},
  native: machine('bundle_tester', [...small, 'engine.kind=native', 'primary=raster']),
  ranks: {...machine('demo', [...small, 'engine.kind=native', 'engine.threads=2', 'engine.transport=mpi', 'topology.resources=6']),
    ranks: 3},
  traffic: machine('traffic', ['workload.traffic.packets=2000']),
  accuracy: {command: 'accuracy', config: 'demo', sets: [...small, 'image.width=8', 'image.height=8', 'scene.triangles=200'],
    options: ['--rays', '60', '--hard-rays', '30', '--repetitions', '1']},
  stress: {command: 'stress', config: 'demo', sets: [...small, 'image.width=8', 'image.height=8', 'topology.resources=2'],
    options: ['--seconds', '0.05', '--messages', '500', '--repetitions', '1', '--pairs', '0', '--queue', 'spsc_ring,mutex',
      '--pattern', 'stream,ping_pong', '--depths', '4']},
  sweep: {command: 'sweep', config: 'sweep', sets: ['image.width=8', 'image.height=8'],
    options: ['--vary', 'topology.resources=2,4', '--vary', 'memory.l2_kib=16,64', '--pareto', 'cycles,bytes']},
  frames: {...machine('moving_scene', ['image.width=16', 'image.height=12', 'frames.count=3', 'scene.instances=40',
    'engine.what_if=false']), drawn: ['fig-frame-cycles', 'fig-frame-tests']},
  life: {command: 'follow', config: 'demo', sets: cycle, options: ['--pixel', '12,8']},
  compare: {command: 'compare', of: ['machine', 'native']},
};

// Where there is little time: the page with most sections, one with a map of pixels, and one whose charts are of points.
export const shortly = ['machine', 'slow_pixels', 'sweep'];

export const all = {
  ...pages,
  ring: machine('demo', cycle),
  bidirectional: shape('bidirectional'),
  several_rings: shape('multi_ring', 'topology.rings=3'),
  hierarchy: shape('hierarchical', 'topology.resources=12'),
  bus: shape('bus'),
  central: {...machine('central_cells', cycle.slice(0, 5)), drawn: ['fig-cycles']},
  point_to_point: shape('point_to_point'),
  independent: shape('independent'),
  placed: machine('demo', [...cycle, 'topology={shape: graph, nodes: [{name: left, count: 4, at: [0, 0], step: [1, 1], columns: 2}, ' +
    '{name: right, count: 4, at: [6, 0], step: [1, 1], columns: 2}, {name: door, kind: router, count: 2, at: [2.5, 0.5], step: [2, 0]}], ' +
    'links: [{ring: "left[0], left[1], left[3], left[2], door[0]", both: true}, ' +
    '{ring: "right[0], right[1], right[3], right[2], door[1]", both: true}, {from: "door[0]", to: "door[1]", both: true}]}']),
  spread: machine('demo', [...cycle, 'topology={shape: graph, nodes: [{name: r, count: 12}], links: [{mesh: [4, 3]}]}']),
  processes: machine('packet_processes', small),
  many: shape('ring', 'topology.resources=96', 'rays.slots_per_resource=256'),
  bundles: machine('bundle_tester', cycle),
  native_life: {command: 'follow', config: 'demo', sets: small, options: ['--pixel', '3,9', '--shadow']},
  side_by_side: {command: 'compare', of: ['ring', 'bus', 'independent'], options: ['--all']},
};
