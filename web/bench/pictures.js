#!/usr/bin/env node
// Draws the pictures of the web in docs/pictures in Chromium: each live picture of the site as it begins, and the viewer
// on a screen of a desk and of a phone.
//     node web/bench/pictures.js SITE docs/pictures
import { join, resolve } from 'node:path';
import { launch, open } from '../test/browser/browser.js';

const [site, output] = process.argv.slice(2).map((path) => resolve(path));
if (!output) {
  console.error('pictures.js: SITE and a folder for pictures are wanted; web/site/make.js makes SITE');
  process.exit(2);
}
const closings = [], t = { after: (close) => closings.unshift(close) }, jpeg = { type: 'jpeg', quality: 82 };
const browser = await launch(t);
try {
  // Still pictures stand where a live one is not loaded yet, so an error about one that is not drawn yet is none.
  const { page } = await open(t, browser, { '/': site }, '/index.html', [728, 800]);
  for (const figure of await page.$$('figure.live')) {
    await figure.scrollIntoView();
    await page.waitForFunction((each) => each.matches('.shown, :has(.failed)'), {}, figure);
    const kind = await figure.evaluate((each) => each.dataset.live);
    await (await figure.$('.frame')).screenshot({ ...jpeg, path: join(output, `live-${kind}.jpg`) });
  }
  await page.close();
  const address = '/viewer/index.html?bundle=../bundles/gallery.lmb.glb&light=../light/sky.hdr';
  for (const [name, size] of [['desk', [960, 540]], ['phone', [360, 640]]]) {
    const { page: viewer } = await open(t, browser, { '/': site }, address, size);
    await viewer.waitForFunction('window.lambentViewer');
    await viewer.evaluate(() => window.lambentViewer.opened);
    await viewer.waitForFunction(() => /light [0-9.]+ ms/.test(document.getElementById('status').value));
    await viewer.screenshot({ ...jpeg, path: join(output, `viewer-${name}.jpg`) });
    await viewer.close();
  }
} finally {
  for (const close of closings) await close();
}
