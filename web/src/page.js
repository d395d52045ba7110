// What makes a page lively: its charts, which are drawn when they scroll into view, and the choice of light or dark.
import {BarChart, CustomChart, GraphChart, HeatmapChart, LineChart, SankeyChart, ScatterChart} from 'echarts/charts';
import {DataZoomComponent, GridComponent, LegendComponent, TitleComponent, TooltipComponent, VisualMapComponent} from 'echarts/components';
import * as echarts from 'echarts/core';
import {LabelLayout} from 'echarts/features';
import {CanvasRenderer, SVGRenderer} from 'echarts/renderers';

import {bars, intervals} from './charts/bars.js';
import {flow} from './charts/flow.js';
import {groups, ratios, shares} from './charts/groups.js';
import {heat} from './charts/heat.js';
import {histogram} from './charts/histogram.js';
import {machine, machineOverTime} from './charts/machine.js';
import {curves, parts} from './charts/over_time.js';
import {quantiles} from './charts/quantiles.js';
import {scatter} from './charts/scatter.js';
import {spans} from './charts/spans.js';
import {amounts, stacked} from './charts/stacked.js';
import {sweepEffects, sweepPareto, sweepPlot} from './charts/sweep.js';
import {between} from './between.js';
import {heatMap} from './heat_map.js';
import {look} from './look.js';
import {sweepTable} from './sweep_table.js';
import {readTable} from './table.js';

echarts.use([BarChart, CustomChart, GraphChart, HeatmapChart, LineChart, SankeyChart, ScatterChart, DataZoomComponent, GridComponent,
  LegendComponent, TitleComponent, TooltipComponent, VisualMapComponent, LabelLayout, CanvasRenderer, SVGRenderer]);

// A kind of chart: a function of its context that gives the option of ECharts, or {option, connect}, at once or later.
const kinds = {
  amounts, bars, intervals, stacked, quantiles, flow, groups, shares, ratios, heat, histogram, machine, scatter, spans,
  series: (context) => curves({...context, name: context.names}),
  parts_over_time: parts,
  sweep_plot: sweepPlot, sweep_pareto: sweepPareto, sweep_effects: sweepEffects,
};
const onCanvas = new Set(['series', 'parts_over_time']);  // many marks

const facts = JSON.parse(document.getElementById('facts').textContent);
const drawn = new Map();  // by figure: its chart and its settings

/** A row of controls above a plot. */
function controlRow(figure, plot) {
  const row = document.createElement('div');
  row.className = 'control';
  figure.insertBefore(row, plot);
  return row;
}

async function draw(figure) {
  const plot = figure.querySelector('.plot');
  let state = drawn.get(figure);
  if (!state) {
    state = {settings: {}};
    drawn.set(figure, state);
  }
  const names = figure.dataset.tables;
  const kind = figure.dataset.chart;
  const context = {tables: names.split(' ').map(readTable), names, facts, colours: look(), width: plot.clientWidth,
    height: plot.clientHeight, ...state.settings};
  const result = await kinds[kind](context);
  if (!result) {
    figure.hidden = true;
    return;
  }
  const {option, connect} = result.option ? result : {option: result};
  state.chart?.dispose();
  state.chart = echarts.init(plot, null, {renderer: onCanvas.has(kind) ? 'canvas' : 'svg'});
  state.chart.setOption(option);
  connect?.(state.chart);
  state.width = plot.clientWidth;
  plot.dataset.drawn = kind;
  if (!state.controls) {
    state.controls = true;
    result.choose?.(controlRow(figure, plot), state.settings, () => draw(figure));
    if (result.kinds) chooser(figure, plot, state, result);
    if (kind === 'machine') slider(figure, plot, state, context);
  }
}

/** The choice of the quantity that is shown over time. */
function chooser(figure, plot, state, {kinds: list, chosen}) {
  const label = document.createElement('label');
  const select = document.createElement('select');
  label.append('Quantity ', select);
  for (const kind of list) select.add(new Option(kind, kind, false, kind === chosen));
  controlRow(figure, plot).append(label);
  select.addEventListener('change', () => {
    state.settings.quantity = select.value;
    draw(figure);
  });
}

