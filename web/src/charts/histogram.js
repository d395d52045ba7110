// Columns from left to right: a class a row, its count in the second column.
import {axis, base, full, kHues, short} from '../look.js';

export function histogram({tables: [table], colours, width}) {
  return {
    ...base(colours),
    legend: {show: false},
    grid: {left: 10, right: 20, top: 20, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip, trigger: 'axis', axisPointer: {type: 'shadow'}, valueFormatter: full},
    xAxis: axis(colours, {type: 'category', data: table.rows.map((r) => r[0]), name: table.columns[0], nameLocation: 'middle',
      nameGap: 28, splitLine: {show: false}, axisLabel: {interval: width < 700 ? 'auto' : 0, formatter: (name) => short(Number(name.split(' ')[0].replaceAll(',', '')))}}),
    yAxis: axis(colours, {type: 'value', axisLabel: {formatter: short}}),
    series: [{type: 'bar', name: table.columns[1], data: table.rows.map((r) => r[1]), itemStyle: {color: kHues[0]},
      barCategoryGap: '8%'}],
  };
}
