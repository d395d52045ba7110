// The page of a sweep under `carousel serve`, in Chromium: node ask.mjs PROGRAM SOURCES
// Sliders give what lies between the points, the button has a point simulated, and its page opens. Exit status 1 and a
// line for each fault.
import {execFile, spawn} from 'node:child_process';
import {mkdtemp, readFile, rm, writeFile} from 'node:fs/promises';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';
import {promisify} from 'node:util';

import {chromiumOf, skip} from './chromium.mjs';

const [program, sources] = process.argv.slice(2, 4).map((path) => resolve(path));
const {axe, launch} = await chromiumOf(sources);

const folder = await mkdtemp(join(tmpdir(), 'carousel-ask-'));
const faults = [];
const expect = (holds, text) => { if (!holds) faults.push(text); };
const near = (a, b) => Math.abs(a - b) <= 1e-4 * Math.abs(b);
const call = (...words) => promisify(execFile)(program, words, {cwd: folder});
let server;
try {
  await writeFile(join(folder, 'a.yaml'), 'scene: {builtin: cornell}\nimage: {width: 8, height: 8, samples: 1, max_depth: 2}\n' +
    'engine: {kind: cycle, what_if: false}\nrays: {slots_per_resource: 64}\ntopology: {resources: 2}\n');
  await call('sweep', 'a.yaml', '--vary', 'topology.resources=1,2,8', '--vary', 'packets.rays=4,8', '--vary', 'packets.shapes=strip,single', '--out', 'sweep', '--quiet');
  await call('sweep', 'a.yaml', '--vary', 'topology.resources=1,2', '--vary', 'image.seed=3,4', '--out', 'seeds', '--quiet');
  const sweep = JSON.parse(await readFile(join(folder, 'sweep/sweep.json'), 'utf8'));
  const cyclesOf = (resources, rays, shapes) => sweep.points.find(({keys}) => keys['topology.resources'] === resources &&
    keys['packets.rays'] === rays && keys['packets.shapes'] === shapes).results.cycles;
  server = spawn(program, ['serve', 'sweep', 'seeds'], {cwd: folder, stdio: ['ignore', 'pipe', 'pipe']});
  const address = await new Promise((found, fail) => {
    let text = '';
    server.stdout.on('data', (data) => { text += data; const url = text.match(/http:\S+/); if (url) found(url[0]); });
    server.stderr.on('data', (data) => { text += data; });
    server.on('exit', () => fail(new Error(text)));
  }).catch((error) => (error.message.includes('libcpp-httplib-dev') ? skip('the module http is not built') : Promise.reject(error)));
  const browser = await launch();
  const page = await browser.newPage({viewport: {width: 400, height: 800}});
  const told = [];
  page.on('console', (m) => told.push(`${m.type()}: ${m.text()}`));
  page.on('pageerror', (e) => told.push(`error: ${e.message}`));
  await page.goto(`${address}0/`);
  const cell = (column) => page.evaluate((c) => {
    const row = [...document.querySelectorAll('#table-between tbody tr')].find((r) => r.cells[0].textContent === 'cycles');
    return row.cells[c].dataset.v === undefined ? null : Number(row.cells[c].dataset.v);
  }, column);
  const move = (key, position) => page.evaluate(([k, p]) => {
    const label = [...document.querySelectorAll('#between-points label')].find((l) => l.textContent.startsWith(k));
    const control = label.querySelector('input, select');
    if (control.type === 'range') control.value = p; else control.selectedIndex = p;
    control.dispatchEvent(new Event(control.type === 'range' ? 'input' : 'change'));
    return label.parentElement.querySelector('output')?.textContent;
  }, [key, position]);

  expect(near(await cell(1), cyclesOf(1, 4, 'strip')), 'a point of the grid has its own result');
  // 4 resources are as far from 2 as from 8 by their logarithms, and 6 rays from 4 as from 8 by themselves.
  const four = await move('topology.resources', Math.round(1000 * 2 / 3));
  expect(four === '4', `the slider of resources gives ${four}, not 4`);
  expect(near(await cell(1), Math.sqrt(cyclesOf(2, 4, 'strip') * cyclesOf(8, 4, 'strip'))), 'cycles between 2 and 8 resources');
  const six = await move('packets.rays', 500);
  await move('packets.shapes', 1);
  expect(six === '6', `the slider of rays gives ${six}, not 6`);
  const product = cyclesOf(2, 4, 'single') * cyclesOf(8, 4, 'single') * cyclesOf(2, 8, 'single') * cyclesOf(8, 8, 'single');
  expect(near(await cell(1), product ** 0.25), 'cycles in the middle of four points');
  expect((await cell(2)) === null, 'nothing is simulated yet');

  await page.click('#ask');
  for (const end = Date.now() + 60000; (await cell(2)) === null;) {
    if (Date.now() > end) throw new Error(`no answer: ${await page.innerText('#between-points')}`);
    await new Promise((done) => setTimeout(done, 100));
  }
  await call('run', 'a.yaml', '--set', 'topology.resources=4', '--set', 'packets.rays=6', '--set', 'packets.shapes=single', '--out', 'run', '--quiet');
  const {engine: {cycles}} = JSON.parse(await readFile(join(folder, 'run/report.json'), 'utf8'));
  expect((await cell(2)) === cycles, `the point takes ${cycles} cycles, and the page says ${await cell(2)}`);
  expect(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), 'the page is wider than the window');
  await page.evaluate(axe);
  for (const v of (await page.evaluate(() => window.axe.run('#between', {resultTypes: ['violations']}))).violations)
    faults.push(`axe-core: ${v.id}: ${v.help}: ${v.nodes[0].target}`);
  await page.click('#between-points a');
  await page.waitForURL(/\/asked\/[0-9a-f]{32}\/$/);
  expect((await page.innerText('main')).includes('What limits it'), 'the page of the point opens');
  // Of points with several seeds one is simulated, and the page says which.
  await page.goto(`${address}1/`);
  await page.click('#ask');
  const answer = await (await page.waitForSelector('#between-points [role=status]:has(a)', {timeout: 60000})).innerText();
  expect(answer.includes('of seed 3 alone'), `the page says of a simulated point: ${answer}`);
  for (const line of told) faults.push(`console: ${line}`);
  await browser.close();
  console.log(faults.length ? faults.join('\n') : 'the page answers');
} finally {
  server?.kill('SIGTERM');
  await rm(folder, {recursive: true});
}
process.exit(faults.length ? 1 : 0);
