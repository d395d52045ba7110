// Opens the pages of a dozen machines in Chromium, as users do: node pages.mjs PROGRAM SOURCES
// On a phone, on a large screen, dark, and without scripts: no message on the console, marks in every chart, the numbers of
// report.json in tables and charts, and no violation that axe-core finds. Exit status 1 and a line for each fault.
import {execFile} from 'node:child_process';
import {existsSync} from 'node:fs';
import {mkdtemp, readFile, rm, stat} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {promisify} from 'node:util';

import {machines} from './machines.mjs';
import {wrongCharts, wrongTables} from './numbers.mjs';

const [program, sources] = process.argv.slice(2);
const require = createRequire(join(sources, 'web/package.json'));
const browser_path = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
const skip = (why) => { console.log(`skipped: ${why}; script/bootstrap all installs it`); process.exit(77); };
if (!browser_path) skip('chromium is not installed');
if (!existsSync(join(sources, 'web/node_modules/playwright-core'))) skip('web/node_modules is missing');
const {chromium} = require('playwright-core');
const axe = await readFile(require.resolve('axe-core/axe.min.js'), 'utf8');
const only = process.argv[4]?.split(',');

const inDark = new Set(['ring', 'verdict', 'bundles', 'native', 'traffic']);  // one of each kind of page

const folder = await mkdtemp(join(tmpdir(), 'carousel-pages-'));
const faults = [];
const fault = (page, text) => faults.push(`${page}: ${text}`);

async function simulate(name) {
  const {config, sets} = machines[name];
  await promisify(execFile)(program, ['run', join(sources, `configs/${config}.yaml`), ...sets.flatMap((s) => ['--set', s]),
    '--quiet', '--out', join(folder, name)]);
}

/** What is shown: tables by id, and the data of charts by figure, with the number of their marks. */
function shown() {
  const tables = {};
  for (const table of document.querySelectorAll('table[id]'))
    tables[table.id.replace('table-', '')] = {
      columns: [...table.tHead.rows[0].cells].map((c) => c.firstChild.textContent.trim()),
      rows: [...table.tBodies[0].rows].map((r) => [...r.cells].map((c) => (c.dataset.v === undefined ? c.textContent : Number(c.dataset.v)))),
    };
  return {tables, wide: document.documentElement.scrollWidth - innerWidth};
}

async function drawn() {
  const charts = {};
  const all = await window.carouselCharts();
  await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
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
      links: (series[0].links ?? []).map((l) => l.value), nodes: (series[0].data ?? []).map((d) => d?.value ?? null),
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

async function look(browser, name) {
  const file = join(folder, name, 'report.html');
  const report = JSON.parse(await readFile(join(folder, name, 'report.json'), 'utf8'));
  const bytes = (await stat(file)).size;
  if (bytes > 3e6) fault(name, `${bytes} bytes, more than 3 MB`);
  for (const view of [
    {at: '400 pixels', options: {viewport: {width: 400, height: 800}}},
    {at: '1600 pixels', options: {viewport: {width: 1600, height: 1000}}},
    {at: 'dark', options: {viewport: {width: 1000, height: 800}, colorScheme: 'dark'}},
  ]) {
    if (view.at === 'dark' && !inDark.has(name)) continue;
    const where = `${name}, ${view.at}`;
    const {page, told, close} = await open(browser, file, view.options);
    const {charts, figures} = await page.evaluate(drawn);
    const {tables, wide} = await page.evaluate(shown);
    if (Object.keys(charts).length !== figures) fault(where, `${figures} figures and ${Object.keys(charts).length} charts`);
    if (figures === 0) fault(where, 'no charts');
    for (const [id, {marks, items}] of Object.entries(charts)) if (marks < 3 || items === 0) fault(where, `${id} has no marks`);
    if (wide > 0) fault(where, `the page is ${wide} pixels wider than the window`);
    for (const text of [...wrongTables(tables, report), ...wrongCharts(charts, report)]) fault(where, text);
    if (view.at !== '1600 pixels') {
      await page.evaluate(axe);
      const {violations} = await page.evaluate(() => window.axe.run(document, {resultTypes: ['violations']}));
      for (const v of violations) fault(where, `axe-core: ${v.id}: ${v.help}: ${v.nodes[0].target} ${v.nodes[0].failureSummary}`);
    }
    for (const text of told) fault(where, `console: ${text}`);
    await close();
  }
  const {page, told, close} = await open(browser, file, {javaScriptEnabled: false});
  const text = await page.locator('main').innerText();
  for (const wanted of [report.digest.hits, 'The machine'].filter((t) => t)) if (!text.includes(wanted)) fault(`${name}, no scripts`, `lacks ${wanted}`);
  if (await page.locator('.plot:visible').count()) fault(`${name}, no scripts`, 'shows empty charts');
  for (const line of told) fault(`${name}, no scripts`, `console: ${line}`);
  await close();
}

try {
  const names = Object.keys(machines).filter((name) => !only || only.includes(name));
  const browser = await chromium.launch({executablePath: browser_path, args: ['--no-sandbox', '--disable-gpu', '--no-first-run',
    '--disable-background-networking', '--disable-component-update', '--disable-sync']});
  const [first, ...rest] = names;
  await simulate(first);
  let looked = look(browser, first);  // while the next machine is simulated
  for (const name of rest) {
    const [, done] = await Promise.allSettled([looked, simulate(name)]);
    await looked;
    if (done.reason) fault(name, done.reason.message);
    looked = done.reason ? Promise.resolve() : look(browser, name);
  }
  await looked;
  await browser.close();
  console.log(faults.length ? faults.join('\n') : `${names.length} pages are sound`);
} finally {
  await rm(folder, {recursive: true});
}
process.exit(faults.length ? 1 : 0);
