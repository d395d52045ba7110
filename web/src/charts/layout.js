// Where the parts of a machine stand in its drawing.

const circle = (n, i, radius, x = 0, y = 0, from = -Math.PI / 2) => {
  const angle = from + (2 * Math.PI * i) / n;
  return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
};

/** The places of the resources and, behind them, of the hubs: [x, y] each. `hubs` is their number. */
export function places(facts, hubs) {
  const n = facts.resources;
  if (facts.shape === 'independent') {
    const across = Math.ceil(Math.sqrt(n * 2));
    return Array.from({length: n}, (_, i) => [i % across, Math.floor(i / across)]);
  }
  if (facts.shape === 'bus') {
    // Above and below the bus, which spreads over the whole width.
    const above = Math.ceil(n / 2);
    return [...Array.from({length: n}, (_, i) => [i < above ? i : i - above + (n % 2 ? 0.5 : 0), i < above ? -1 : 1]),
      [(above - 1) / 2, 0]];
  }
  if (facts.shape === 'hierarchical') {
    const groups = hubs;
    const out = new Array(n + groups);
    const first = (g) => Math.floor((g * n + groups - 1) / groups);
    const size = groups > 1 ? Math.min(0.62, 0.85 * Math.sin(Math.PI / groups)) : 1;
    for (let g = 0; g < groups; ++g) {
      const [x, y] = groups > 1 ? circle(groups, g, 1) : [0, 0];
      const inward = Math.atan2(-y, -x);
      const members = first(g + 1) - first(g);
      out[n + g] = circle(members + 1, 0, size, x, y, inward);
      for (let k = 0; k < members; ++k) out[first(g) + k] = circle(members + 1, k + 1, size, x, y, inward);
    }
    return out;
  }
  const around = Array.from({length: n}, (_, i) => circle(n, i, 1));
  return [...around, ...Array.from({length: hubs}, (_, h) => (hubs === 1 ? [0, 0] : circle(hubs, h, 0.4)))];
}

/** How far each link bends, so that links between the same two parts lie beside one another. */
export function bends(links, facts) {
  const seen = new Map();
  return links.map(([from, to]) => {
    const key = `${from} ${to}`;
    const before = seen.get(key) ?? 0;
    seen.set(key, before + 1);
    const both = ['bidirectional', 'point_to_point', 'graph'].includes(facts.shape) || facts.resources === 2;
    // A ring's links follow its circle.
    return (both ? 0.16 : 0.1) + 0.22 * before;
  });
}
