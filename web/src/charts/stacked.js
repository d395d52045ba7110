// Shares that add up to 100 %: a bar a row, a piece a column.
import {axis, base, kHues, names, percent} from '../look.js';

export function stacked({tables: [table], colours, width, height}) {
  const rows = table.rows;
  const used = table.columns.map((_, c) => c).filter((c) => c > 0 && rows.some((r) => r[c] > 0));
  const few = 32;
  const idle = colours.line;
  // Lines of the legend, from names of some 7 pixels a letter.
  const lines = used.map((c) => 42 + 7 * table.columns[c].length).reduce(([full, at], wide) => (at + wide > width - 10 ? [full + 1, wide] : [full, at + wide]), [1, 0])[0];
  const paged = 22 * lines > 0.5 * height;
  const dark = new Set([0, 8, 11]);  // colours on which white is read better
  return {
    ...base(colours),
    // All causes at once where there is room; a legend of many lines has pages.
    legend: {...base(colours).legend, ...(paged ? {} : {type: 'plain', itemGap: 8})},
    grid: {left: 10, right: rows.length > few ? 40 : 24, top: paged ? 36 : 14 + 22 * lines, bottom: 10, containLabel: true},
    tooltip: {...base(colours).tooltip, trigger: 'axis', axisPointer: {type: 'shadow'}, valueFormatter: percent},
    xAxis: axis(colours, {type: 'value', max: 1, splitNumber: width < 600 ? 2 : 5,
      axisLabel: {formatter: (v) => `${Math.round(100 * v)} %`}}),
    yAxis: names(colours, rows.map((r) => r[0]), width),
    dataZoom: rows.length > few
      ? [{type: 'slider', yAxisIndex: 0, startValue: 0, endValue: few - 1, right: 4, width: 14, showDetail: false,
          brushSelect: false}]
      : [],
    series: used.map((c, i) => {
      const nothing = table.columns[c] === 'nothing to do';
      return {
        type: 'bar', name: table.columns[c], stack: 'cycles', barMaxWidth: 22, data: rows.map((r) => r[c]),
        itemStyle: {color: nothing ? idle : kHues[i % kHues.length], borderColor: colours.page, borderWidth: 1},
        label: {show: true, color: nothing ? colours.ink : dark.has(i) ? '#fff' : '#000', fontSize: 11,
          formatter: ({value}) => (value * width * 0.6 > 44 ? percent(value) : '')},
      };
    }),
  };
}
