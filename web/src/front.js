// The Pareto front of two numbers.

/** The rows that no other row betters in one of two numbers without being worse in the other, in the order of the first. */
export function front(rows, greater) {
  const cost = (row) => row.value.map((v, i) => (greater[i] ? -v : v));
  const sorted = [...rows].sort((a, b) => cost(a)[0] - cost(b)[0] || cost(a)[1] - cost(b)[1]);
  const out = [];
  let least = Infinity, at = null;
  for (const row of sorted) {
    const [first, second] = cost(row);
    if (second < least || (second === least && first === at)) {
      out.push(row);
      least = second;
      at = first;
    }
  }
  return out;
}

/** The row of a front at which it turns most: farthest from the line between its ends, where both numbers run from 0 to 1,
 * by their logarithms if all are above 0. Null for fewer than three rows. */
export function knee(best) {
  if (best.length < 3) return null;
  const positive = best.every(({value: [a, b]}) => a > 0 && b > 0);
  const of = best.map(({value}) => value.slice(0, 2).map((v) => (positive ? Math.log(v) : v)));
  const [first, last] = [of[0], of.at(-1)];
  const span = [0, 1].map((i) => (last[i] - first[i]) || 1);
  const far = of.map((p) => Math.abs((p[0] - first[0]) / span[0] - (p[1] - first[1]) / span[1]));
  const at = far.indexOf(Math.max(...far));
  return far[at] > 0.02 ? best[at] : null;
}
