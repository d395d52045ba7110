// The machine as it is: every resource and link, coloured by its use; with time series, at any time of the run.
import {base, full, kScale, percent, roundMost, scaleColour} from '../look.js';
import {hasSeries, series} from '../series.js';
import {bends, leastGap} from './layout.js';

const luminance = (rgb) => {
  const [r, g, b] = rgb.match(/[\d.]+/g).map(Number);
  return (0.299 * r + 0.587 * g + 0.114 * b) / 255;
};

export function machine(context) {
  const {tables: [resources, links], colours, facts, width, height} = context;
  const useOf = (table) => table.columns.findIndex((c) => ['busiest unit', 'load', 'use'].includes(c));
  const of = resources ? resources.columns[useOf(resources)] : 'use';
  // A packet process that serves resources has no units, and so no use.
  const resourceUse = resources
    ? resources.rows.map((r) => (typeof r[useOf(resources)] === 'number' ? r[useOf(resources)] : null))
    : new Array(facts.resources).fill(null);  // of traffic: they test nothing
  const from = links ? links.column('from') : 0, to = links ? links.column('to') : 0;
  const ends = links ? links.rows.map((r) => [r[from], r[to]]) : [];
  const linkUse = links ? links.rows.map((r) => r[useOf(links)]) : [];
  const at = facts.places;  // report/html/machine_places.h
  const all = at.length, hubs = all - facts.resources;
  const bent = bends(ends, facts);
  const bus = facts.shape === 'bus';
  const hubName = facts.shape === 'graph' ? 'router' : 'bridge';
  const most = context.most ?? roundMost([...resourceUse, ...linkUse]);
  const now = context.now ?? {resources: resourceUse, links: linkUse};
  const gap = 0.72 * leastGap(at, width - 80, height - 106, !bus);
  const size = Math.max(5, Math.min(ends.length ? 46 : 72, gap));
  const named = size >= 15, valued = size >= 26;
  const node = (i) => {
    const hub = i >= facts.resources;
    const tests = !hub && resourceUse[i] !== null;
    const colour = tests ? scaleColour((now.resources[i] ?? 0) / most) : colours.panel;
    const drawn = facts.drawing?.[i].name;
    const name = drawn ?? (hub ? (bus ? 'bus' : `${hubName} ${i - facts.resources}`) : `resource ${i}`);
    const short = drawn ?? (hub ? (bus ? 'bus' : `${hubName[0].toUpperCase()}${i - facts.resources}`) : `${i}`);
    const ink = !tests ? colours.ink : luminance(colour) > 0.5 ? '#000' : '#fff';
    return {
      id: `${i}`, name, x: at[i][0], y: at[i][1], value: tests ? now.resources[i] : undefined,
      symbol: hub ? (bus ? 'rect' : 'diamond') : resources ? 'roundRect' : 'circle',
      symbolSize: hub && bus ? [width * 0.8, 22] : size,
      itemStyle: {color: colour, borderColor: colours.soft, borderWidth: 1},
      label: {show: named || (hub && bus), color: ink, lineHeight: size < 38 ? 11 : 14,
        fontSize: drawn ? Math.max(7, Math.min(12, Math.floor(1.7 * size / short.length))) : size < 24 ? 9 : size < 38 ? 10 : 12,
        formatter: valued && tests ? `${short}\n${Math.round(100 * (now.resources[i] ?? 0))} %` : short},
    };
  };
  const thick = ends.length > 200 ? 1 : ends.length > 60 ? 2 : 4;
  const data = Array.from({length: all}, (_, i) => node(i));
  const edges = ends.map(([a, b], i) => ({
    source: `${a}`, target: `${b}`, value: now.links[i],
    lineStyle: {color: scaleColour((now.links[i] ?? 0) / most), width: thick, curveness: bent[i],
      opacity: ends.length > 200 ? 0.4 + 0.6 * Math.min(1, (now.links[i] ?? 0) / most) : 1},
  }));
  if (bus) {
    // Each resource meets the bus where it stands, not in the middle of the bus.
    const place = (i) => `tap ${i}`;
    for (let i = 0; i < facts.resources; ++i)
      data.push({id: place(i), name: `bus at resource ${i}`, x: at[i][0], y: 0, symbolSize: 1, label: {show: false}});
    for (const edge of edges) {
      const up = Number(edge.source) < facts.resources;
      const hubEnd = up ? 'target' : 'source';
      edge[hubEnd] = place(up ? edge.source : edge.target);
      edge.lineStyle.curveness = 0.12;
    }
  }
  return {
    ...base(colours),
    legend: {show: false},
    tooltip: {...base(colours).tooltip, formatter: ({dataType, data: d, dataIndex}) => {
      if (dataType === 'edge')
        return `link from ${data[ends[dataIndex][0]].name} to ${data[ends[dataIndex][1]].name}<br>use ${percent(now.links[dataIndex])}` +
          linkDetails(links, dataIndex);
      const i = Number(d.id);
      if (!(i < facts.resources)) return d.name;
      const use = resourceUse[i] === null ? '' : `<br>${of} ${percent(now.resources[i] ?? 0)}`;
      return d.name + use + resourceDetails(resources, i);
    }},
    visualMap: {type: 'continuous', min: 0, max: most, calculable: false, seriesIndex: 9, inRange: {color: kScale},
      orient: 'horizontal', left: 'center', bottom: 0, itemHeight: Math.min(200, width * 0.4),
      text: [percent(most), 'not used'], textStyle: {color: colours.ink}},
    series: [{
      type: 'graph', layout: 'none', left: bus ? '10%' : 40, right: bus ? '10%' : 40, top: 36, bottom: 70,
      edgeSymbol: ['none', ends.length > 200 ? 'none' : 'arrow'], edgeSymbolSize: thick * 2 + 3,
      data, links: edges, roam: false, emphasis: {focus: all > 2 ? 'adjacency' : 'none'}, preserveAspect: !bus,
    }],
  };
}

