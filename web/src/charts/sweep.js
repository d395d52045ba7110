// The plots of a sweep: any two columns of its table of points, the Pareto front of two results, main effects.
import {front, knee} from '../front.js';
import {axis, base, full, kHues, names, numberAxis, short} from '../look.js';

const isNumber = (value) => typeof value === 'number';
const numeric = (table) => table.columns.filter((name, c) => c > 1 && table.rows.some((row) => isNumber(row[c])));
const unlike = (list, name) => list.find((other) => other !== name) ?? name;

/** A choice above a plot; `options` is a list of texts. */
function select(row, text, options, chosen, change) {
  const label = document.createElement('label');
  const box = document.createElement('select');
  label.append(`${text} `, box);
  for (const option of options) box.add(new Option(option, option, false, option === chosen));
  box.addEventListener('change', () => change(box.value));
  row.append(label);
}

/** The choices of a plot: [text, name of the setting, options, the chosen one] each. */
const choices = (list) => (row, settings, draw) => {
  for (const [text, setting, options, chosen] of list)
    select(row, text, options, chosen, (value) => {
      settings[setting] = value;
      draw();
    });
};

const connect = (chart) => chart.on('click', ({data}) => {
  if (data?.point) dispatchEvent(new CustomEvent('carousel-point', {detail: data.point}));
});

function axisOf(colours, table, name, more, wide) {
  const c = table.column(name);
  const values = table.rows.map((row) => row[c]);
  if (values.some((v) => isNumber(v)))
    return numberAxis(colours, values.filter(isNumber), {name, axisLabel: {formatter: short}, ...more}, wide);
  return axis(colours, {type: 'category', data: [...new Set(values)], name, ...more});
}

const told = (table, row) => table.columns.map((name, c) => `${name}: ${isNumber(row[c]) ? full(row[c]) : row[c]}`).join('<br>');

/** Dots or lines: x and y are any columns; a colour each value of a third. A line joins the means of equal x. */
export function sweepPlot({tables: [table], facts, colours, width, x, y, by, form}) {
  const {keys, results} = facts.sweep;
  const numbers = numeric(table);
  const all = [...keys, ...results];
  y ??= results.find((name) => numbers.includes(name)) ?? numbers[0];
  x ??= keys.find((name) => numbers.includes(name)) ?? unlike(all, y);
  by ??= keys.find((name) => name !== x) ?? 'none';
  form ??= table.rows.some((row) => isNumber(row[table.column(x)])) ? 'lines' : 'dots';
  const [cx, cy, cb] = [x, y, by].map(table.column);
  const category = !table.rows.some((row) => isNumber(row[cx]));
  const groups = new Map();
  for (const row of table.rows) {
    if (!isNumber(row[cy]) || (!category && !isNumber(row[cx]))) continue;
    const name = cb < 0 ? y : `${by} = ${row[cb]}`;
    if (!groups.has(name)) groups.set(name, []);
    groups.get(name).push({value: [row[cx], row[cy]], point: row[0], row});
  }
  const means = (list) => {
    const sums = new Map();
    for (const {value: [at, v]} of list) {
      const sum = sums.get(at) ?? [0, 0];
      sums.set(at, [sum[0] + v, sum[1] + 1]);
    }
    const out = [...sums].map(([at, [sum, n]]) => [at, sum / n]);
    return category ? out : out.sort((a, b) => a[0] - b[0]);
  };
  const lines = form === 'lines';
  const option = {
    ...base(colours),
    grid: {left: 20, right: 40, top: 60, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip, formatter: ({data, seriesName}) =>
      (data.row ? told(table, data.row) : `${seriesName}<br>${x}: ${data[0]}<br>mean of ${y}: ${full(data[1])}`)},
    xAxis: axisOf(colours, table, x, {nameLocation: 'middle', nameGap: 28, splitNumber: width < 600 ? 3 : 8}),
    yAxis: axisOf(colours, table, y, {}),
    series: [...groups].map(([name, list], i) => ({
      name, type: lines ? 'line' : 'scatter', data: lines ? means(list) : list, symbolSize: lines ? 7 : 10,
      itemStyle: {color: kHues[i % kHues.length], opacity: 0.85}, lineStyle: {color: kHues[i % kHues.length]},
    })),
  };
  return {option, connect, choose: choices([
    ['Across', 'x', all, x], ['Up', 'y', numbers, y], ['Colour', 'by', ['none', ...keys], by], ['As', 'form', ['dots', 'lines'], form]])};
}

