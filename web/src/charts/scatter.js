// Cost against wrong answers, a dot a row: columns 1 and 2 of the table. Zero stands at the foot of the logarithmic axis.
import {axis, base, full, kHues, short} from '../look.js';

export function scatter({tables: [table], colours, width}) {
  const points = table.rows.map((r, i) => ({name: r[0], value: [r[1], Math.max(0.5, r[2]), r[2]], number: i}));
  return {
    ...base(colours),
    legend: {show: false},
    grid: {left: 20, right: 40, top: 40, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip,
      formatter: ({data: {name, value}}) => `${name}<br>${table.columns[1]} ${full(value[0])}<br>${table.columns[2]} ${full(value[2])}`},
    xAxis: axis(colours, {type: 'value', scale: true, name: table.columns[1], nameLocation: 'middle', nameGap: 28,
      splitNumber: width < 600 ? 3 : 8, axisLabel: {formatter: short}}),
    yAxis: axis(colours, {type: 'log', name: table.columns[2], min: 0.5, axisLabel: {formatter: (v) => (v < 1 ? '0' : short(v))}}),
    series: [{type: 'scatter', data: points, symbolSize: 10, itemStyle: {color: kHues[0], opacity: 0.8},
      label: {show: width > 700, position: 'right', color: colours.ink, fontSize: 11, formatter: '{b}'},
      labelLayout: {hideOverlap: true}}],
  };
}
