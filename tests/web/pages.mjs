// Opens the program's pages in Chromium, as users do: node pages.mjs PROGRAM SOURCES [all | NAME,...]
// Every kind of page, or with `all` also the pages of a dozen machines; with CAROUSEL_EFFORT below 1 few kinds. On a phone, on a large screen, dark, and without
// scripts: no message on the console, marks in every chart, the JSON's numbers in tables and charts, and no violation that
// axe-core finds. Exit status 1 and a line for each fault.
import {mkdtemp, readFile, rm, stat} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {dirname, join, resolve} from 'node:path';

import {chromiumOf} from './chromium.mjs';
import {all, pages, shortly} from './machines.mjs';
import {wrongCharts, wrongTables} from './numbers.mjs';
import {make, playsRanks} from './program.mjs';
import {wrongStudy} from './study_numbers.mjs';

const [program, sources] = process.argv.slice(2, 4).map((path) => resolve(path)), wanted = process.argv[4];
const {axe, launch} = await chromiumOf(sources);

const folder = await mkdtemp(join(tmpdir(), 'carousel-pages-'));
const faults = [];
const fault = (page, text) => faults.push(`${page}: ${text}`);

/** What is shown: tables by id, and the data of charts by figure, with the number of their marks. */
function shown() {
  const tables = {};
  for (const table of document.querySelectorAll('table[id]'))
    tables[table.id.replace('table-', '')] = {
      columns: [...table.tHead.rows[0].cells].map((c) => c.firstChild.textContent.trim()),
      rows: [...table.tBodies[0].rows].map((r) => [...r.cells].map((c) => (c.dataset.v === undefined ? c.textContent : Number(c.dataset.v)))),
    };
  const cut = [...document.querySelectorAll('.plot svg text')].filter((text) => {
    if (text.closest('[clip-path]')) return false;  // of a legend with pages
    const own = text.getBoundingClientRect(), plot = text.closest('.plot').getBoundingClientRect();
    return own.width > 0 && (own.left < plot.left - 3 || own.right > plot.right + 3 || own.bottom > plot.bottom + 3);
  }).map((text) => text.textContent);
  return {tables, cut, wide: document.documentElement.scrollWidth - innerWidth};
}

async function drawn() {
  const charts = {};
  let all;
  do {  // a change of size or colours draws them anew, also meanwhile
    all = await window.carouselCharts();
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  } while (Object.values(all).some((chart) => chart?.isDisposed()));
  for (const [id, chart] of Object.entries(all)) {
    if (!chart) continue;
    const canvas = chart.getDom().querySelector('canvas');
    let marks = chart.getDom().querySelectorAll('svg path, svg polyline, svg rect').length;
    if (canvas) {
      const pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
      const colours = new Set();
      for (let i = 0; i < pixels.length && colours.size < 64; i += 4)
        if (pixels[i + 3]) colours.add((pixels[i] << 16) | (pixels[i + 1] << 8) | pixels[i + 2]);
      marks = colours.size;
    }
    const series = chart.getOption().series;
    charts[id] = {
      marks, items: series.reduce((sum, s) => sum + (s.data?.length ?? 0), 0),
      names: series.map((s) => s.name),
      series: series.map((s) => (s.data ?? []).map((d) => d?.value ?? d)),
      links: (series[0].links ?? []).map((l) => l.value),
      flow: (series[0].links ?? []).map((l) => ({from: l.source, to: l.target, rays: l.value})), nodes: (series[0].data ?? []).map((d) => d?.value ?? null),
    };
  }
  return {charts, figures: document.querySelectorAll('figure[data-chart]:not([hidden])').length};
}

const open = (browser, file, options) => browser.newContext(options).then(async (context) => {
  const page = await context.newPage();
  const told = [];
  page.on('console', (m) => told.push(`${m.type()}: ${m.text()}`));
  page.on('pageerror', (e) => told.push(`error: ${e.message}`));
  await page.goto(`file://${file}`);
  return {page, told, close: () => context.close()};
});

/** Charts, tables and width as they are now. */
async function check(where, page, command, json) {
  const {charts, figures} = await page.evaluate(drawn);
  const {tables, cut, wide} = await page.evaluate(shown);
  if (Object.keys(charts).length !== figures) fault(where, `${figures} figures and ${Object.keys(charts).length} charts`);
  if (figures === 0) fault(where, 'no charts');
  for (const [id, {marks, items}] of Object.entries(charts)) if (marks < 3 || items === 0) fault(where, `${id} has no marks`);
  for (const id of all[where.split(',')[0]].drawn ?? []) if (!charts[id]) fault(where, `${id} is not drawn`);
  if (cut.length) fault(where, `cut at the edge of a chart: ${cut.slice(0, 4).join('; ')}`);
  if (wide > 0) fault(where, `the page is ${wide} pixels wider than the window`);
  const wrong = command === 'run' ? [...wrongTables(tables, json), ...wrongCharts(charts, json)]
    : wrongStudy(command, {tables, charts}, json);
  for (const text of wrong) fault(where, text);
}

async function judge(where, page, rules) {
  const {violations} = await page.evaluate((only) => window.axe.run(document,
    {resultTypes: ['violations'], ...(only ? {runOnly: only} : {})}), rules);
  for (const v of violations) fault(where, `axe-core: ${v.id}: ${v.help}: ${v.nodes[0].target} ${v.nodes[0].failureSummary}`);
}

