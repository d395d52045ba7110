// Quantities over time. A curve is drawn from its pyramid of least and greatest values, anew for each zoom.
import {axis, base, full, kHues, kScale, legendLines, percent, prefixOf, short} from '../look.js';
import {pointsOf, pyramid, series} from '../series.js';

const kPoints = 1200;
const pyramids = new WeakMap();

function levelsOf(values) {
  if (!pyramids.has(values)) pyramids.set(values, pyramid(values));
  return pyramids.get(values);
}

function timeAxis(head, colours, width) {
  return axis(colours, {type: 'value', min: 0, max: head.samples * head.interval, name: head.unit, nameLocation: 'middle',
    nameGap: 26, splitNumber: width < 600 ? 3 : 8, splitLine: {show: false}, axisLabel: {formatter: short}});
}

/** As the legend has it, where the title says of what the curves are. */
const curveName = (name) => name.replace(/^energy of /, '').replace(/^(dram|l1|l2)\b/, (part) => part.toUpperCase());

/** Curves of the rows of the whole machine that have the unit `name`. */
export async function curves({name, colours, width, height}) {
  const head = await series();
  const rows = head.rows.filter((r) => r.part === 'machine' && r.unit === name);
  const share = name === 'share';
  const greatest = rows.map(({values}) => values.reduce((most, v) => Math.max(most, v), 0));
  // Joules of a stretch of time are small: they have a unit of their own.
  const [factor, prefix] = name === 'J' ? prefixOf(Math.max(...greatest)) : [1, ''];
  // Of many curves the greatest are drawn, and the others wait in the legend.
  const kFirst = 8, least = [...greatest].sort((a, b) => b - a)[kFirst - 1] ?? 0;
  const lines = legendLines(rows.map((r) => curveName(r.quantity)), width), paged = 22 * lines > 0.3 * height;
  const data = (row, first, end) => pointsOf(levelsOf(row.values), head.interval, first, end, kPoints);
  return {
    option: {
      ...base(colours),
      legend: {...base(colours).legend, formatter: curveName, ...(paged ? {} : {type: 'plain', itemGap: 8}),
        selected: Object.fromEntries(rows.map((r, i) => [r.quantity, greatest[i] >= least]))},
      grid: {left: 20, right: 30, top: 24 + 22 * (paged ? 1 : lines), bottom: 84, containLabel: true},
      tooltip: {...base(colours).tooltip, trigger: 'axis',
        valueFormatter: (v) => (Array.isArray(v) ? full(v[1]) : share ? `${(100 * v).toFixed(1)} %` : prefix ? `${full(v / factor)} ${prefix}${name}` : full(v))},
      xAxis: timeAxis(head, colours, width),
      yAxis: axis(colours, {type: 'value', name: prefix + name,
        axisLabel: {formatter: share ? (v) => `${Math.round(100 * v)} %` : (v) => short(v / factor)}}),
      dataZoom: [{type: 'inside', filterMode: 'none', zoomOnMouseWheel: 'ctrl'},
        {type: 'slider', filterMode: 'none', bottom: 8, height: 22, showDataShadow: false, brushSelect: false,
          textStyle: {color: colours.ink}, labelFormatter: short}],
      series: rows.map((row, i) => ({
        type: 'line', name: row.quantity, data: data(row, 0, head.samples), showSymbol: head.samples < 2, animation: false,
        color: kHues[i % kHues.length],
        lineStyle: {width: 1.5, type: i < kHues.length ? 'solid' : 'dashed'},
      })),
    },
    connect(chart) {
      chart.on('datazoom', () => {
        const {startValue, endValue} = chart.getOption().dataZoom[0];
        const first = Math.max(0, Math.floor(startValue / head.interval));
        const end = Math.min(head.samples, Math.ceil(endValue / head.interval) + 1);
        chart.setOption({series: rows.map((row) => ({data: data(row, first, end)}))});
      });
    },
  };
}

const kAcross = 400;

/** A quantity of all resources or all links: a line a part, a column a stretch of time. */
export async function parts({colours, width, quantity}) {
  const head = await series();
  const each = head.rows.filter((r) => r.part !== 'machine');
  const kinds = [...new Set(each.map((r) => `${r.part.split(' ')[0]}: ${r.quantity}`))];
  if (!kinds.length) return null;
  const chosen = kinds.includes(quantity) ? quantity : kinds.find((k) => k.endsWith('box busy')) ?? kinds[0];
  const rows = each.filter((r) => `${r.part.split(' ')[0]}: ${r.quantity}` === chosen);
  const together = Math.max(1, Math.ceil(head.samples / Math.min(kAcross, Math.max(40, width / 3))));
  const columns = Math.ceil(head.samples / together);
  const data = [];
  let most = 0;
  rows.forEach((row, y) => {
    for (let x = 0; x < columns; ++x) {
      let sum = 0;
      const end = Math.min(head.samples, (x + 1) * together);
      for (let i = x * together; i < end; ++i) sum += row.values[i];
      const mean = sum / (end - x * together);
      most = Math.max(most, mean);
      data.push([x, y, mean]);
    }
  });
  const time = (x) => x * together * head.interval;
  return {
    kinds, chosen,
    option: {
      ...base(colours),
      grid: {left: 10, right: 20, top: 10, bottom: 84, containLabel: true},
      tooltip: {...base(colours).tooltip, formatter: ({value: [x, y, v]}) =>
        `${rows[y].part}, ${rows[y].quantity}: ${rows[y].unit === 'share' ? percent(v) : `${full(v)} ${rows[y].unit}`}<br>${full(time(x))} to ${full(time(x + 1))} ${head.unit}`},
      xAxis: axis(colours, {type: 'category', data: Array.from({length: columns}, (_, x) => short(time(x))), name: head.unit,
        nameLocation: 'middle', nameGap: 26, axisLabel: {interval: Math.ceil(columns / (width < 600 ? 4 : 10)) - 1}}),
      yAxis: axis(colours, {type: 'category', data: rows.map((r) => r.part), inverse: true, splitLine: {show: false}}),
      visualMap: {min: 0, max: most || 1, dimension: 2, inRange: {color: kScale}, orient: 'horizontal', left: 'center', bottom: 0,
        text: [rows[0].unit === 'share' ? percent(most) : `${short(most)} ${rows[0].unit}`, '0'], textStyle: {color: colours.ink}, formatter: short},
      series: [{type: 'heatmap', data, progressive: 0}],
    },
  };
}
