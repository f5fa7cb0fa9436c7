#!/usr/bin/env node
// Makes the site: static pages out of docs, bundles of the sample scenes, the viewer and three.js.
//     node web/site/make.js --programs build/release/bin --assets build/release/assets --output site
// --scenes names those to bake (default all), --bake=OPTIONS how. A scene whose bundle is up to date is not baked again.
// The result is for any file server, such as python3 -m http.server -d site; browsers open no modules without one.
import { execFileSync } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, normalize, relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { Marked } from 'marked';
import { listedFiles } from './listed_files.js';

process.on('uncaughtException', (error) => {
  console.error(`make.js: ${error.message}`);
  process.exit(1);
});

const here = dirname(fileURLToPath(import.meta.url)), web = join(here, '..'), docs = join(web, '../docs');
const SCENES = ['hello', 'knot', 'gallery', 'playroom', 'metals', 'ring', 'flight', 'field'];
const { values: options } = parseArgs({ options: {
  programs: { type: 'string' }, assets: { type: 'string' }, output: { type: 'string' },
  scenes: { type: 'string', default: SCENES.join() }, bake: { type: 'string', default: '--rays 512 --bounces 4' },
} });
for (const name of ['programs', 'assets', 'output'])
  if (!options[name]) {
    console.error(`make.js: --${name} is missing; see the head of web/site/make.js`);
    process.exit(2);
  }
const output = resolve(options.output), scenes = options.scenes.split(',');

// Pages by the document that they are made of. Those without a title stand in no menu.
const PAGES = {
  'transfer.md': { file: 'index.html', title: 'Lambent' },
  'scenes.md': { file: 'scenes.html', title: 'Scenes' },
  'first-bake.md': { file: 'bake.html', title: 'Bake your own' },
  'web.md': { file: 'web.html', title: 'In the browser' },
  'authoring.md': { file: 'authoring.html' },
  'baking.md': { file: 'baking.html' },
};

const put = (from, to) => {
  mkdirSync(dirname(join(output, to)), { recursive: true });
  cpSync(from, join(output, to));
};
const escape = (text) => text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/"/g, '&quot;');
const plain = (html) => html.replace(/<[^>]*>/g, '');

// As GitHub names headings.
const slug = (text) => text.toLowerCase().replace(/[^\p{L}\p{N} _-]/gu, '').replace(/ /g, '-');

function bodyOf(document) {
  const missing = [];
  const renderer = {
    heading({ tokens, depth }) {
      const text = this.parser.parseInline(tokens), id = slug(plain(text));
      const heading = `<h${depth} id="${id}">${text}</h${depth}>\n`;
      if (document !== 'scenes.md' || !scenes.includes(id)) return heading;
      const address = `viewer/index.html?bundle=../bundles/${id}.lmb.glb&amp;light=../light/sky.hdr`;
      return `${heading}<p><a href="${address}">Open in the viewer</a></p>\n`;
    },
    image({ href, text }) {
      const from = join(docs, href), to = `pictures/${basename(href)}`, live = /^pictures\/live-(\w+)\.jpg$/.exec(href);
      if (existsSync(from)) put(from, to);
      else missing.push(href);
      const image = `<img src="${to}" alt="${escape(text)}">`;
      return live ? `<figure class="live" data-live="${live[1]}"><div class="frame">${image}</div></figure>` : image;
    },
    link({ href, tokens }) {
      const text = this.parser.parseInline(tokens), [file, anchor] = href.split('#');
      if (/^https?:/.test(href)) return `<a href="${escape(href)}">${text}</a>`;
      const page = file === '' ? '' : PAGES[normalize(file)]?.file;
      if (page === undefined) return text; // it leads into the repository
      return `<a href="${page}${anchor ? `#${anchor}` : ''}">${text}</a>`;
    },
    paragraph({ tokens }) {
      const html = this.parser.parseInline(tokens);
      return html.startsWith('<figure') ? `${html}\n` : `<p>${html}</p>\n`;
    },
  };
  const html = new Marked({ renderer }).parse(readFileSync(join(docs, document), 'utf8'));
  for (const href of missing) console.error(`make.js: docs/${document}: ${href} is not here`);
  return html.replace(/<table>[^]*?<\/table>/g, (table) => `<div class="table">${table}</div>`);
}

const importMap = {
  imports: {
    three: './node_modules/three/build/three.module.js', 'three/addons/': './node_modules/three/examples/jsm/',
    fzstd: './node_modules/fzstd/esm/index.mjs', 'lambent-three': './src/index.js',
  },
};

function page(document) {
  const { file, title } = PAGES[document], body = bodyOf(document), live = body.includes('class="live"');
  const menu = Object.values(PAGES).filter((each) => each.title).map((each) =>
    `<a href="${each.file}"${each.file === file ? ' aria-current="page"' : ''}>${each.title}</a>`).join('\n  ');
  const heading = plain(/<h1[^>]*>([^]*?)<\/h1>/.exec(body)[1]);
  return `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${heading}${title === 'Lambent' ? '' : ' · Lambent'}</title>
<link rel="icon" href="data:,">
<link rel="stylesheet" href="style.css">
${live ? `<script type="importmap">${JSON.stringify(importMap)}</script>
<script type="module" src="live.js"></script>\n` : ''}
<nav>
  ${menu}
</nav>
<main>
${body}</main>
</html>
`;
}

mkdirSync(join(output, 'bundles'), { recursive: true });
for (const scene of scenes) {
  // The picture of orders shows all that there are.
  const order = scene === 'hello' ? ['--order', '8'] : [];
  execFileSync(join(resolve(options.programs), 'lambent'), [
    'bake', join(resolve(options.assets), `${scene}.glb`), '-o', join(output, `bundles/${scene}.lmb.glb`),
    ...options.bake.split(' ').filter(Boolean), ...order, '--quiet'], { stdio: ['ignore', 'inherit', 'inherit'] });
}
put(join(resolve(options.assets), 'sky.hdr'), 'light/sky.hdr');
for (const file of listedFiles(web)) put(join(web, file), file);
for (const file of ['live.js', 'style.css']) put(join(here, file), file);
for (const document of Object.keys(PAGES)) writeFileSync(join(output, PAGES[document].file), page(document));
console.log(`${relative('', output) || '.'}: ${Object.keys(PAGES).length} pages, ${scenes.length} scenes`);
