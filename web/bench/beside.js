#!/usr/bin/env node
// Holds a bundle beside light baked into vertices, as a lightmap stands still, and three's LightProbe: error against
// path-traced pictures while the light turns, bytes, time to the first lit picture, time of a frame. Chromium draws with
// its software renderer. Prints the tables of docs/web.md.
//     node web/bench/beside.js --programs build/release/bin --assets build/release/assets --work DIR
// Pictures that are in DIR already are not traced again.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { launch, open, web } from '../test/browser/browser.js';
import { readNpy } from '../test/npy.js';

const { values: options } = parseArgs({ options: {
  programs: { type: 'string' }, assets: { type: 'string' }, work: { type: 'string' },
  scene: { type: 'string', default: 'gallery' }, spp: { type: 'string', default: '128' },
  runs: { type: 'string', default: '5' }, frames: { type: 'string', default: '9' },
} });
for (const name of ['programs', 'assets', 'work'])
  if (!options[name]) {
    console.error(`beside.js: --${name} is missing; see the head of web/bench/beside.js`);
    process.exit(2);
  }
const work = resolve(options.work), lambent = join(resolve(options.programs), 'lambent');
const glb = join(resolve(options.assets), `${options.scene}.glb`), map = join(resolve(options.assets), 'sky.hdr');
const TURNS = [0, 45, 90, 180], SIZE = [240, 135];
const LIGHTS = {
  soft: ['constant:0.22,0.27,0.36', 'sun:50,40,20,6.5,5.9,4.9'],
  sky: [map],
};
const run = (...words) => execFileSync(lambent, words, { encoding: 'utf8', maxBuffer: 1 << 26 });
const inWork = (name) => join(work, name);
mkdirSync(inWork('references'), { recursive: true });

// Reads a GLB as JSON and the bytes of its views.
function readGlb(path) {
  const file = readFileSync(path), length = file.readUInt32LE(12);
  const json = JSON.parse(file.toString('utf8', 20, 20 + length)), binary = file.subarray(28 + length);
  const viewOf = ({ byteOffset = 0, byteLength }) => binary.subarray(byteOffset, byteOffset + byteLength);
  return { json, views: json.bufferViews.map(viewOf) };
}

// Two views may be one buffer, which is written once. `strides` are of views that have one.
function writeGlb(path, json, views, strides = []) {
  const places = new Map(), padded = [];
  let at = 0;
  json.bufferViews = views.map((bytes, i) => {
    if (!places.has(bytes)) {
      places.set(bytes, at);
      padded.push(Buffer.concat([bytes, Buffer.alloc(-bytes.length & 3)]));
      at += padded.at(-1).length;
    }
    const view = { buffer: 0, byteOffset: places.get(bytes), byteLength: bytes.length };
    return strides[i] ? { ...view, byteStride: strides[i] } : view;
  });
  json.buffers = [{ byteLength: at }];
  const text = Buffer.from(JSON.stringify(json));
  const chunk = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')]);
  const head = Buffer.alloc(20), middle = Buffer.alloc(8);
  head.write('glTF', 0, 'latin1');
  [2, 28 + chunk.length + at, chunk.length].forEach((n, i) => head.writeUInt32LE(n, 4 + 4 * i));
  head.write('JSON', 16, 'latin1');
  middle.writeUInt32LE(at, 0);
  middle.write('BIN\0', 4, 'latin1');
  writeFileSync(path, Buffer.concat([head, chunk, middle, ...padded]));
}

