// Looks at what pictures do not show: light from scenes, loading by ranges, suns. LAMBENT_TEST_MAP is an environment
// map with a sun, such as the sample sky.hdr; the first of LAMBENT_TEST_BUNDLES is shown.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import test from 'node:test';
import { bin, launch, list, open, skip, work } from './browser.js';

const map = process.env.LAMBENT_TEST_MAP, CAMERA = 'orbit:30,30,2.2,40', SIZE = [320, 180];

test('features', { skip: skip || (map ? false : 'LAMBENT_TEST_MAP is not set'), timeout: 600000 }, async (t) => {
  mkdirSync(work, { recursive: true });
  const browser = await launch(t), file = resolve(list.split(',')[0]), bundle = `/bundle/${basename(file)}`;
  const { page, messages, requests } = await open(t, browser,
    { '/work/': work, '/bundle/': dirname(file), '/map/': dirname(resolve(map)) });
  await page.waitForFunction('window.lambentTest?.ready');
  const sky = `/map/${basename(map)}`;

  const projected = await page.evaluate((url) => window.lambentTest.projections(url), sky);
  t.diagnostic(`fromScene differs from fromEquirect by ${(100 * projected).toFixed(2)} %`);
  assert.ok(projected < 0.03);

  const loaded = await page.evaluate((...a) => window.lambentTest.progressive(...a), bundle, CAMERA, SIZE);
  t.diagnostic(`by ranges: ${(100 * loaded.early).toFixed(2)} % off before the planes, then ${loaded.steps.join('; ')}`);
  assert.ok(requests.some((r) => r.path === bundle && r.range), 'ranges were asked for');
  assert.ok(loaded.early > 0 && loaded.early < 0.5 && loaded.late < 1e-6);

  const errors = {};
  for (const keys of [true, false]) {
    const exr = join(work, 'sunny.exr');
    execFileSync(join(bin, 'lambent-demo'), [
      file, '--camera', CAMERA, '--size', SIZE.join('x'), '--light', map, '--headless', exr]);
    const shown = await page.evaluate((o) => window.lambentTest.sunny(o),
      { bundle, map: sky, camera: CAMERA, size: SIZE, keys, picture: '/work/sunny.exr' });
    await page.screenshot({ path: join(work, `sunny-${keys ? 'keys' : 'bands'}.png`) });
    t.diagnostic(`${shown.suns} suns, ${keys ? 'by shadow maps' : 'by bands'}: ${(100 * shown.inside).toFixed(1)} % inside, ` +
      `${(100 * shown.all).toFixed(1)} % in all from lambent-demo with its key lights`);
    errors[keys] = shown.all;
  }
  assert.ok(errors.true < errors.false, 'shadow maps are nearer to it than bands');
  assert.deepEqual(messages, []);

  assert.ok(await page.evaluate((url) => window.lambentTest.newerFormat(url), bundle) > 0, 'it is shown as plain glTF');
  assert.equal(messages.length, 1, 'with one warning');
  assert.match(messages[0], /format 9/);
});
