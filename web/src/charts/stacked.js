// Bars of pieces, a bar a row, a piece a column: shares that add up to 100 %, or amounts.
import {axis, base, kHues, legendLines, names, percent, short} from '../look.js';

/** `most`: the end of the axis; without it, that of the longest bar. `text`: of a value. */
function pieces({table, used, colours, width, height, most, text, unit}) {
  const rows = table.rows;
  const few = 32;
  const longest = most ?? Math.max(...rows.map((r) => used.reduce((sum, c) => sum + r[c], 0)));
  const idle = colours.line;
  const lines = legendLines(used.map((c) => table.columns[c]), width);
  const paged = 22 * lines > 0.5 * height;
  const dark = new Set([0, 8, 11]);  // colours on which white is read better
  return {
    ...base(colours),
    // All causes at once where there is room; a legend of many lines has pages.
    legend: {...base(colours).legend, ...(paged ? {} : {type: 'plain', itemGap: 8})},
    grid: {left: 10, right: rows.length > few ? 40 : 24, top: paged ? 36 : 14 + 22 * lines, bottom: unit ? 32 : 10, containLabel: true},
    tooltip: {...base(colours).tooltip, trigger: 'axis', axisPointer: {type: 'shadow'}, valueFormatter: text},
    xAxis: axis(colours, {type: 'value', ...(most ? {max: most} : {}), splitNumber: width < 600 ? 2 : 5,
      ...(unit ? {name: unit, nameLocation: 'middle', nameGap: 26} : {}),
      axisLabel: {formatter: most ? (v) => `${Math.round(100 * v)} %` : short}}),
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
          formatter: ({value}) => ((value / longest) * width * 0.6 > 44 ? text(value) : '')},
      };
    }),
  };
}

export function stacked({tables: [table], ...context}) {
  const used = table.columns.map((_, c) => c).filter((c) => c > 0 && table.rows.some((r) => r[c] > 0));
  return pieces({table, used, most: 1, text: percent, ...context});
}

/** Amounts: the first columns are the row's name, a count, and the sum of all pieces. The smallest pieces are added up where
 * there are more than hues. */
export function amounts({tables: [{columns, rows}], ...context}) {
  const first = 3, total = (c) => rows.reduce((sum, r) => sum + r[c], 0);
  const order = columns.map((_, c) => c).slice(first).filter((c) => total(c) > 0).sort((a, b) => total(b) - total(a));
  const kept = order.slice(0, kHues.length - 1), rest = order.slice(kHues.length - 1);
  const table = {columns: [columns[0], ...kept.map((c) => columns[c]), ...(rest.length ? ['all others'] : [])],
    rows: rows.map((r) => [r[0], ...kept.map((c) => r[c]), ...(rest.length ? [rest.reduce((sum, c) => sum + r[c], 0)] : [])])};
  return pieces({table, used: table.columns.map((_, c) => c).slice(1), text: short, unit: 'cycles a ray', ...context});
}
