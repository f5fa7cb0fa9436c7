// Holds the codecs against the numbers that `lambent export` writes of the same bundle. The environment says where
// they are: LAMBENT_TEST_BUNDLE is a bundle, LAMBENT_TEST_ARRAYS the folder of its export with --light.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { openBundle } from './bundle_file.js';
import { readNpy } from './npy.js';
import { decodeTransfer, shapeOf } from '../src/codebook.js';
import { LightVector } from '../src/light_vector.js';
import { Vector3 } from 'three';

const path = process.env.LAMBENT_TEST_BUNDLE, folder = process.env.LAMBENT_TEST_ARRAYS;
const skip = path && folder ? false : 'LAMBENT_TEST_BUNDLE and LAMBENT_TEST_ARRAYS are not set';
const array = (name) => readNpy(join(folder, name));
const listing = () => JSON.parse(readFileSync(join(folder, 'bundle.json')));

const relative = (a, b) => {
  let error = 0, sum = 0;
  for (let i = 0; i < b.length; ++i) {
    error += (a[i] - b[i]) ** 2;
    sum += b[i] ** 2;
  }
  return Math.sqrt(error / sum);
};

test('decoded transfer is that of the C++ reader', { skip }, async (t) => {
  const bundle = openBundle(path), info = listing();
  for (const [g, json] of bundle.groups.entries()) {
    let block = 0;
    for (const cell of json.cells)
      for (const transfer of cell.transfers) {
        const { codebook, clusterOf } = await bundle.codebook(transfer, cell.sampleCount);
        const planes = await Promise.all(transfer.planes.map((plane) => bundle.plane(plane)));
        const ours = decodeTransfer(shapeOf(transfer), codebook, clusterOf, planes);
        const theirs = array(info.groups[g].transfer[block++].values).data;
        assert.equal(ours.length, theirs.length);
        const most = ours.reduce((m, value, i) => Math.max(m, Math.abs(value - theirs[i])), 0);
        t.diagnostic(`group ${g}, block ${block - 1}: largest difference ${most.toExponential(1)}`);
        assert.ok(most < 1e-6 * Math.max(1, ...theirs.slice(0, 1000).map(Math.abs)), `differs by ${most}`);
      }
  }
});

test('rows are those of the C++ reader', { skip }, async () => {
  const bundle = openBundle(path), info = listing();
  for (const [d, draw] of bundle.draws.entries()) {
    const rows = await bundle.rows(draw), surface = info.surfaces[d], entries = array(surface.rowSamples).data;
    assert.deepEqual(rows.offsets.slice(0, bundle.vertexCount(draw) + 1), array(surface.rowOffsets).data);
    assert.deepEqual(rows.samples.slice(0, entries.length), entries);
    const weights = array(surface.rowWeights).data;
    if (rows.weights) weights.forEach((w, i) => assert.ok(Math.abs(w - rows.weights[i]) < 1e-6));
  }
});

test('closed forms of light are those of the program', { skip }, (t) => {
  const info = listing(), light = array(info.light.coefficients).data;
  assert.deepEqual(info.light.words, ['constant:1,1,1', 'sun:30,40,20,5'], 'export with these lights');
  const degree = Math.PI / 180, azimuth = 30 * degree, elevation = 40 * degree;
  const direction = new Vector3(
    Math.sin(azimuth) * Math.cos(elevation), Math.sin(elevation), Math.cos(azimuth) * Math.cos(elevation));
  const ours = LightVector.constant(1, 1, 1, 5)
    .add(LightVector.disc(direction, 20 * degree, { r: 5, g: 5, b: 5 }, 5));
  t.diagnostic(`relative RMS ${relative(ours.rgb, light).toExponential(1)}`);
  assert.ok(relative(ours.rgb, light) < 1e-5);
});
