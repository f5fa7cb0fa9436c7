// Opens the viewer on a screen of a desk and of a phone, works its controls, and looks for errors.
import assert from 'node:assert/strict';
import { mkdirSync } from 'node:fs';
import { basename, dirname, join, resolve } from 'node:path';
import test from 'node:test';
import { launch, list, open, skip, work } from './browser.js';

const map = process.env.LAMBENT_TEST_MAP;

test('the viewer shows a bundle', { skip: skip || (map ? false : 'LAMBENT_TEST_MAP is not set'), timeout: 600000 }, async (t) => {
  mkdirSync(work, { recursive: true });
  const browser = await launch(t), file = resolve(list.split(',')[1]);
  const path = `/web/viewer/index.html?bundle=/bundle/${basename(file)}&light=/map/${basename(map)}`;
  for (const [name, size] of [['desk', [800, 450]], ['phone', [360, 640]]]) {
    const { page, messages } = await open(t, browser,
      { '/bundle/': dirname(file), '/map/': dirname(resolve(map)) }, path, size);
    await page.waitForFunction('window.lambentViewer');
    await page.evaluate(() => window.lambentViewer.opened);
    for (const word of ['unshadowed', 'shadowed', 'full']) {
      await page.click(`input[value=${word}]`);
      await page.waitForFunction(() => /light [0-9.]+ ms/.test(document.getElementById('status').value));
      await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    }
    const fits = await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);
    assert.ok(fits, 'nothing is wider than the screen');
    t.diagnostic(`${name}: ${await page.evaluate(() => document.getElementById('status').value)}`);
    await page.screenshot({ path: join(work, `viewer-${name}.png`) });
    assert.deepEqual(messages, []);
    await page.close();
  }
});