/** The map of the pixels: a click, and a typed place, tell the numbers of that pixel, which heat.csv has. */
async function tryHeatMap(where, page, file) {
  const rows = (await readFile(join(dirname(file), 'heat.csv'), 'utf8')).trim().split('\n').slice(1).map((row) => row.split(',').map(Number));
  const told = () => page.innerText('#heat-map [role=status]');
  const expectPixel = async (how, [x, y, rays, cycles, tests]) => {
    const text = await told();
    for (const needed of [`Pixel ${x}, ${y}: ${cycles.toLocaleString('en')} cycles of ${rays} `, ` ${tests.toLocaleString('en')} test${tests === 1 ? ',' : 's'}`, `--pixel ${x},${y}`])
      if (!text.includes(needed)) fault(where, `${how} the map lacks "${needed}": ${text}`);
  };
  await expectPixel('at first', rows.reduce((a, b) => (b[3] > a[3] ? b : a)));
  const [width, height] = [rows.at(-1)[0] + 1, rows.at(-1)[1] + 1], [x, y] = [Math.floor(width / 3), height - 1];
  const box = await page.locator('#heat-map canvas').first().boundingBox();
  await page.locator('#heat-map canvas').first().click({position: {x: ((x + 0.5) * box.width) / width, y: ((y + 0.5) * box.height) / height}});
  await expectPixel('after a click', rows[y * width + x]);
  await page.fill('#heat-map label:has-text("Column") input', '0');
  await expectPixel('after a column', rows[y * width]);
  // Another quantity and scale: the brightest pixel is that with most of it.
  await page.selectOption('#heat-map select >> nth=0', 'tests');
  await page.selectOption('#heat-map select >> nth=1', 'linear');
  const brightest = await page.evaluate(() => {
    const map = document.querySelector('#heat-map canvas'), {data} = map.getContext('2d').getImageData(0, 0, map.width, map.height);
    let best = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i] + data[i + 1] + data[i + 2] > data[best] + data[best + 1] + data[best + 2]) best = i;
    return best / 4;
  });
  if (rows[brightest][4] !== Math.max(...rows.map((row) => row[4]))) fault(where, `the brightest pixel of tests is ${rows[brightest].slice(0, 2)}`);
  const scale = await page.innerText('#heat-map .ticks');
  if (!scale.includes('tests')) fault(where, `the scale has no unit: ${scale}`);
}

// A page is loaded once with scripts and once without. Charts are drawn anew when the window or the colours change.
async function look(browser, name, command, {page: file, json}) {
  const bytes = (await stat(file)).size;
  if (bytes > 3e6) fault(name, `${bytes} bytes, more than 3 MB`);
  const {page, told, close} = await open(browser, file, {viewport: {width: 400, height: 800}});
  await check(`${name}, 400 pixels`, page, command, json);
  await page.evaluate(axe);
  await judge(`${name}, 400 pixels`, page);
  const before = await page.evaluate(() => document.querySelector('.plot').clientWidth);
  await page.emulateMedia({colorScheme: 'dark'});
  await page.setViewportSize({width: 1600, height: 1000});
  // Not by waitForFunction, which evaluates a text: the policy of the page forbids that.
  const grown = (width) => [...document.querySelectorAll('.plot')].every((plot) => !plot.clientWidth ||
    (plot.clientWidth > width && plot.firstElementChild?.clientWidth === plot.clientWidth));
  for (const end = Date.now() + 30000; !(await page.evaluate(grown, before));) {
    if (Date.now() > end) throw new Error(`${name}: the charts do not grow with the window`);
    await new Promise((done) => setTimeout(done, 50));
  }
  await check(`${name}, 1600 pixels, dark`, page, command, json);
  if (json.heat) await tryHeatMap(`${name}, 1600 pixels`, page, file);
  await judge(`${name}, dark`, page, ['color-contrast', 'link-in-text-block']);  // the others are the same
  for (const text of told) fault(name, `console: ${text}`);
  await close();

  const plain = await open(browser, file, {javaScriptEnabled: false, viewport: {width: 400, height: 800}});
  const where = `${name}, no scripts`;
  const text = await plain.page.locator('main').innerText();
  for (const needed of command === 'run' ? [json.digest.hits, 'The machine'] : ['At a glance'])
    if (needed && !text.includes(needed)) fault(where, `lacks ${needed}`);
  const wide = await plain.page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  if (wide > 0) fault(where, `the page is ${wide} pixels wider than the window`);
  if (await plain.page.locator('.plot:visible').count()) fault(where, 'shows empty charts');
  for (const line of plain.told) fault(where, `console: ${line}`);
  await plain.close();
}

try {
  const few = Number(process.env.CAROUSEL_EFFORT ?? 1) < 1;  // script/test; script/soak opens all
  const list = wanted === 'all' ? all : few && !wanted ? Object.fromEntries(shortly.map((n) => [n, all[n]])) : wanted ? Object.fromEntries(wanted.split(',').map((n) => [n, all[n]])) : pages;
  const browser = await launch();
  if (Object.values(list).some((page) => page.ranks) && !(await playsRanks(program, sources))) {
    console.log('no page of ranks: the program was built without MPI, or mpirun starts no processes');
    for (const [name, page] of Object.entries(list)) if (page.ranks) delete list[name];
  }
  let looked = Promise.resolve();  // at a page, while the next one is made
  for (const [name, page] of Object.entries(list)) {
    const [, made] = await Promise.allSettled([looked, make(program, sources, folder, name, page)]);
    await looked;
    if (made.reason) fault(name, made.reason.message);
    looked = made.reason ? Promise.resolve() : look(browser, name, page.command, made.value);
  }
  await looked;
  await browser.close();
  console.log(faults.length ? faults.join('\n') : `${Object.keys(list).length} pages are sound`);
} finally {
  await rm(folder, {recursive: true});
}
process.exit(faults.length ? 1 : 0);
