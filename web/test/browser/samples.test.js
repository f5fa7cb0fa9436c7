// Holds the light that shaders find at samples against the numbers that `lambent export` writes of the same bundle, as
// bundle.test.js does for the codecs.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import test from 'node:test';
import { readNpy } from '../npy.js';
import { launch, open, skip } from './browser.js';

const { LAMBENT_TEST_BUNDLE: path, LAMBENT_TEST_ARRAYS: folder } = process.env;
const array = (name) => readNpy(join(folder, name)).data;

const missing = skip || (folder ? false : 'LAMBENT_TEST_ARRAYS is not set');

test('E/π at samples is transfer times light', { skip: missing }, async (t) => {
  const info = JSON.parse(readFileSync(join(folder, 'bundle.json'))), rgb = array(info.light.coefficients);
  const { page, messages } = await open(t, await launch(t), { '/bundle/': dirname(resolve(path)) });
  await page.waitForFunction('window.lambentTest?.ready');
  const shown = `/bundle/${basename(path)}`;
  const groups = await page.evaluate((...a) => window.lambentTest.samples(...a), shown, [...rgb], 1);
  assert.deepEqual(messages, []);
  for (const [g, shaded] of groups.entries()) {
    const sums = new Float64Array(shaded.length);
    for (const block of info.groups[g].transfer) {
      if (block.form !== 'vector' || block.place !== 'surface' || block.order === 0) continue;
      const values = array(block.values), { columns, shadowedChannels, fullChannels } = block;
      const channels = shadowedChannels + fullChannels, first = fullChannels ? shadowedChannels : 0;
      for (let s = 0; s < block.samples; ++s)
        for (let c = 0; c < 3; ++c) {
          const channel = first + ((fullChannels || shadowedChannels) === 3 ? c : 0);
          for (let i = 0; i < columns; ++i)
            sums[4 * (block.firstSample + s) + c] += values[(s * channels + channel) * columns + i] * rgb[3 * i + c];
        }
    }
    let error = 0, sum = 0;
    for (let i = 0; i < sums.length; ++i) {
      if (i % 4 === 3) continue;
      error += (shaded[i] - sums[i]) ** 2;
      sum += sums[i] ** 2;
    }
    t.diagnostic(`group ${g}: relative RMS ${Math.sqrt(error / sum).toExponential(1)}`);
    assert.ok(sum > 0 && Math.sqrt(error / sum) < 1e-5);
  }
});
