// The map of the picture's pixels: the cycles, tests, hops or waiting of their rays, with a scale, and the numbers of the
// pixel that is chosen by a click or by its place.
import {full, short} from './look.js';
import {unpack} from './series.js';

// From dark to bright, so that it reads without colours, too; app/trace/heat_map.cpp has the same stops.
const kStops = [[0, 0, 8], [80, 18, 110], [190, 55, 80], [250, 145, 10], [252, 255, 170]];

export function heatColour(part) {
  const at = Math.min(1, Math.max(0, part)) * (kStops.length - 1), below = Math.min(Math.floor(at), kStops.length - 2);
  return kStops[below].map((c, i) => Math.round(c + (at - below) * (kStops[below + 1][i] - c)));
}

/** A scale of the values: their places from 0 to 1, and the value at a place. By logarithms it begins at the least value
 * above 0, and 0 stands below it. */
export function scaleOf(values, log) {
  let least = Infinity, most = 0;
  for (const v of values) {
    if (v > most) most = v;
    if (v > 0 && v < least) least = v;
  }
  if (!log || !(least < most)) return {least: 0, most, place: (v) => (most > 0 ? v / most : 0), at: (part) => part * most};
  const span = Math.log(most / least), kFirst = 0.08;
  return {least, most, place: (v) => (v > 0 ? kFirst + (1 - kFirst) * Math.log(v / least) / span : 0),
    at: (part) => least * Math.exp(span * Math.max(0, (part - kFirst) / (1 - kFirst)))};
}

const count = (value, one, many) => `${full(value)} ${value === 1 ? one : many}`;
const times = (value, mean) => (mean > 0 ? `${Number((value / mean).toPrecision(2))} times the mean` : 'as the mean');

/** The numbers of a pixel in words. `of`: the values of each quantity. */
export function pixelText(of, means, width, index) {
  const value = (name) => of[name][index], x = index % width, y = Math.floor(index / width);
  if (!(value('rays') > 0)) return `Pixel ${x}, ${y} has no rays.`;
  const waiting = value('cycles') > 0 ? (100 * value('waiting')) / value('cycles') : 0;
  return `Pixel ${x}, ${y}: ${full(value('cycles'))} cycles of ${count(value('rays'), 'ray', 'rays')}, ${times(value('cycles'), means.cycles)}; ` +
    `${waiting.toFixed(1)} % of them waiting. ${count(value('tests'), 'test', 'tests')}, ${times(value('tests'), means.tests)}; ` +
    `${count(value('hops'), 'hop', 'hops')}, ${times(value('hops'), means.hops)}.`;
}

function control(row, text, element) {
  const label = document.createElement('label');
  label.append(`${text} `, element);
  row.append(label);
  return element;
}

function select(options) {
  const out = document.createElement('select');
  for (const option of options) out.add(new Option(option, option));
  return out;
}

function number(most) {
  return Object.assign(document.createElement('input'), {type: 'number', min: 0, max: most, step: 1});
}

/** The scale below the map: its colours, and the values at five places. */
function drawScale(bar, ticks, scale, unit) {
  const pen = bar.getContext('2d');
  for (let i = 0; i < bar.width; ++i) {
    pen.fillStyle = `rgb(${heatColour(i / (bar.width - 1)).join(',')})`;
    pen.fillRect(i, 0, 1, bar.height);
  }
  ticks.replaceChildren(...[0, 0.25, 0.5, 0.75, 1].map((part) => {
    const tick = document.createElement('span');
    tick.textContent = short(Math.round(scale.at(part))) + (part === 1 ? ` ${unit}` : '');
    return tick;
  }));
}

const kUnits = {cycles: 'cycles', waiting: 'cycles', tests: 'tests', hops: 'links'};

async function fill(place) {
  const head = await unpack('heat'), {width} = head, height = head.samples / width;
  const of = Object.fromEntries(head.rows.map(({quantity, values}) => [quantity, values]));
  let traced = 0;
  for (const rays of of.rays) if (rays > 0) ++traced;
  const means = Object.fromEntries(Object.entries(of).map(([name, values]) => [name, values.reduce((a, b) => a + b, 0) / traced]));
  const row = document.createElement('div'), map = document.createElement('canvas'), bar = document.createElement('canvas');
  const ticks = document.createElement('p'), told = document.createElement('p'), frame = document.createElement('div');
  const cross = document.createElement('i');
  row.className = 'control';
  const quantity = control(row, 'Quantity', select(['cycles', 'waiting', 'tests', 'hops']));
  const by = control(row, 'Scale', select(['logarithmic', 'linear']));
  const x = control(row, 'Column', number(width - 1)), y = control(row, 'Row', number(height - 1));
  Object.assign(map, {width, height});
  Object.assign(bar, {width: 256, height: 1});
  frame.className = 'heat';
  // A pixel is some whole ones of the screen, where there is room.
  frame.style.maxWidth = `${Math.max(1, Math.floor(960 / width)) * width}px`;
  map.setAttribute('role', 'img');
  ticks.className = 'ticks';
  told.setAttribute('role', 'status');
  frame.append(map, cross, bar, ticks);
  place.append(row, frame, told);

  const draw = () => {
    const values = of[quantity.value], scale = scaleOf(values, by.value === 'logarithmic');
    const pen = map.getContext('2d'), image = pen.createImageData(width, height);
    for (let i = 0; i < values.length; ++i) image.data.set([...heatColour(scale.place(values[i])), 255], 4 * i);
    pen.putImageData(image, 0, 0);
    map.setAttribute('aria-label', `Map of the ${quantity.value} of each pixel's rays, dark few, bright many; the brightest has ${full(scale.most)}.`);
    drawScale(bar, ticks, scale, kUnits[quantity.value]);
  };
  const choose = (index) => {
    const [column, line] = [index % width, Math.floor(index / width)];
    x.value = column;
    y.value = line;
    cross.style.left = `${(100 * (column + 0.5)) / width}%`;
    cross.style.top = `${(100 * (line + 0.5)) / height}%`;
    const code = document.createElement('code');
    code.textContent = `carousel follow config.resolved.yaml --pixel ${column},${line}`;
    told.replaceChildren(pixelText(of, means, width, index), ' Its first ray: ', code);
  };
  const typed = () => {
    const [column, line] = [x, y].map((box) => Number(box.value));
    if (x.checkValidity() && y.checkValidity() && x.value !== '' && y.value !== '') choose(line * width + column);
  };
  quantity.addEventListener('change', draw);
  by.addEventListener('change', draw);
  x.addEventListener('input', typed);
  y.addEventListener('input', typed);
  map.addEventListener('click', (event) => {
    const box = map.getBoundingClientRect();
    const at = (part, count) => Math.min(count - 1, Math.max(0, Math.floor(part * count)));
    choose(at((event.clientY - box.top) / box.height, height) * width + at((event.clientX - box.left) / box.width, width));
  });
  draw();
  let slowest = 0;
  for (let i = 1; i < of.cycles.length; ++i) if (of.cycles[i] > of.cycles[slowest]) slowest = i;
  choose(slowest);
  place.dataset.drawn = 'map';
}

/** Draws the map when it is first seen; what it gives draws it at once. */
export function heatMap() {
  const place = document.getElementById('heat-map');
  if (!place || !document.getElementById('heat-head')) return async () => {};
  let drawn = null;
  const once = () => (drawn ??= fill(place));
  new IntersectionObserver((entries, seen) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    seen.disconnect();
    once();
  }, {rootMargin: '300px'}).observe(place);
  return once;
}
