// Shows bundles in Chromium and holds them against lambent-demo under the same camera and light. The environment says
// what there is: LAMBENT_BIN is the folder of lambent-demo, LAMBENT_TEST_BUNDLES bundles with commas between them,
// LAMBENT_TEST_WORK a folder for pictures, CHROMIUM the browser (/usr/bin/chromium).
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import test from 'node:test';
import { DataTexture, FloatType, RGBAFormat } from 'three';
import { EXRExporter } from 'three/addons/exporters/EXRExporter.js';
import { bin, launch, list, open, skip, work } from './browser.js';
import { paintSky } from './painted_sky.js';

const SIZE = [320, 180]; // each pixel is the mean of FACTOR x FACTOR
const ORBIT = { camera: 'orbit:30,30,2.2,40', factor: 4 };
// Sponza's own camera sees many edges, at which two rasterizers differ, so it takes more of them. So does its lamp, 17 m
// above the floor, whose light a texel of its shadow cube lets through or not.
const SPONZA = { camera: '0', factor: 8, cases: [['constant', 'full'], ['soft', 'full']], fineCubes: true };
// Without transfer all samples take the mean of the light at their group's light probes, which lambent-demo blends.
// Where bodies hide a sun, lambent-demo asks 32 directions for the share that they leave, which is coarse for a wide one
// and a small body. It gets the soft light as a map, of which bodies hide what they cover.
const MOVED = { ...ORBIT, time: 1.3, openBound: 0.01, painted: true }, CLOUDY = { ...ORBIT, factor: 2, sky: true };
const CASES = [['constant', 'full'], ['soft', 'full'], ['soft', 'shadowed'], ['soft', 'unshadowed']];
const LIGHTS = {
  constant: ['constant:1,0.9,0.8'],
  // A wide sun and a sky have few bands, so lambent-demo needs no key lights for them.
  soft: ['constant:0.3,0.35,0.5', 'sun:60,35,60,2,1.8,1.5'],
};
const BOUND = 0.005;
const percent = (x) => `${(100 * x).toFixed(3)} %`;

// Writes lights as an environment map.
async function paint(name) {
  const path = join(work, `${name}.exr`), { data, width, height } = paintSky(LIGHTS[name]);
  const texture = new DataTexture(data, width, height, RGBAFormat, FloatType);
  writeFileSync(path, await new EXRExporter().parse(texture, { type: FloatType }));
  return path;
}

function picture(bundle, { camera, factor, time }, lights, name, transfer) {
  const path = join(work, `${basename(bundle, '.lmb.glb')}-${name}-${transfer}.exr`);
  execFileSync(join(bin, 'lambent-demo'), [
    bundle, '--camera', camera, '--size', SIZE.map((n) => n * factor).join('x'), '--keys', 'off',
    '--transfer', transfer,
    // What bounces of lamps in the rooms where they stand is left out.
    '--reflection-probes', '0', '--patch-bounces', 'off',
    ...(time === undefined ? [] : ['--time', String(time)]),
    ...lights.flatMap((light) => ['--light', light]), '--headless', path,
  ]);
  return path;
}

test('pictures are those of lambent-demo', { skip, timeout: 900000 }, async (t) => {
  mkdirSync(work, { recursive: true });
  const browser = await launch(t), soft = await paint('soft');
  for (const bundle of list.split(',')) {
    const { page, messages } = await open(t, browser, { '/work/': work, '/bundle/': dirname(resolve(bundle)) });
    await page.waitForFunction('window.lambentTest?.ready');
    const view = {
      sponza: SPONZA, moving: MOVED, lamps: MOVED, bulbs: MOVED, volume: CLOUDY,
    }[basename(bundle, '.lmb.glb')] ?? ORBIT;
    const own = { bundle: `/bundle/${basename(bundle)}`, camera: view.camera, size: SIZE };
    // Mirrors show more of the soft light than few bands hold, by three's environment.
    const reflects = /^(reflecting|lamps|bulbs)/.test(basename(bundle));
    for (const [name, transfer] of view.cases ?? CASES) {
      const lights = view.painted && name === 'soft' ? [soft] : LIGHTS[name];
      const exr = picture(bundle, view, lights, name, transfer), environment = reflects && name === 'soft';
      const result = await page.evaluate((options) => window.lambentTest.render(options), {
        ...own, lights: LIGHTS[name], factor: view.factor, time: view.time, transfer, environment, sky: view.sky,
        fineCubes: view.fineCubes, picture: `/work/${basename(exr)}`,
      });
      await page.screenshot({ path: exr.replace('.exr', '.png') });
      t.diagnostic(`${basename(exr)}: ${percent(result.all)}, beside no edges ${percent(result.inside)}, ` +
        `median of pixels ${percent(result.median)}`);
      const bound = transfer === 'unshadowed' ? view.openBound ?? BOUND : BOUND;
      assert.ok(result.all < bound, `${basename(exr)} differs by ${percent(result.all)}`);
      // three keeps what it draws backgrounds with, and what it filters environments with.
      const { before, after } = result.memory;
      const kept = { geometries: environment || view.sky ? 1 : 0, textures: environment ? 1 : 0 };
      assert.ok(before.geometries > 0 && before.textures > 0);
      assert.deepEqual(after, kept, 'memory is freed on dispose');
    }
    if (view.sky) {
      const seen = { ...own, lights: LIGHTS.soft };
      const { inside } = await page.evaluate((options) => window.lambentTest.fromAfar(options), seen);
      t.diagnostic(`an orthographic camera shows what one far away does, to ${percent(inside)} beside no edges`);
      assert.ok(inside < BOUND);
    }
    if (/^bulbs/.test(basename(bundle))) {
      const { lamps, all } = await page.evaluate((options) => window.lambentTest.lampsHalved(options), own);
      assert.ok(lamps === 1 && all < 1e-3, `${lamps} lamps of half the strength give ${percent(all)} else than half`);
    }
    assert.deepEqual(messages, [], 'the console has neither errors nor warnings');
    await page.close();
  }
});
