// Where the parts of a machine stand in its drawing.

const circle = (n, i, radius, x = 0, y = 0, from = -Math.PI / 2) => {
  const angle = from + (2 * Math.PI * i) / n;
  return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
};

/** Places of a graph whose nodes have none: as far from one another as there are links between them, as well as that goes in
 * a plane (E. Gansner, Y. Koren, S. North, Graph drawing by stress majorization, Graph Drawing 2004). It begins with the
 * distances from nodes that are far apart, so that it is the same each time. */
function spread(count, links) {
  const beside = Array.from({length: count}, () => []);
  for (const [a, b] of links) { beside[a].push(b); beside[b].push(a); }
  const far = beside.map((_, start) => {
    const links = new Array(count).fill(count), open = [start];
    links[start] = 0;
    for (const at of open) for (const next of beside[at]) if (links[next] === count) { links[next] = links[at] + 1; open.push(next); }
    return links;
  });
  const best = (value) => far.reduce((top, _, i) => (value(i) > value(top) ? i : top), 0);
  const a = best((i) => far[0][i]), b = best((i) => far[a][i]);
  const c = best((i) => Math.min(far[a][i], far[b][i]) - Math.abs(far[a][i] - far[b][i])), d = best((i) => far[c][i] - Math.abs(far[a][i] - far[b][i]));
  let at = far.map((_, i) => {
    const [x, y] = circle(count, i, 0.05);
    return [far[a][i] - far[b][i] + x, far[c][i] - far[d][i] + y];
  });
  const rounds = Math.max(30, Math.min(300, Math.round(6e6 / (count * count))));
  for (let round = 0; round < rounds; ++round)
    at = at.map(([x, y], i) => {
      let sum = 0, nextX = 0, nextY = 0;
      for (let j = 0; j < count; ++j) {
        if (i === j) continue;
        const weight = 1 / far[i][j] ** 2, apart = Math.max(1e-6, Math.hypot(x - at[j][0], y - at[j][1])), by = far[i][j] / apart;
        sum += weight;
        nextX += weight * (at[j][0] + (x - at[j][0]) * by);
        nextY += weight * (at[j][1] + (y - at[j][1]) * by);
      }
      return sum > 0 ? [nextX / sum, nextY / sum] : [x, y];
    });
  return at;
}

/** The least distance between two places, when they fill so many pixels. */
export function leastGap(at, width, height) {
  const span = (axis) => Math.max(...at.map((p) => p[axis])) - Math.min(...at.map((p) => p[axis]));
  const scale = Math.min(width / Math.max(1e-9, span(0)), height / Math.max(1e-9, span(1)));
  let least = Infinity;
  for (let i = 0; i < at.length; ++i) for (let j = 0; j < i; ++j) least = Math.min(least, Math.hypot(at[i][0] - at[j][0], at[i][1] - at[j][1]));
  return least * scale;
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
