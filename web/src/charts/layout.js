// How large the parts of a machine are in its drawing, and how its links bend; the program says where the parts stand.

/** The least distance between two places, when they fill so many pixels; `square`: with the same scale across and up. */
export function leastGap(at, width, height, square = true) {
  const span = (axis) => Math.max(...at.map((p) => p[axis])) - Math.min(...at.map((p) => p[axis]));
  const each = [width / Math.max(1e-9, span(0)), height / Math.max(1e-9, span(1))];
  const scale = square ? [Math.min(...each), Math.min(...each)] : each;
  let least = Infinity;
  for (let i = 0; i < at.length; ++i) for (let j = 0; j < i; ++j) least = Math.min(least, Math.hypot((at[i][0] - at[j][0]) * scale[0], (at[i][1] - at[j][1]) * scale[1]));
  return least;
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
    return (both ? 0.16 : facts.resources > 24 ? 0 : 0.1) + 0.22 * before;
  });
}
