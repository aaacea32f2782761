// Makes the pages that `headpin report`, `play` and `serve` fill in, each one file, with styles,
// scripts and engine in it: OUT.html, and play.html and watch.html, of `headpin serve`, beside it.
//
//   node build.mjs OUT.html [ENGINE_FOLDER]
import { existsSync, mkdirSync, readFileSync, renameSync, rmSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { deflateSync } from 'node:zlib';

import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const [out, engineFolder] = process.argv.slice(2);
if (!out) {
  console.error('usage: node build.mjs OUT.html [ENGINE_FOLDER]');
  process.exit(2);
}

const source = (name) => readFileSync(join(here, 'src', name), 'utf8');
const deflated = (bytes) => deflateSync(bytes, { level: 9 }).toString('base64');

async function bundle(name) {
  const result = await build({
    entryPoints: [join(here, 'src', name)],
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: ['chrome110', 'firefox115', 'safari16.4'],
    legalComments: 'none',
  });
  return result.outputFiles[0].contents;
}

const blocksOf = (blocks) => Object.entries(blocks).map(([name, bytes]) =>
  `<script type="text/plain" data-block="${name}">${deflated(bytes)}</script>`).join('\n');

const hasEngine = engineFolder !== undefined && existsSync(join(engineFolder, 'engine.wasm'));
const engine = hasEngine ? {
  'engine-js': readFileSync(join(engineFolder, 'engine.js')),
  'engine-wasm': readFileSync(join(engineFolder, 'engine.wasm')),
} : {};

/** What of others is in the page, and its licences in full, as the packages have them. */
function notices() {
  const cmake = join(here, '../../cmake');
  const places = hasEngine ? ['page', "the page's engine"] : ['page'];
  const parts = JSON.parse(readFileSync(join(cmake, 'third_parties.json'), 'utf8'))
    .filter((part) => part.in.some((place) => places.includes(place)));
  const own = readFileSync(join(here, '../../LICENSE'), 'utf8').split('\n\n');
  const texts = { MIT: own.slice(2).join('\n\n').trim() };
  for (const paragraph of readFileSync(join(cmake, 'copyright.in'), 'utf8').split('\n\n')) {
    const [, name, text] = /^License: (.*)\n((?: .*\n?)+)/.exec(paragraph) ?? [];
    if (name && name !== 'MIT') texts[name] = text.trimEnd().replace(/^ \.?/gm, '');
  }
  const licences = [...new Set(['MIT', ...parts.map((part) => part.licence)])].map((name) => {
    if (!texts[name]) throw new Error(`cmake/copyright.in: no text of ${name}`);
    return `${name}\n\n${texts[name]}\n`;
  });
  const list = parts.map((part) => `${part.name}: ${part.licence}, Copyright (c) ${part.holders}\n`);
  return `headpin: MIT, ${own[1]}\n${list.join('')}\n${licences.join('\n')}`.replaceAll('--', '- -');
}

/** Fills a template of ours and writes it. */
async function write(file, template, replacements) {
  const all = { ...replacements, '/*headpin:loader*/': new TextDecoder().decode(await bundle('loader.js')) };
  let page = source(template).replace('<head>', () => `<head>\n<!--\nIn this page:\n${notices()}-->`);
  for (const [mark, text] of Object.entries(all)) page = page.replace(mark, () => text);
  mkdirSync(dirname(file), { recursive: true });
  writeFileSync(`${file}.part`, page);
  renameSync(`${file}.part`, file);
  console.log(`${file}: ${page.length} bytes${hasEngine ? '' : ', without the engine'}`);
}

const plots = readFileSync(join(here, 'node_modules/uplot/dist/uPlot.min.css'), 'utf8');
await write(out, 'index.html', {
  '/*headpin:style*/': plots + source('style.css'),
  '/*headpin:page*/': deflated(await bundle('main.js')),
  '<!--headpin:engine-->': hasEngine ? blocksOf({ ...engine, 'engine-worker': await bundle('worker.js') }) : '',
});
await write(join(dirname(out), 'watch.html'), 'watch/watch.html', {
  '/*headpin:style*/': source('style.css') + source('play/play.css'),
  '/*headpin:page*/': deflated(await bundle('watch/main.js')),
});
const play = join(dirname(out), 'play.html');
if (hasEngine) {
  await write(play, 'play/play.html', {
    '/*headpin:style*/': source('style.css') + source('play/play.css'),
    '/*headpin:page*/': deflated(await bundle('play/main.js')),
    '<!--headpin:engine-->': blocksOf({ ...engine, 'store-worker': await bundle('play/store_worker.js') }),
  });
} else {
  rmSync(play, { force: true });
  console.log(`${play}: not made, it needs the engine`);
}
