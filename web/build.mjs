// Bundles the scripts of the pages into one file: node build.mjs OUTPUT
import {build} from 'esbuild';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
await build({
  entryPoints: [join(here, 'src/page.js')],
  outfile: process.argv[2] ?? join(here, 'page.js'),
  absWorkingDir: here,
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  charset: 'utf8',
  legalComments: 'inline',
  define: {'process.env.NODE_ENV': '"production"'},
});
