// Takes the pictures of a page of a run that docs/ and README.md show: node web/docs/pictures.mjs PROGRAM [RUN]
// It runs configs/demo.yaml under virtual time with one sample a pixel, and opens the page in Chromium, or that of a
// run that is there already. Needs what script/bootstrap installs for tests of pages. Some minutes.
import {execFileSync} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {createRequire} from 'node:module';
import {tmpdir} from 'node:os';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';

const root = resolve(dirname(fileURLToPath(import.meta.url)), '../..'), images = join(root, 'docs/images');
const {chromium} = createRequire(join(root, 'web/package.json'))('playwright-core');
const folder = mkdtempSync(join(tmpdir(), 'carousel-pictures-')), run = resolve(process.argv[3] ?? join(folder, 'page'));
try {
  const sets = ['engine.kind=cycle', 'image.samples=1', 'rays.slots_per_resource=2048'];
  if (!process.argv[3])
    execFileSync(resolve(process.argv[2]), ['run', join(root, 'configs/demo.yaml'), ...sets.flatMap((set) => ['--set', set]), '--out', run, '--quiet']);
  const browser = await chromium.launch({executablePath: '/usr/bin/chromium', args: ['--no-sandbox', '--disable-gpu']});
  const open = async (width, height, scheme) => {
    const page = await browser.newPage({viewport: {width, height}, colorScheme: scheme});
    await page.goto(`file://${run}/report.html`);
    await page.waitForTimeout(1500);
    return page;
  };
  const wide = await open(1000, 1000, 'light');
  await wide.screenshot({path: join(images, 'page-top.jpg'), quality: 85});
  await wide.evaluate(() => { location.hash = '#cycles'; });
  await wide.waitForTimeout(2500);
  const figure = wide.locator('#cycles figure').first();
  await figure.scrollIntoViewIfNeeded();
  await wide.waitForTimeout(2500);
  await figure.screenshot({path: join(images, 'page-cycles.png')});
  const narrow = await open(400, 700, 'dark');
  await narrow.screenshot({path: join(images, 'page-narrow.png')});
  await browser.close();
} finally {
  rmSync(folder, {recursive: true});
}
