// Stretches of time, a line a stage: the table's columns begin, length, stage and part.
import {axis, base, full, kHues, names, short} from '../look.js';

export function spans({tables: [table], colours, width}) {
  const [begin, length, stage, part] = ['begin', 'length', 'stage', 'part'].map(table.column);
  const stages = [...new Set(table.rows.map((r) => r[stage]))];
  return {
    ...base(colours),
    legend: {show: false},
    grid: {left: 10, right: 30, top: 10, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip,
      formatter: ({value}) => `${stages[value[2]]} ${value[3]}<br>${full(value[0])} to ${full(value[1])}: ${full(value[1] - value[0])}`},
    xAxis: axis(colours, {type: 'value', scale: true, name: 'time of the run', nameLocation: 'middle', nameGap: 26,
      splitNumber: width < 600 ? 3 : 8, axisLabel: {formatter: short}}),
    yAxis: names(colours, stages, width),
    series: [{
      type: 'custom', encode: {x: [0, 1], y: 2},
      data: table.rows.map((r) => [r[begin], r[begin] + r[length], stages.indexOf(r[stage]), r[part]]),
      renderItem: (params, api) => {
        const [x0, y] = api.coord([api.value(0), api.value(2)]);
        const [x1] = api.coord([api.value(1), api.value(2)]);
        const high = Math.min(20, api.size([0, 1])[1] * 0.7);
        return {type: 'rect', shape: {x: x0, y: y - high / 2, width: Math.max(1, x1 - x0), height: high},
          style: {fill: kHues[api.value(2) % kHues.length]}};
      },
    }],
  };
}
