// Sliders over the grid of a sweep: the results between its points, and with `carousel serve` the run of a point itself.
import {full} from './look.js';
import {readTable} from './table.js';

const isNumber = (value) => typeof value === 'number';
const kSeed = 'image.seed';  // seeds are no scale: their mean counts
const kSteps = 1000;         // of a slider

/** The keys of a sweep with more than one value. Values that double have places by their logarithms. */
export function scalesOf(table, keys) {
  return keys.filter((key) => key !== kSeed).map((key) => {
    const column = table.column(key);
    const values = [...new Set(table.rows.map((row) => row[column]))];
    const numeric = values.every(isNumber);
    if (numeric) values.sort((a, b) => a - b);
    const doubles = numeric && values[0] > 0 && values.at(-1) >= 4 * values[0];
    return {key, column, values, numeric: numeric && values.length > 1, place: doubles ? Math.log : (v) => v, doubles,
      whole: numeric && values.every(Number.isInteger)};
  });
}

/** The value of a slider's position, 0 to kSteps. */
export function valueAt({values, doubles, whole}, position) {
  const [low, high] = [values[0], values.at(-1)], part = position / kSteps;
  const value = doubles ? low * (high / low) ** part : low + (high - low) * part;
  const told = whole ? Math.round(value) : Number(value.toPrecision(4));
  return Math.min(high, Math.max(low, told));
}

/** The result in the column `c` for a value of each scale: of the points at the corners of the cell around it, by their
 * places, and by logarithms where all are above 0. Null where a corner was not simulated. */
export function interpolated(table, scales, at, c) {
  let corners = [{weight: 1, wanted: []}];
  for (const [i, {numeric, values, place, column}] of scales.entries()) {
    let ends = [[at[i], 1]];
    if (numeric && !values.includes(at[i])) {
      const above = values.findIndex((v) => v > at[i]), [low, high] = [values[above - 1], values[above]];
      const part = (place(at[i]) - place(low)) / (place(high) - place(low));
      ends = [[low, 1 - part], [high, part]];
    }
    corners = corners.flatMap(({weight, wanted}) => ends.map(([v, w]) => ({weight: weight * w, wanted: [...wanted, [column, v]]})));
  }
  const found = corners.map(({weight, wanted}) => {
    const values = table.rows.filter((row) => wanted.every(([column, v]) => row[column] === v)).map((row) => row[c]).filter(isNumber);
    return {weight, value: values.length ? values.reduce((a, b) => a + b) / values.length : null};
  });
  if (found.some(({value}) => value === null)) return null;
  const logs = found.every(({value}) => value > 0);
  const sum = found.reduce((total, {weight, value}) => total + weight * (logs ? Math.log(value) : value), 0);
  return logs ? Math.exp(sum) : sum;
}

function controlOf({key, values, numeric, ...scale}, change) {
  const row = document.createElement('p'), label = document.createElement('label');
  row.className = 'control';
  label.append(`${key} `);
  row.append(label);
  if (!numeric) {
    const box = document.createElement('select');
    for (const value of values) box.add(new Option(String(value), String(value)));
    box.addEventListener('change', () => change(values[box.selectedIndex]));
    label.append(box);
    return row;
  }
  const slider = document.createElement('input'), told = document.createElement('output');
  Object.assign(slider, {type: 'range', min: 0, max: kSteps, step: 1, value: 0});
  const tell = (value) => {
    told.textContent = String(value);
    slider.setAttribute('aria-valuetext', String(value));
  };
  slider.addEventListener('input', () => {
    const value = valueAt({values, ...scale}, Number(slider.value));
    tell(value);
    change(value);
  });
  tell(values[0]);
  label.append(slider);
  row.append(told);
  return row;
}

const shown = (value) => (isNumber(value) ? full(Number(value.toPrecision(5))) : '–');

