// A table of numbers as colours: a column of the chart a row of the table. Each quantity has a scale of its own, from
// nothing to its greatest value, since their units differ.
import {axis, base, full, kScale} from '../look.js';

export function heat({tables: [table], colours, width}) {
  const depth = table.column('depth');
  const shown = table.columns.map((_, c) => c).filter((c) => c !== depth && typeof table.rows[0][c] === 'number' &&
    table.rows.some((r) => r[c] !== 0));
  const label = (r) => (typeof r[0] === 'string' && depth !== 0 ? `${r[0]} ${r[depth]}` : `${r[depth]}`);
  const data = shown.flatMap((c, y) => {
    const most = Math.max(...table.rows.map((r) => Math.abs(r[c])));
    return table.rows.map((r, x) => [x, y, Math.abs(r[c]) / most, r[c]]);
  });
  return {
    ...base(colours),
    grid: {left: 10, right: 20, top: 10, bottom: 70, containLabel: true},
    tooltip: {...base(colours).tooltip,
      formatter: ({value}) => `${table.columns[shown[value[1]]]} at depth ${label(table.rows[value[0]])}: ${full(value[3])}`},
    xAxis: axis(colours, {type: 'category', data: table.rows.map(label), name: 'depth', nameLocation: 'middle', nameGap: 26,
      splitLine: {show: false}}),
    yAxis: axis(colours, {type: 'category', data: shown.map((c) => table.columns[c]), inverse: true, splitLine: {show: false},
      axisLabel: {width: Math.max(90, width * 0.25), overflow: 'truncate', interval: 0}}),
    visualMap: {min: 0, max: 1, dimension: 2, inRange: {color: kScale}, orient: 'horizontal', left: 'center', bottom: 0,
      text: ['most of the row', '0'], textStyle: {color: colours.ink}, formatter: (v) => `${Math.round(100 * v)} %`},
    series: [{type: 'heatmap', data, itemStyle: {borderColor: colours.page, borderWidth: 1}}],
  };
}
