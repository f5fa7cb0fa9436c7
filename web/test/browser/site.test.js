// Opens the site from a plain file server on a screen of a desk and of a phone, dark and light: every picture on it is
// live (on the phone the first, as all are one code), and its sliders change it. LAMBENT_TEST_SITE is the folder that
// web/site/make.js wrote.
import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import test from 'node:test';
import { launch, open, skip, work } from './browser.js';

const site = process.env.LAMBENT_TEST_SITE;
const options = { skip: skip || (site ? false : 'LAMBENT_TEST_SITE is not set'), timeout: 600000 };
const ENDS = [[[0, 'max']], [[0, 'min']], [[0, 'max'], [1, 'min']]]; // one band does not turn, so bands come first
const SCREENS = [['desk', [1280, 800], 'light', 5, ENDS], ['phone', [390, 844], 'dark', 1, ENDS.slice(0, 1)]];

// Scrolls to a figure and waits until its picture is live.
async function shown(page, figure) {
  await figure.scrollIntoView();
  await page.waitForFunction((each) => each.matches('.shown, :has(.failed)'), {}, figure);
  assert.equal(await figure.evaluate((each) => each.querySelector('.failed')?.textContent ?? ''), '');
}

async function put(figure, slider, value) {
  await figure.evaluate((each, at, to) => {
    const input = each.querySelectorAll('input')[at];
    input.value = input[to];
    input.dispatchEvent(new Event('input', { bubbles: true }));
    return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  }, slider, value);
}

for (const [name, size, scheme, live, ends] of SCREENS)
  test(`pictures of the site are live (${name})`, options, async (t) => {
    mkdirSync(work, { recursive: true });
    const browser = await launch(t), { page, messages } = await open(t, browser, { '/': site }, '/index.html', size);
    await page.emulateMediaFeatures([{ name: 'prefers-color-scheme', value: scheme }]);
    const figures = await page.$$('figure.live');
    assert.equal(figures.length, 5);
    for (const figure of figures.slice(0, live)) {
      await shown(page, figure);
      const canvas = await figure.$('canvas'), pictures = [await canvas.screenshot()];
      for (const steps of ends) {
        for (const [slider, value] of steps) await put(figure, slider, value);
        pictures.push(await canvas.screenshot());
      }
      const kind = await figure.evaluate((each) => each.dataset.live);
      for (let i = 0; i < pictures.length; ++i)
        for (let j = 0; j < i; ++j)
          assert.notEqual(Buffer.compare(pictures[i], pictures[j]), 0, `${kind}: ${i} and ${j} are one picture`);
      await put(figure, 1, 'defaultValue');
      await put(figure, 0, 'defaultValue');
    }
    await page.evaluate(() => scrollTo(0, 0));
    await page.screenshot({ path: join(work, `site-${name}.png`), fullPage: true });
    const pages = readdirSync(site).filter((file) => file.endsWith('.html'));
    for (const file of pages) {
      if (file !== 'index.html') await page.goto(new URL(file, page.url()).href);
      assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), `${file} fits`);
      if (file !== 'index.html') await page.screenshot({ path: join(work, `site-${name}-${file}.png`) });
    }
    assert.deepEqual(messages, []);
  });

test('links of the site lead to pages and headings', options, () => {
  const pages = readdirSync(site).filter((file) => file.endsWith('.html'));
  const text = Object.fromEntries(pages.map((file) => [file, readFileSync(join(site, file), 'utf8')]));
  let links = 0;
  for (const file of pages)
    for (const [, address] of text[file].matchAll(/(?:href|src)="((?!https?:|data:)[^"]*)"/g)) {
      const [path, anchor] = address.split('?')[0].split('#'), there = path || file;
      assert.ok(existsSync(join(site, there)), `${file}: ${address}`);
      if (anchor) assert.ok(text[there].includes(`id="${anchor}"`), `${file}: ${address}`);
      ++links;
    }
  assert.ok(links > 30);
});