function details(table, row, shown) {
  if (!table) return '';
  return shown.map((name) => [name, table.column(name)]).filter(([, c]) => c >= 0)
    .map(([name, c]) => `<br>${name} ${full(table.rows[row][c])}`).join('');
}
const resourceDetails = (table, i) =>
  details(table, i, ['rays completed', 'rays tested', 'box tests', 'triangle tests', 'packets issued', 'packets seen']);
const linkDetails = (table, i) => details(table, i, ['packets', 'bytes', 'occupancy mean', 'occupancy max', 'stalled']);

/** The use of every part in each sample, for the slider; null where the series do not have it. */
export async function machineOverTime(facts, linkCount) {
  if (!hasSeries()) return null;
  const head = await series();
  const found = (part, fits) => head.rows.filter((r) => r.part === part && r.unit === 'share' && fits(r.quantity));
  const units = (q) => q.endsWith(' busy') && !q.startsWith('dispatch') && !q.startsWith('ray reads');
  const ofResources = Array.from({length: facts.resources}, (_, i) => found(`resource ${i}`, units));
  const ofLinks = Array.from({length: linkCount}, (_, i) => found(`link ${i}`, (q) => q === 'busy'));
  if (![...ofResources, ...ofLinks].some((rows) => rows.length)) return null;
  const value = (rows, t) => Math.max(0, ...rows.map((r) => r.values[t]));
  let most = 0;
  for (const row of [...ofResources, ...ofLinks].flat()) for (const v of row.values) most = Math.max(most, v);
  return {
    samples: head.samples, interval: head.interval, unit: head.unit, most: roundMost([most]),
    at: (t) => ({resources: ofResources.map((rows) => value(rows, t)), links: ofLinks.map((rows) => value(rows, t))}),
  };
}
