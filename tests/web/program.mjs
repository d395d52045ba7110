// The program's results, made as users make them.
import {execFile} from 'node:child_process';
import {readFile, writeFile} from 'node:fs/promises';
import {join} from 'node:path';
import {promisify} from 'node:util';

// As root in a container, and on fewer cores than ranks.
const environment = {...process.env, OMPI_ALLOW_RUN_AS_ROOT: '1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM: '1',
  OMPI_MCA_rmaps_base_oversubscribe: '1', OMPI_MCA_mpi_yield_when_idle: '1', OMPI_MCA_hwloc_base_binding_policy: 'none'};

/** Whether ranks can be played here: the program was built with MPI, and mpirun starts processes. */
export async function playsRanks(program, sources) {
  const config = join(sources, 'configs/demo.yaml');
  const refused = await promisify(execFile)(program, ['run', config, '--set', 'engine.kind=native', '--set', 'engine.transport=mpi'])
    .then(() => '', (error) => error.stderr);
  return refused.includes('mpirun has not started') &&
    promisify(execFile)('mpirun', ['-n', '2', 'true'], {env: environment}).then(() => true, () => false);
}

/** Makes a page in `folder`; gives its file and the JSON that it shows. */
export async function make(program, sources, folder, name, {command, config, sets = [], options = [], of: runs, ranks}) {
  const call = async (...words) => (await promisify(execFile)(ranks ? 'mpirun' : program,
    ranks ? ['-n', ranks, program, ...words] : words, {cwd: folder, maxBuffer: 1 << 28, env: environment})).stdout;
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