/** The time that the machine is shown at; at the left end, the mean of the whole run. */
async function slider(figure, plot, state, {tables: [, links]}) {
  const run = await machineOverTime(facts, links?.rows.length ?? 0);
  if (!run) return;
  // One scale for the whole run and for each of its moments, so that a colour means one share.
  state.settings.most = run.most;
  draw(figure);
  const label = document.createElement('label');
  const input = document.createElement('input');
  const output = document.createElement('output');
  Object.assign(input, {type: 'range', min: -1, max: run.samples - 1, value: -1, step: 1});
  input.id = `${figure.id}-time`;
  label.htmlFor = output.htmlFor = input.id;
  label.textContent = 'Time';
  const told = () => {
    const t = Number(input.value);
    const text = t < 0 ? 'the whole run' : `${run.unit} ${(t * run.interval).toLocaleString('en')} to ${((t + 1) * run.interval).toLocaleString('en')}`;
    output.textContent = text;
    input.setAttribute('aria-valuetext', text);
  };
  told();
  controlRow(figure, plot).append(label, input, output);
  let waiting = false;
  input.addEventListener('input', () => {
    told();
    const t = Number(input.value);
    state.settings.now = t < 0 ? undefined : run.at(t);
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => {
      waiting = false;
      draw(figure);
    });
  });
}

const theme = matchMedia('(prefers-color-scheme: dark)');
const isDark = () => (document.documentElement.dataset.theme ?? (theme.matches ? 'dark' : 'light')) === 'dark';
const drawAgain = () => { for (const figure of drawn.keys()) draw(figure); };

function themeButton() {
  const button = document.createElement('button');
  button.id = 'theme';
  button.type = 'button';
  const name = () => { button.textContent = isDark() ? 'Light colours' : 'Dark colours'; };
  name();
  button.addEventListener('click', () => {
    document.documentElement.dataset.theme = isDark() ? 'light' : 'dark';
    name();
    drawAgain();
  });
  theme.addEventListener('change', () => { name(); drawAgain(); });
  document.querySelector('header').prepend(button);
}

/** Shows the sections of one tab; with `all` those of every tab, for paper. Without scripts nothing is hidden. */
function tabs() {
  const links = [...document.querySelectorAll('nav a[data-tab]')];
  if (!links.length) return () => {};
  const sections = [...document.querySelectorAll('section[data-tab]')];
  const show = (tab) => {
    document.documentElement.dataset.tab = tab;
    for (const section of sections) section.classList.toggle('on', tab === 'all' || section.dataset.tab === tab);
    for (const link of links) {
      if (link.dataset.tab === tab) link.setAttribute('aria-current', 'true');
      else link.removeAttribute('aria-current');
    }
  };
  /** The tab of the element that the address names, so that links into a page work. */
  const follow = () => {
    const named = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    const tab = named?.closest('section[data-tab]')?.dataset.tab;
    if (tab) show(tab);
    return tab;
  };
  addEventListener('hashchange', () => { if (follow()) document.getElementById(location.hash.slice(1))?.scrollIntoView(); });
  if (!follow()) show(links[0].dataset.tab);
  return show;
}

document.documentElement.dataset.charts = '';
const showTab = tabs();
themeButton();
sweepTable(facts);
between(facts);
const drawHeatMap = heatMap();
const figures = document.querySelectorAll('figure[data-chart]');
const seen = new IntersectionObserver((entries) => {
  for (const {isIntersecting, target} of entries) {
    if (!isIntersecting) continue;
    seen.unobserve(target);
    draw(target);
  }
}, {rootMargin: '300px'});
for (const figure of figures) seen.observe(figure);

let resizing = 0;
addEventListener('resize', () => {
  clearTimeout(resizing);
  resizing = setTimeout(() => {
    for (const [figure, state] of drawn)
      if (figure.querySelector('.plot').clientWidth && figure.querySelector('.plot').clientWidth !== state.width) draw(figure);
  }, 150);
});
// Before printing, all charts are needed.
addEventListener('beforeprint', () => {
  const before = document.documentElement.dataset.tab;
  const closed = [...document.querySelectorAll('details:not([open])')];
  showTab('all');
  for (const details of closed) details.open = true;
  drawHeatMap();
  figures.forEach((figure) => { if (!drawn.has(figure)) draw(figure); });
  addEventListener('afterprint', () => {
    for (const details of closed) details.open = false;
    if (before) showTab(before);
  }, {once: true});
});

/** For tests: opens all tabs, draws all charts, and gives them by the ids of their figures. */
window.carouselCharts = async () => {
  showTab('all');
  for (const figure of figures) if (!drawn.get(figure)?.chart) await draw(figure);
  await drawHeatMap();
  return Object.fromEntries([...drawn].map(([figure, {chart}]) => [figure.id, chart]));
};