/** A row a result: its value between the points, and as simulated. */
function tableOf(results) {
  const table = document.createElement('table'), head = table.createTHead().insertRow(), body = table.createTBody();
  table.id = 'table-between';
  for (const title of ['result', 'between the points', 'simulated']) {
    const th = document.createElement('th');
    th.scope = 'col';
    th.textContent = title;
    head.append(th);
  }
  for (const result of results) {
    const row = body.insertRow();
    row.insertCell().textContent = result;
    for (let i = 0; i < 2; ++i) row.insertCell().className = 'n';
  }
  const fill = (column, values) => {
    for (const [i, value] of values.entries()) {
      const cell = body.rows[i].cells[column];
      cell.textContent = shown(value);
      if (isNumber(value)) cell.dataset.v = value;
      else delete cell.dataset.v;
    }
  };
  return {table, fill};
}

/** The button that has the server simulate the point, and what comes of it. */
function asker(keysOf, results, fill) {
  const row = document.createElement('p'), button = document.createElement('button'), told = document.createElement('span');
  row.className = 'control';
  Object.assign(button, {type: 'button', id: 'ask', textContent: 'Simulate this point'});
  told.setAttribute('role', 'status');
  row.append(button, told);
  const take = async (answer) => {
    const text = await answer.text();
    if (!answer.ok) throw new Error(text.trim());
    return JSON.parse(text);
  };
  const wait = async (name) => {
    for (;;) {
      const state = await take(await fetch(`ask?name=${encodeURIComponent(name)}`));
      if (state.state !== 'running') return state;
      await new Promise((done) => setTimeout(done, 300));
    }
  };
  button.addEventListener('click', async () => {
    const keys = keysOf();
    button.disabled = true;
    told.textContent = 'is being simulated';
    try {
      const query = Object.entries(keys).map((pair) => pair.map((part) => encodeURIComponent(String(part))).join('=')).join('&');
      const state = await wait((await take(await fetch(`ask?${query}`, {method: 'POST'}))).name);
      if (state.state !== 'done') throw new Error(state.error);
      if (JSON.stringify(keys) !== JSON.stringify(keysOf())) {
        told.textContent = 'another point is chosen meanwhile';
        return;
      }
      fill(2, results.map((result) => state.results[result]));
      const link = document.createElement('a');
      link.href = state.page;
      link.textContent = 'the page of this point';
      // A point is one simulation, and what lies between points is of means over the seeds.
      const seed = keys[kSeed];
      told.replaceChildren(link, ...(seed === undefined ? [] : [` (of seed ${seed} alone; between the points are means over all seeds)`]));
    } catch (error) {
      told.textContent = error.message;
    } finally {
      button.disabled = false;
    }
  });
  return {row, clear: () => told.replaceChildren()};
}

/** Fills in the section, if this is the page of a sweep with something between its points. */
export function between({sweep}) {
  const place = document.getElementById('between-points'), all = sweep && readTable('points');
  if (!place || !all) return;
  const done = all.column('status');
  const table = {...all, rows: all.rows.filter((row) => row[done] === 'done')};
  const scales = scalesOf(table, sweep.keys);
  const results = sweep.results.filter((name) => table.rows.some((row) => isNumber(row[table.column(name)])));
  if (!scales.some(({numeric}) => numeric) || !results.length) {
    place.closest('section').hidden = true;
    return;
  }
  const at = scales.map(({values}) => values[0]);
  const {table: answers, fill} = tableOf(results), scroll = document.createElement('div');
  scroll.className = 'scroll';
  scroll.append(answers);
  const keysOf = () => {
    const keys = Object.fromEntries(scales.map(({key}, i) => [key, at[i]]));
    const seed = table.column(kSeed);
    if (sweep.keys.includes(kSeed)) keys[kSeed] = table.rows[0][seed];
    return keys;
  };
  const ask = sweep.asks ? asker(keysOf, results, fill) : null;
  const tell = () => {
    fill(1, results.map((name) => interpolated(table, scales, at, table.column(name))));
    fill(2, results.map(() => null));
    ask?.clear();
  };
  place.append(...scales.map((scale, i) => controlOf(scale, (value) => {
    at[i] = value;
    tell();
  })), ...(ask ? [ask.row] : []), scroll);
  tell();
}