export function sweepPareto({tables: [table], facts, colours, width, a, b, betterA, betterB}) {
  const list = facts.sweep.results.filter((name) => numeric(table).includes(name));
  if (list.length < 2) return null;
  // The goals of --pareto; without them cycles, and of the others the first that is no other form of them.
  const [goalA, goalB] = facts.sweep.pareto ?? [];
  a ??= list.includes(goalA?.result) ? goalA.result : list[0];
  b ??= list.includes(goalB?.result) ? goalB.result : list.find((name) => name !== a && !/^(cycles|rays_per|mrays_per|gain)/.test(name)) ?? unlike(list, a);
  const goal = (name) => [goalA, goalB].find((g) => g?.result === name);
  const better = (name, chosen) => chosen ??
    ((goal(name)?.maximise ?? facts.sweep.greater_is_better.includes(name)) ? 'greater' : 'smaller');
  const [ca, cb] = [a, b].map(table.column);
  const points = table.rows.filter((row) => isNumber(row[ca]) && isNumber(row[cb]))
    .map((row) => ({value: [row[ca], row[cb]], point: row[0], row}));
  const best = front(points, [better(a, betterA) === 'greater', better(b, betterB) === 'greater']);
  const turn = knee(best);
  const across = points.map((p) => p.value[0]), middle = Math.sqrt(Math.min(...across) * Math.max(...across));
  const option = {
    ...base(colours),
    grid: {left: 20, right: 40, top: 60, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip, formatter: ({data}) => told(table, data.row)},
    xAxis: axisOf(colours, table, a, {nameLocation: 'middle', nameGap: 28, splitNumber: width < 600 ? 3 : 8}, 2),
    yAxis: axisOf(colours, table, b, {}, 2),
    series: [
      {name: 'all points', type: 'scatter', data: points, symbolSize: 9, itemStyle: {color: kHues[4], opacity: 0.7}},
      {name: 'Pareto front', type: 'line', data: best, symbolSize: 11, itemStyle: {color: kHues[5]}, lineStyle: {color: kHues[5]}},
      ...(turn ? [{name: 'knee', type: 'scatter', data: [turn], symbol: 'diamond', symbolSize: 20, itemStyle: {color: kHues[2]}, z: 5,
        label: {show: true, position: turn.value[0] > middle ? 'left' : 'right', distance: 10, width: width * 0.35, overflow: 'break', color: colours.ink, backgroundColor: colours.page, padding: 1, formatter: () => facts.sweep.keys.map((key) => `${key.split('.').at(-1)} ${turn.row[table.column(key)]}`).join(', ')}}] : []),
    ],
  };
  const sides = ['as the result', 'smaller', 'greater'];
  const choose = (row, settings, draw) => choices([['First', 'a', list, a], ['is better', 'betterA', sides, sides[0]],
    ['Second', 'b', list, b], ['is better', 'betterB', sides, sides[0]]])(row, settings, () => {
    for (const side of ['betterA', 'betterB']) if (settings[side] === sides[0]) delete settings[side];
    draw();
  });
  return {option, connect, choose};
}

/** Effects with their intervals, a line a value of a key. */
export function sweepEffects({tables: [table], colours, width, result}) {
  const column = Object.fromEntries(table.columns.map((name, c) => [name, c]));
  const list = [...new Set(table.rows.map((row) => row[column.result]))];
  result ??= list[0];
  const rows = table.rows.filter((row) => row[column.result] === result);
  const bounds = rows.map((row, i) => [row[column.low], row[column.high], i]).filter(([low]) => isNumber(low));
  const text = (i) => {
    const row = rows[i];
    return `${row[column.key]} = ${row[column.value]}<br>effect ${full(row[column.effect])}` +
      (isNumber(row[column.low]) ? ` (${full(row[column.low])} to ${full(row[column.high])})` : '');
  };
  const option = {
    ...base(colours),
    legend: {show: false},
    grid: {left: 10, right: 30, top: 10, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip, formatter: ({dataIndex}) => text(dataIndex)},
    xAxis: axis(colours, {type: 'value', name: `effect on ${result}`, nameLocation: 'middle', nameGap: 28,
      splitNumber: width < 600 ? 3 : 8, axisLabel: {formatter: short}}),
    yAxis: names(colours, rows.map((row) => `${row[column.key]} = ${row[column.value]}`), width),
    series: [
      {type: 'scatter', name: 'effect', data: rows.map((row, i) => [row[column.effect], i]), symbolSize: 10,
        itemStyle: {color: kHues[0]}},
      {
        type: 'custom', name: 'interval', silent: true, z: 5, data: bounds, encode: {x: [0, 1], y: 2},
        renderItem: (params, api) => {
          const [x0, y] = api.coord([api.value(0), api.value(2)]);
          const [x1] = api.coord([api.value(1), api.value(2)]);
          const line = (x1_, y1, x2, y2) => ({type: 'line', shape: {x1: x1_, y1, x2, y2}, style: {stroke: colours.ink, lineWidth: 1.5}});
          return {type: 'group', children: [line(x0, y, x1, y), line(x0, y - 4, x0, y + 4), line(x1, y - 4, x1, y + 4)]};
        },
      },
    ],
  };
  return {option, choose: choices([['Result', 'result', list, result]])};
}
