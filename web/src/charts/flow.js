// A flow from left to right: columns from, to and amount.
import {base, full, kHues} from '../look.js';

export function flow({tables: [table], colours, width}) {
  const sum = (rows) => rows.reduce((total, [, , amount]) => total + amount, 0);
  // Rays may cause further ones on their way, so more may leave a place than come to it: shadow rays are such ones.
  const amount = (name) => sum(table.rows.filter(([, to]) => to === name)) ||
    sum(table.rows.filter(([from, to]) => from === name && to !== 'shadow rays'));
  const places = [...new Set(table.rows.flatMap(([from, to]) => [from, to]))];
  return {
    ...base(colours),
    series: [{
      type: 'sankey', left: 8, right: width < 600 ? 110 : 190, top: 12, bottom: 12, nodeGap: 20, draggable: false,
      emphasis: {focus: 'adjacency'},
      label: {color: colours.ink, lineHeight: 15, overflow: 'truncate', width: width < 600 ? 105 : 190, fontSize: width < 600 ? 10 : 12,
        formatter: ({name}) => `${name} ${full(amount(name))}`},
      labelLayout: {moveOverlap: 'shiftY'},
      lineStyle: {color: 'gradient', opacity: 0.4},
      data: places.map((name, i) => ({name, itemStyle: {color: kHues[i % kHues.length]}})),
      links: table.rows.map(([source, target, value]) => ({source, target, value})),
    }],
  };
}
