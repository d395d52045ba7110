// Quantities over time. A curve is drawn from its pyramid of least and greatest values, anew for each zoom.
import {axis, base, full, kHues, kScale, short} from '../look.js';
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

/** Curves of the rows of the whole machine that have the unit `name`. */
export async function curves({name, colours, width}) {
  const head = await series();
  const rows = head.rows.filter((r) => r.part === 'machine' && r.unit === name);
  const share = name === 'share';
  const data = (row, first, end) => pointsOf(levelsOf(row.values), head.interval, first, end, kPoints);
  return {
    option: {
      ...base(colours),
      grid: {left: 20, right: 30, top: 46, bottom: 84, containLabel: true},
      tooltip: {...base(colours).tooltip, trigger: 'axis',
        valueFormatter: (v) => (Array.isArray(v) ? full(v[1]) : share ? `${(100 * v).toFixed(1)} %` : full(v))},
      xAxis: timeAxis(head, colours, width),
      yAxis: axis(colours, {type: 'value', name, axisLabel: {formatter: share ? (v) => `${Math.round(100 * v)} %` : short}}),
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
        `${rows[y].part}, ${rows[y].quantity}: ${full(v)} ${rows[y].unit}<br>${full(time(x))} to ${full(time(x + 1))} ${head.unit}`},
      xAxis: axis(colours, {type: 'category', data: Array.from({length: columns}, (_, x) => short(time(x))), name: head.unit,
        nameLocation: 'middle', nameGap: 26, axisLabel: {interval: Math.ceil(columns / (width < 600 ? 4 : 10)) - 1}}),
      yAxis: axis(colours, {type: 'category', data: rows.map((r) => r.part), inverse: true, splitLine: {show: false}}),
      visualMap: {min: 0, max: most || 1, dimension: 2, inRange: {color: kScale}, orient: 'horizontal', left: 'center', bottom: 0,
        text: [`${short(most)} ${rows[0].unit}`, '0'], textStyle: {color: colours.ink}, formatter: short},
      series: [{type: 'heatmap', data, progressive: 0}],
    },
  };
}
