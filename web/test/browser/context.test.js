// Loses the context of WebGL, as happens where a phone's browser goes to sleep or a driver is reset, and looks whether
// the light comes back.
import assert from 'node:assert/strict';
import { basename, dirname, resolve } from 'node:path';
import test from 'node:test';
import { launch, list, open, skip } from './browser.js';

test('light comes back with a lost context', { skip, timeout: 300000 }, async (t) => {
  const browser = await launch(t);
  for (const bundle of list.split(',').filter((one) => /hello|reflecting|lamps|volume/.test(basename(one)))) {
    const { page, messages } = await open(t, browser, { '/bundle/': dirname(resolve(bundle)) });
    await page.waitForFunction('window.lambentTest?.ready');
    const result = await page.evaluate((options) => window.lambentTest.loseContext(options), {
      bundle: `/bundle/${basename(bundle)}`, lights: ['constant:0.5,0.5,0.6'], camera: 'orbit:30,30,2.2,40',
      size: [160, 90], time: 1.3,
    });
    assert.ok(result.lit, 'there is light');
    assert.equal(result.error, 0);
    assert.ok(result.all < 1e-6, `${basename(bundle)}: it is ${result.all} off`);
    assert.deepEqual(result.memory, { geometries: 0, textures: 0 }, 'memory is freed on dispose');
    // Where something is disposed of, three also deletes what it had in the lost context, and Chromium warns of that.
    const own = messages.filter((one) => !/^WebGL: INVALID_OPERATION: delete\w*: object does not belong/.test(one));
    assert.deepEqual(own, [], 'the console has no other warnings');
    await page.close();
  }
});
