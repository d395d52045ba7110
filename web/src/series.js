// The time series of the page: unpacked once, when the first chart asks (report/html/packed_series.h has the format).

let unpacked = null;

export function hasSeries() {
  return document.getElementById('series-head') !== null;
}

/** {unit, interval, samples, rows: [{part, quantity, unit, values}]}; values is an Int32Array or a Float32Array. */
export function series() {
  unpacked ??= unpack('series');
  return unpacked;
}

/** What the page holds packed under this name: its head, and the values of its rows. */
export async function unpack(name) {
  const head = JSON.parse(document.getElementById(`${name}-head`).textContent);
  const packed = Uint8Array.from(atob(document.getElementById(`${name}-words`).textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const n = head.samples;
  head.rows.forEach((row, r) => {
    const begin = 4 * n * r;
    const words = new Int32Array(n);
    let word = 0;
    for (let i = 0; i < n; ++i) {
      const step = bytes[begin + i] | (bytes[begin + n + i] << 8) | (bytes[begin + 2 * n + i] << 16) |
        (bytes[begin + 3 * n + i] << 24);
      word = (word + step) | 0;
      words[i] = word;
    }
    row.values = row.words === 'int' ? words : new Float32Array(words.buffer);
  });
  return head;
}

const kFanOut = 4;

/** Least and greatest value of every 4, 16, 64 ... samples, so that any stretch is drawn from few of them. */
export function pyramid(values) {
  const levels = [{each: 1, least: values, most: values}];
  while (levels.at(-1).least.length > 1024) {
    const {each, least, most} = levels.at(-1);
    const n = Math.ceil(least.length / kFanOut);
    const lower = new values.constructor(n), upper = new values.constructor(n);
    for (let i = 0; i < n; ++i) {
      let lo = Infinity, hi = -Infinity;
      for (let k = kFanOut * i; k < Math.min(least.length, kFanOut * (i + 1)); ++k) {
        if (least[k] < lo) lo = least[k];
        if (most[k] > hi) hi = most[k];
      }
      lower[i] = lo;
      upper[i] = hi;
    }
    levels.push({each: kFanOut * each, least: lower, most: upper});
  }
  return levels;
}

/** Points [time, value] of the samples from `first` to before `end`: at most about 2 `wanted`, extremes kept. */
export function pointsOf(levels, interval, first, end, wanted) {
  const level = levels.find(({each}) => (end - first) / each <= wanted) ?? levels.at(-1);
  const {each, least, most} = level;
  const points = [];
  const last = Math.min(least.length, Math.ceil(end / each));
  for (let i = Math.max(0, Math.floor(first / each)); i < last; ++i) {
    const time = i * each * interval;
    points.push([time, least[i]]);
    if (each > 1) points.push([time + (each * interval) / 2, most[i]]);
  }
  return points;
}
