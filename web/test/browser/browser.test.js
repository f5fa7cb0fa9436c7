// Shows bundles in Chromium and holds them against lambent-demo under the same camera and light. The environment says
// what there is: LAMBENT_BIN is the folder of lambent-demo, LAMBENT_TEST_BUNDLES bundles with commas between them,
// LAMBENT_TEST_WORK a folder for pictures, CHROMIUM the browser (/usr/bin/chromium).
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import test from 'node:test';
import { bin, launch, list, open, skip, work } from './browser.js';

const SIZE = [320, 180], FACTOR = 4; // a pixel is the mean of 4 x 4
const CAMERA = 'orbit:30,30,2.2,40';
const LIGHTS = {
  constant: ['constant:1,0.9,0.8'],
  // A wide sun and a sky have few bands, so lambent-demo needs no key lights for them.
  soft: ['constant:0.3,0.35,0.5', 'sun:60,35,60,2,1.8,1.5'],
};
const BOUND = 0.005;

function picture(bundle, name, transfer) {
  mkdirSync(work, { recursive: true });
  const path = join(work, `${basename(bundle, '.lmb.glb')}-${name}-${transfer}.exr`);
  execFileSync(join(bin, 'lambent-demo'), [
    bundle, '--camera', CAMERA, '--size', SIZE.map((n) => n * FACTOR).join('x'), '--keys', 'off', '--transfer', transfer,
    '--local-shadows', 'off', '--patch-bounces', 'off', // lamps shine by their columns
    '--captures', 'off', '--neighborhoods', 'off', // bodies do not see each other
    ...LIGHTS[name].flatMap((light) => ['--light', light]), '--headless', path,
  ]);
  return path;
}

test('pictures are those of lambent-demo', { skip, timeout: 600000 }, async (t) => {
  const browser = await launch(t);
  for (const bundle of list.split(',')) {
    const { page, messages } = await open(t, browser, { '/work/': work, '/bundle/': dirname(resolve(bundle)) });
    await page.waitForFunction('window.lambentTest?.ready');
    for (const [name, transfer] of [['constant', 'full'], ['soft', 'full'], ['soft', 'shadowed'], ['soft', 'unshadowed']]) {
      const exr = picture(bundle, name, transfer);
      const result = await page.evaluate((options) => window.lambentTest.render(options), {
        bundle: `/bundle/${basename(bundle)}`, lights: LIGHTS[name], camera: CAMERA, size: SIZE, factor: FACTOR, transfer,
        picture: `/work/${basename(exr)}`,
      });
      await page.screenshot({ path: exr.replace('.exr', '.png') });
      const percent = (x) => `${(100 * x).toFixed(3)} %`;
      t.diagnostic(`${basename(exr)}: ${percent(result.all)}, beside no edges ${percent(result.inside)}, ` +
        `median of pixels ${percent(result.median)}, light in ${result.update_ms.toFixed(0)} ms`);
      assert.ok(result.all < BOUND, `${basename(exr)} differs by ${percent(result.all)}`);
      const { before, after } = result.memory;
      assert.ok(before.geometries > 0 && after.geometries === 0 && after.textures === 0, 'memory is freed on dispose');
    }
    assert.deepEqual(messages, [], 'the console has neither errors nor warnings');
    await page.close();
  }
});
