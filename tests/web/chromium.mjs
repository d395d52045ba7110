// Chromium for tests of pages, and axe-core's script, with the packages of web/. Where one of them is missing, the test
// ends with status 77, which ctest counts as skipped.
import {existsSync} from 'node:fs';
import {readFile} from 'node:fs/promises';
import {createRequire} from 'node:module';
import {join} from 'node:path';

export const skip = (why) => { console.log(`skipped: ${why}; script/bootstrap all installs it`); process.exit(77); };

/** `sources`: the project's folder. What `launch` gives is the caller's to close. */
export async function chromiumOf(sources) {
  const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
  if (!executablePath) skip('chromium is not installed');
  if (!existsSync(join(sources, 'web/node_modules/playwright-core'))) skip('web/node_modules is missing');
  const require = createRequire(join(sources, 'web/package.json'));
  const {chromium} = require('playwright-core');
  return {
    axe: await readFile(require.resolve('axe-core/axe.min.js'), 'utf8'),
    launch: () => chromium.launch({executablePath, args: ['--no-sandbox', '--disable-gpu', '--no-first-run',
      '--disable-background-networking', '--disable-component-update', '--disable-sync']}),
  };
}
