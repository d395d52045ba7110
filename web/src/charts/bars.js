// Bars of one column, a bar a row. Parts that have too many rows get a slider.
import {axis, base, full, kBetter, kHues, kWorse, names, scaleType, short} from '../look.js';

export function bars({tables: [table], names: id, colours, width}) {
  const value = table.rows[0].findIndex((cell, c) => c > 0 && typeof cell === 'number' && table.columns[c] !== 'width bytes per cycle');
  const rows = table.rows;
  const few = 24;
  const positive = rows.map((r) => r[value]).filter((v) => v > 0);
  // Rates of queues span decades; what adds up to a whole has no such scale.
  const log = id === 'queues' && scaleType(positive, 100) === 'log';
  return {
    ...base(colours),
    legend: {show: false},
    grid: {left: 10, right: 70, top: 10, bottom: 40, containLabel: true},
    tooltip: {...base(colours).tooltip, trigger: 'axis', axisPointer: {type: 'shadow'}, valueFormatter: full},
    xAxis: axis(colours, {...(log ? {type: 'log', min: 10 ** Math.floor(Math.log10(Math.min(...positive)))} : {type: 'value'}),
      name: table.columns[value] + (log ? ' (logarithmic)' : ''), nameLocation: 'middle', nameGap: 26,
      splitNumber: width < 600 ? 3 : 6, axisLabel: {formatter: short}}),
    title: rows.length > few ? {text: `${few} of ${rows.length} rows; the slider at the right has the others`, right: 24, bottom: 0,
      textStyle: {color: colours.soft, fontSize: 12, fontWeight: 400}} : undefined,
    yAxis: names(colours, rows.map((r) => r[0]), width),
    dataZoom: rows.length > few
      ? [{type: 'slider', yAxisIndex: 0, startValue: 0, endValue: few - 1, right: 4, width: 14, showDetail: false,
          brushSelect: false}]
      : [],
    series: [{
      type: 'bar', name: table.columns[value], data: rows.map((r) => r[value]), itemStyle: {color: kHues[0]}, barMaxWidth: 26,
      label: {show: true, position: 'right', color: colours.ink, formatter: ({value: v}) => short(v)},
    }],
  };
}

/** Bars with their intervals of confidence: columns gain, low and high. */
export function intervals({tables: [table], colours, width}) {
  const [gain, low, high] = ['gain', 'low', 'high'].map(table.column);
  const rows = table.rows;
  const text = (v) => `${(100 * v).toFixed(1)} %`;
  // A part that costs much when it is better squeezes the others no further than this.
  const most = Math.max(0.01, ...rows.map((r) => Math.max(r[gain], r[high]))), least = Math.max(-0.5 * most, Math.min(0, ...rows.map((r) => r[low])));
  const together = table.column('relaxed together');
  const nameOf = (r) => (r[together] > 1 ? `${r[0]} (of ${r[together]} together)` : r[0]);
  const clamped = (v) => Math.max(least, v);
  return {
    ...base(colours),
    legend: {show: false},
    grid: {left: 10, right: 30, top: 10, bottom: 40, containLabel: true},
    tooltip: {...base(colours).tooltip, trigger: 'axis', axisPointer: {type: 'shadow'},
      formatter: ([p]) => `${p.name}: ${text(rows[p.dataIndex][gain])} (${text(rows[p.dataIndex][low])} to ${text(rows[p.dataIndex][high])})`},
    xAxis: axis(colours, {type: 'value', min: least < 0 ? least : 0, name: 'gain', nameLocation: 'middle', nameGap: 26,
      splitNumber: width < 600 ? 3 : 6, axisLabel: {formatter: (v) => `${Math.round(100 * v)} %`}}),
    yAxis: names(colours, rows.map(nameOf), width),
    series: [
      {type: 'bar', name: 'gain', barMaxWidth: 20, data: rows.map((r) => ({value: clamped(r[gain]),
        itemStyle: {color: r[gain] < 0 ? kWorse : kBetter, opacity: r[together] > 1 ? 0.6 : 1},
        label: {show: r[gain] < least, position: 'insideLeft', color: '#000', backgroundColor: kWorse, padding: [0, 3], formatter: `◀ ${text(r[gain])}`}}))},
      {
        type: 'custom', name: 'interval', silent: true, z: 5, data: rows.map((r, i) => [clamped(r[low]), clamped(r[high]), i]),
        encode: {x: [0, 1], y: 2},
        renderItem: (params, api) => {
          const [x0, y] = api.coord([api.value(0), api.value(2)]);
          const [x1] = api.coord([api.value(1), api.value(2)]);
          const line = (a, b, c, d) => ({type: 'line', shape: {x1: a, y1: b, x2: c, y2: d},
            style: {stroke: colours.ink, lineWidth: 1.5}});
          return {type: 'group', children: [line(x0, y, x1, y), line(x0, y - 4, x0, y + 4), line(x1, y - 4, x1, y + 4)]};
        },
      },
    ],
  };
}
