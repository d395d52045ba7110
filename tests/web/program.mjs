// The program's results, made as users make them.
import {execFile} from 'node:child_process';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {promisify} from 'node:util';

/** Makes a page in `folder`; gives its file and the JSON that it shows. */
export async function make(program, sources, folder, name, {command, config, sets = [], options = [], of: runs}) {
  const call = async (...words) => (await promisify(execFile)(program, words, {cwd: folder, maxBuffer: 1 << 28})).stdout;
  const json = async (file) => JSON.parse(await readFile(join(folder, file), 'utf8'));
  const arguments_ = [join(sources, `configs/${config}.yaml`), ...sets.flatMap((s) => ['--set', s]), ...options];
  const page = (file) => join(folder, file);
  switch (command) {
    case 'compare': {
      const list = [...runs, ...options];
      const text = await call('compare', ...list, '--json', '--html', `${name}.html`);
      return {page: page(`${name}.html`), json: JSON.parse(text)};
    }
    case 'follow': {
      await writeFile(page(`${name}.json`), await call('follow', ...arguments_, '--json'));
      await call('report', `${name}.json`);
      return {page: page(`${name}.html`), json: await json(`${name}.json`)};
    }
    default: {
      await call(command, ...arguments_, '--quiet', '--out', name);
      const result = command === 'run' ? 'report' : command;
      return {page: page(`${name}/${result}.html`), json: await json(`${name}/${result}.json`)};
    }
  }
}
