// Several bars a row, side by side.
import {axis, base, full, kBetter, kHues, kWorse, names, percent, short} from '../look.js';

/** The columns from `first` on up to the first that holds no number. */
function numberColumns(table, first) {
  const out = [];
  for (let c = first; c < table.columns.length && table.rows.some((r) => typeof r[c] === 'number'); ++c) out.push(c);
  return out;
}

const numberOf = (cell) => (typeof cell === 'number' ? cell : null);

function grouped({colours, width}, rows, series, xAxis, tooltip) {
  return {
    ...base(colours),
    grid: {left: 10, right: 60, top: 36, bottom: 40, containLabel: true},
    tooltip: {...base(colours).tooltip, trigger: 'axis', axisPointer: {type: 'shadow'}, ...tooltip},
    xAxis: axis(colours, {nameLocation: 'middle', nameGap: 26, splitNumber: width < 600 ? 3 : 6, ...xAxis}),
    yAxis: names(colours, rows, width),
    series: series.map((s, i) => ({type: 'bar', barMaxWidth: 18, itemStyle: {color: kHues[i % kHues.length]}, ...s,
      label: {show: true, position: 'right', color: colours.ink, formatter: s.text}})),
  };
}

/** Amounts of a kind, a bar for each column of numbers. */
export function groups(context) {
  const [table] = context.tables;
  return grouped(context, table.rows.map((r) => r[0]), numberColumns(table, 1).map((c) => ({
    name: table.columns[c], data: table.rows.map((r) => numberOf(r[c])), text: ({value}) => short(value),
  })), {type: 'value', axisLabel: {formatter: short}}, {valueFormatter: (v) => (v == null ? '–' : full(v))});
}

/** The same for shares of a whole. */
export function shares(context) {
  const [table] = context.tables;
  return grouped(context, table.rows.map((r) => r[0]), numberColumns(table, 2).map((c) => ({
    name: table.columns[c], data: table.rows.map((r) => numberOf(r[c])), text: ({value}) => percent(value),
  })), {type: 'value', axisLabel: {formatter: (v) => `${Math.round(100 * v)} %`}},
  {valueFormatter: (v) => (v == null ? '–' : percent(v))});
}

/** Ratios to the first run: to the right where there is more, to the left where there is less. The scale is logarithmic. */
export function ratios(context) {
  const [table] = context.tables;
  const columns = table.columns.map((name, c) => [name, c]).filter(([name]) => name.endsWith('/A'));
  const times = (v) => `×${Number((2 ** v).toPrecision(3))}`;
  const most = 8;  // doublings that are drawn; the table has the number
  const clamped = (v) => (v > 0 ? Math.max(-most, Math.min(most, Math.log2(v))) : null);
  const drawn = table.rows.flatMap((r) => columns.map(([, c]) => r[c])).filter((v) => typeof v === 'number').map(clamped).filter((v) => v !== null);
  const ends = [Math.min(0, ...drawn), Math.max(0, ...drawn)];
  const wide = ends[1] - ends[0] > 3;
  const ticks = (wide ? [1 / 64, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1, 2, 4, 8, 16, 64] : [0.5, 0.7, 0.8, 0.9, 1, 1.1, 1.25, 1.5, 2, 3, 4])
    .map(Math.log2).filter((v) => v >= ends[0] - 0.2 && v <= ends[1] + 0.2);
  // Less is better but for rates and hits; other counts say neither.
  const unit = table.columns.indexOf('unit');
  const side = (row, v) => {
    const name = `${row[0]}, ${row[unit]}`;
    const greater = /^(mrays|hit|steady|reached|throughput)|per (kilocycle|second|joule|mm)|rays\/|hit fraction/i.test(name);
    const smaller = /cycle|joule|nJ|bytes|latency|tests|waits?|stall|second|time|area|mm/i.test(name);
    if (!greater && !smaller) return undefined;
    return (v > 0) === greater ? kBetter : kWorse;
  };
  const rows = table.rows.filter((r) => columns.some(([, c]) => typeof r[c] === 'number' && r[c] > 0));
  if (!rows.length) return null;
  return grouped(context, rows.map((r) => r[0]), columns.map(([name, c]) => ({
    name, data: rows.map((r) => {
      const value = typeof r[c] === 'number' ? clamped(r[c]) : null;
      return columns.length === 1 && value ? {value, itemStyle: {color: side(r, value) ?? kHues[0]}} : value;
    }), text: ({value}) => (value == null ? '' : times(value)),
  })), {type: 'value', name: 'times as much as A', splitLine: {show: false}, axisLabel: {formatter: times, customValues: ticks, hideOverlap: true},
    axisTick: {customValues: ticks}},
  {valueFormatter: (v) => (v == null ? '–' : times(v))});
}
