// A flow from left to right: columns from, to and amount.
import {base, full, kHues} from '../look.js';

export function flow({tables: [table], colours, width}) {
  const places = [...new Set(table.rows.flatMap(([from, to]) => [from, to]))];
  return {
    ...base(colours),
    series: [{
      type: 'sankey', left: 8, right: width < 600 ? 110 : 190, top: 12, bottom: 12, nodeGap: 14, draggable: false,
      emphasis: {focus: 'adjacency'},
      label: {color: colours.ink, lineHeight: 15, overflow: 'break', width: width < 600 ? 100 : 180,
        formatter: ({name, value}) => `${name}\n${full(value)}`},
      lineStyle: {color: 'gradient', opacity: 0.4},
      data: places.map((name, i) => ({name, itemStyle: {color: kHues[i % kHues.length]}})),
      links: table.rows.map(([source, target, value]) => ({source, target, value})),
    }],
  };
}
