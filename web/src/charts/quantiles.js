// The part of the packets over the latency that they did not exceed.
import {axis, base, full, kHues, percent, short} from '../look.js';

export function quantiles({tables: [table], colours, width}) {
  const points = table.rows.map(([part, cycles]) => [Math.max(1, cycles), part]);
  return {
    ...base(colours),
    legend: {show: false},
    grid: {left: 20, right: 30, top: 20, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip, trigger: 'axis',
      formatter: ([p]) => `${percent(p.value[1])} of the packets: at most ${full(p.value[0])} cycles`},
    xAxis: axis(colours, {type: 'log', name: 'cycles (logarithmic)', nameLocation: 'middle', nameGap: 28,
      min: 10 ** Math.floor(Math.log10(points[0][0])), splitNumber: width < 600 ? 3 : 8, axisLabel: {formatter: short}}),
    yAxis: axis(colours, {type: 'value', max: 1, axisLabel: {formatter: (v) => `${Math.round(100 * v)} %`}}),
    series: [{type: 'line', name: 'packets', data: points, symbol: 'circle', symbolSize: 7, lineStyle: {width: 2},
      color: kHues[0], areaStyle: {opacity: 0.12}}],
  };
}
