// Does what someone new does: packs the package, installs the packed file into an empty project, pastes the lines of
// docs/web.md, and looks. three and fzstd are links to node_modules, so nothing is fetched from the network.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import test from 'node:test';
import { launch, list, open, skip, web } from './browser.js';

const map = process.env.LAMBENT_TEST_MAP, npm = spawnSync('npm', ['--version']).status === 0;
const why = skip || (map ? false : 'LAMBENT_TEST_MAP is not set') || (npm ? false : 'there is no npm');

// What surrounds the lines of the documentation on a page of one's own.
const PAGE = `<!doctype html>
<link rel="icon" href="data:,">
<style>body { margin: 0 }</style>
<script type="importmap">{ "imports": {
  "three": "./node_modules/three/build/three.module.js",
  "three/addons/": "./node_modules/three/examples/jsm/",
  "fzstd": "./node_modules/fzstd/esm/index.mjs",
  "lambent-three": "./node_modules/lambent-three/src/index.js"
} }</script>
<script type="module" src="main.js"></script>
`;
const OWN = `
import * as THREE from 'three';
const renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true }), scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(40, 2, 0.1, 100);
renderer.setSize(320, 160);
document.body.append(renderer.domElement);
camera.position.set(1.3, 1.6, 2.6);
camera.lookAt(0, 0.4, 0);
`;

test('the packed file lights a bundle in an empty project', { skip: why, timeout: 600000 }, async (t) => {
  const project = mkdtempSync(join(tmpdir(), 'lambent-newcomer-'));
  t.after(() => rmSync(project, { recursive: true, force: true }));
  const run = (...words) => execFileSync('npm', words, { cwd: project, stdio: ['ignore', 'pipe', 'pipe'] });
  run('pack', web, '--pack-destination', project);
  const packed = readdirSync(project).find((file) => file.endsWith('.tgz'));
  writeFileSync(join(project, 'package.json'), '{ "private": true }');
  run('install', '--offline', '--no-audit', '--no-fund', `./${packed}`,
    join(web, 'node_modules/three'), join(web, 'node_modules/fzstd'));
  assert.deepEqual(readdirSync(join(project, 'node_modules/lambent-three')).sort(),
    ['LICENSE', 'README.md', 'package.json', 'src']);

  const lines = /```js\n([^]*?)```/.exec(readFileSync(join(web, '../docs/web.md'), 'utf8'))[1];
  assert.ok(lines.includes('lambent-three'));
  writeFileSync(join(project, 'main.js'), OWN + lines);
  writeFileSync(join(project, 'index.html'), PAGE);
  cpSync(join(web, 'node_modules/three/examples/jsm/libs/draco'), join(project, 'draco'), { recursive: true });
  cpSync(list.split(',')[0], join(project, 'room.lmb.glb'));
  cpSync(map, join(project, 'sky.hdr'));

  const browser = await launch(t), { page, messages } = await open(t, browser, { '/': project }, '/index.html');
  const lit = () => page.evaluate(() => {
    const canvas = document.querySelector('canvas'), flat = document.createElement('canvas');
    if (!canvas) return [0, 0];
    Object.assign(flat, { width: canvas.width, height: canvas.height });
    const context = flat.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const { data } = context.getImageData(0, 0, flat.width, flat.height), sum = [0, 0];
    for (let i = 0; i < data.length; i += 4) {
      sum[0] += data[i] + data[i + 1] + data[i + 2] > 60 ? 4 / data.length : 0;
      sum[1] += (i * data[i]) / data.length; // differs when the light has turned
    }
    return sum;
  });
  let share = 0, first = 0, later = 0; // the test's own limit ends these loops
  for (; share < 0.05; assert.deepEqual(messages, [])) [share, first] = await lit();
  for (later = first; later === first;) [, later] = await lit();
  t.diagnostic(`${(100 * share).toFixed(0)} % of the picture is lit, and the light turns`);
  assert.deepEqual(messages, []);
});
