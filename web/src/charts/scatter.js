// Cost against wrong answers, a dot a row: columns 1 and 2 of the table. Zero stands at the foot of the logarithmic axis. A
// line joins the rows that no other betters in one of both without being worse in the other; these have their names.
import {axis, base, full, kHues, numberAxis, short} from '../look.js';
import {front} from '../front.js';

export function scatter({tables: [table], colours, width}) {
  const shown = (wrong) => Math.max(0.5, wrong);
  const points = table.rows.map((r) => ({name: r[0], value: [r[1], shown(r[2]), r[2]]}));
  const best = front(points.map((p) => ({...p, value: [p.value[0], p.value[2]]})), [false, false])
    .map(({name, value}) => ({name, value: [value[0], shown(value[1]), value[1]]}));
  const least = Math.min(...points.map((p) => p.value[0])), most = Math.max(...points.map((p) => p.value[0]));
  const middle = (least + most) / 2;
  // Names to the side where there is room, in lines, below one another where they would meet.
  const named = best.map((p) => ({...p, label: {position: p.value[0] > middle ? 'left' : 'right'}}));
  const words = (name) => (width < 600 ? name.replaceAll(' / ', '\n') : name);
  return {
    ...base(colours),
    legend: {show: true, ...base(colours).legend},
    grid: {left: 20, right: 40, top: 60, bottom: 44, containLabel: true},
    tooltip: {...base(colours).tooltip,
      formatter: ({data: {name, value}}) => `${name}<br>${table.columns[1]} ${full(value[0])}<br>${table.columns[2]} ${full(value[2])}`},
    xAxis: numberAxis(colours, points.map((p) => p.value[0]), {name: table.columns[1], nameLocation: 'middle', nameGap: 28,
      splitNumber: width < 600 ? 3 : 8, axisLabel: {formatter: short}}),
    yAxis: axis(colours, {type: 'log', name: table.columns[2], min: 0.35, nameTextStyle: {color: colours.ink, align: 'left'},
      axisLabel: {showMinLabel: false, formatter: (v) => (v < 1 ? '' : short(v))}}),
    series: [
      {name: 'all levels', type: 'scatter', data: points, symbolSize: 10, itemStyle: {color: kHues[4], opacity: 0.9}},
      {name: 'none is cheaper and better', type: 'line', data: named, symbolSize: 11, itemStyle: {color: kHues[5]},
        lineStyle: {color: kHues[5]}, clip: false,
        label: {show: true, color: colours.ink, fontSize: width < 600 ? 9 : 11, lineHeight: 12, distance: 9, formatter: ({name}) => words(name),
          backgroundColor: colours.page, padding: 1},
        labelLayout: {moveOverlap: 'shiftY'}},
    ],
  };
}