// Writes the bundle's meshes and images without its transfer: a plain glTF file for LightProbe. With `light`, E/pi at the
// vertices of each draw, they carry it as their color.
function writePlain(bundle, path, light) {
  const { json, views } = readGlb(bundle), kept = [], strides = [];
  const keep = (view) => (kept.includes(view) ? kept.indexOf(view) : kept.push(view) - 1);
  const { draws } = json.extensions.LAMBENT_radiance_transfer;
  delete json.extensions;
  json.extensionsUsed = json.extensionsUsed.filter((name) => name !== 'LAMBENT_radiance_transfer');
  for (const image of json.images ?? []) image.bufferView = keep(image.bufferView);
  for (const { primitives } of json.meshes)
    for (const { extensions } of primitives) {
      const coded = extensions.KHR_draco_mesh_compression;
      coded.bufferView = keep(coded.bufferView);
    }
  const out = kept.map((view) => views[view]);
  if (light) {
    const largest = light.reduce((most, values) => values.reduce((a, b) => Math.max(a, b), most), 0);
    json.extensionsUsed.push('KHR_materials_unlit');
    json.materials.forEach((material) => (material.extensions = { KHR_materials_unlit: {} }));
    // A mesh of two nodes has two lights; the loaders share what comes from one view.
    for (const node of json.nodes.filter((each) => each.mesh !== undefined)) {
      node.mesh = json.meshes.push(structuredClone(json.meshes[node.mesh])) - 1;
      for (const { extensions: { KHR_draco_mesh_compression: coded } } of json.meshes[node.mesh].primitives)
        coded.bufferView = out.push(out[coded.bufferView]) - 1;
    }
    draws.forEach(({ node, primitive, side }, d) => {
      if (side === 'back') return;
      const { mesh } = json.nodes[node], count = light[d].length / 3;
      const colors = new Uint16Array(4 * count).fill(65535); // four, to stay aligned
      for (let i = 0; i < 3 * count; ++i)
        colors[4 * Math.floor(i / 3) + (i % 3)] = Math.round((65535 * Math.max(0, light[d][i])) / largest);
      strides[out.length] = 8;
      const bufferView = out.push(Buffer.from(colors.buffer)) - 1;
      json.meshes[mesh].primitives[primitive].attributes.COLOR_0 =
        json.accessors.push({ bufferView, componentType: 5123, normalized: true, count, type: 'VEC4' }) - 1;
    });
    json.scenes[json.scene ?? 0].extras = { largest };
  }
  writeGlb(path, json, out, strides);
}

// Returns E/pi with all bounces at the vertices of each draw, from the arrays that `lambent export` writes.
function lightAtVertices(bundle, words) {
  const folder = inWork('arrays');
  run('export', bundle, '-o', folder, ...words.flatMap((word) => ['--light', word]), '--order', '5', '--quiet');
  const described = JSON.parse(readFileSync(join(folder, 'bundle.json'), 'utf8'));
  const load = (name) => readNpy(join(folder, name)), light = load(described.light.coefficients).data;
  const lit = described.groups.map((group) => {
    const out = new Float32Array(3 * group.samples);
    for (const block of group.transfer) {
      if (block.place !== 'surface' || block.form !== 'vector' || block.order === 0) continue;
      const { shape: [samples, channels, , columns], data } = load(block.values), first = block.shadowedChannels;
      for (let s = 0; s < samples; ++s)
        for (let c = 0; c < 3; ++c) {
          const channel = Math.min(first + c, channels - 1);
          let sum = 0;
          for (let i = 0; i < block.order ** 2; ++i)
            sum += data[(s * channels + channel) * columns + i] * light[3 * i + c];
          out[3 * (block.firstSample + s) + c] += sum;
        }
    }
    return out;
  });
  const atVertices = described.surfaces.map((surface) => {
    const rows = ['rowOffsets', 'rowSamples', 'rowWeights'].map((name) => load(surface[name]).data);
    const [offsets, samples, weights] = rows, from = lit[surface.group];
    const out = new Float32Array(3 * (offsets.length - 1));
    for (let v = 0; v + 1 < offsets.length; ++v)
      for (let k = offsets[v]; k < offsets[v + 1]; ++k)
        for (let c = 0; c < 3; ++c) out[3 * v + c] += weights[k] * from[3 * samples[k] + c];
    return out;
  });
  rmSync(folder, { recursive: true, force: true });
  return atVertices;
}

