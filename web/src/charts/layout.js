// Where the parts of a machine stand in its drawing.

const circle = (n, i, radius, x = 0, y = 0, from = -Math.PI / 2) => {
  const angle = from + (2 * Math.PI * i) / n;
  return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
};

/** Places of a graph whose nodes have none: links pull, nodes push (T. Fruchterman, E. Reingold, Graph drawing by
 * force-directed placement, Software: Practice and Experience 21 (1991)), from a circle on, so that it is the same each time. */
function spread(count, links) {
  const at = Array.from({length: count}, (_, i) => circle(count, i, 1));
  const ideal = 1.6 / Math.sqrt(count), rounds = Math.max(40, Math.min(300, Math.round(4e6 / (count * count))));
  for (let round = 0; round < rounds; ++round) {
    const force = at.map(() => [0, 0]);
    const pull = (a, b, strength) => {
      const x = at[b][0] - at[a][0], y = at[b][1] - at[a][1], far = Math.max(1e-3, Math.hypot(x, y)), by = strength(far) / far;
      force[a][0] += x * by; force[a][1] += y * by;
      force[b][0] -= x * by; force[b][1] -= y * by;
    };
    for (let a = 0; a < count; ++a) for (let b = a + 1; b < count; ++b) pull(a, b, (far) => -ideal * ideal / far);
    for (const [a, b] of links) pull(a, b, (far) => far * far / ideal / 2);
    const most = 0.15 * (1 - round / rounds) + 0.002;
    at.forEach((place, i) => {
      const size = Math.max(1e-9, Math.hypot(...force[i])), by = Math.min(size, most) / size;
      place[0] += force[i][0] * by; place[1] += force[i][1] * by;
    });
  }
  return at;
}

/** The places of the resources and, behind them, of the hubs: [x, y] each. `hubs` is their number; `links` have the
 * numbers of their ends. */
export function places(facts, hubs, links) {
  const n = facts.resources;
  if (facts.drawing?.every((node) => node.x_mm !== undefined))  // as a floor plan has it, y upwards
    return facts.drawing.map((node) => [node.x_mm, -node.y_mm]);
  const ring = links.every(([a, b]) => (a + 1) % n === b || (b + 1) % n === a);
  if (facts.shape === 'graph' && (hubs > 0 || !ring)) return spread(n + hubs, links);
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