function reference(name, turn, seed) {
  const path = inWork(`references/${name}-${turn}-${seed}.exr`);
  if (!existsSync(path))
    run('reference', glb, '--camera', 'main', ...LIGHTS[name].flatMap((word) => ['--light', word]),
      '--rotate-light', `${turn}`, '--size', SIZE.join('x'), '--spp', options.spp, '--seed', `${seed}`,
      '-o', path, '--quiet');
  return path;
}

const bundle = inWork('bundle.lmb.glb');
run('bake', glb, '-o', bundle, '--rays', '512', '--bounces', '4', '--quiet');
writePlain(bundle, inWork('plain.glb'));
writePlain(bundle, inWork('vertices.glb'), lightAtVertices(bundle, LIGHTS.soft));
const FILES = { bundle: 'bundle.lmb.glb', vertices: 'vertices.glb', probe: 'plain.glb' };

const closings = [], browser = await launch({ after: (close) => closings.unshift(close) });
const newPage = async () => (await open({ after: (close) => closings.unshift(close) }, browser,
  { '/work/': work, '/assets/': dirname(map) }, '/web/bench/beside.html', [400, 300]));
const words = (name) => LIGHTS[name].map((word) => (word === map ? '/assets/sky.hdr' : word));

// Loads one way of showing the scene under a light, on a page of its own.
async function load(way, name) {
  const { page, messages } = await newPage();
  await page.waitForFunction('window.beside');
  const shown = await page.evaluate((o) => window.beside.show(o),
    { way, url: `/work/${FILES[way]}`, words: words(name), size: SIZE });
  if (messages.length > 0) throw new Error(messages.join('; '));
  return { page, ...shown };
}

// Returns the relative RMS of a picture in per cent, free of the references' noise.
async function percent(page, name, turn, shownAt = turn) {
  const path = inWork('picture.exr');
  const exr = await page.evaluate((degrees) => window.beside.picture(degrees), shownAt);
  writeFileSync(path, Buffer.from(exr, 'base64'));
  const [one, two] = [1, 2].map((seed) => reference(name, turn, seed));
  const json = JSON.parse(run('compare', path, one, '--reference2', two, '--json'));
  return (100 * json.relativeRms).toFixed(1);
}

try {
  console.log(`| light | shown by | ${TURNS.map((turn) => `${turn}°`).join(' | ')} |`);
  console.log(`|---|---|${TURNS.map(() => '---|').join('')}`);
  for (const name of Object.keys(LIGHTS)) {
    const baked = await load('bundle', name), probe = await load('probe', name);
    // No vertex can hold the shadow of the sky's small sun, so there the bundle's own picture at 0 degrees stands still.
    const still = name === 'soft' ? await load('vertices', name) : await load('bundle', name);
    const rows = { bundle: [], 'baked light': [], LightProbe: [] };
    for (const turn of TURNS) {
      rows.bundle.push(await percent(baked.page, name, turn));
      rows['baked light'].push(await percent(still.page, name, turn, 0));
      rows.LightProbe.push(await percent(probe.page, name, turn));
    }
    for (const [row, values] of Object.entries(rows))
      console.log(`| ${name} | ${row} | ${values.map((v) => `${v} %`).join(' | ')} |`);
    for (const { page } of [baked, probe, still]) await page.close();
  }
  console.log('\n| shown by | bytes | first lit picture | frame, light turns | frame, light stands |');
  console.log('|---|---|---|---|---|');
  const middle = (list) => list.sort((a, b) => a - b)[list.length >> 1];
  for (const way of Object.keys(FILES)) {
    const runs = [];
    for (let i = 0; i < Number(options.runs); ++i) {
      const { page, first_ms } = await load(way, 'soft');
      runs.push({ first_ms, ...await page.evaluate((n) => window.beside.frames(n), Number(options.frames)) });
      await page.close();
    }
    const cells = ['first_ms', 'turning_ms', 'still_ms'].map((key) => `${middle(runs.map((r) => r[key])).toFixed(0)} ms`);
    console.log(`| ${way} | ${statSync(inWork(FILES[way])).size} | ${cells.join(' | ')} |`);
  }
} finally {
  for (const close of closings) await close();
}
