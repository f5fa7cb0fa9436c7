// Starts Chromium with a software renderer and opens the page of these tests.
import { existsSync } from 'node:fs';
import { dirname, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { serve } from './server.js';

export const web = resolve(dirname(fileURLToPath(import.meta.url)), '../..');
export const { LAMBENT_BIN: bin, LAMBENT_TEST_BUNDLES: list, LAMBENT_TEST_WORK: work } = process.env;
const chromium = process.env.CHROMIUM ?? '/usr/bin/chromium';
export const skip = !bin || !list || !work ? 'LAMBENT_BIN, LAMBENT_TEST_BUNDLES or LAMBENT_TEST_WORK is not set'
  : existsSync(chromium) ? false : `there is no ${chromium}`;

export async function launch(t) {
  const { default: puppeteer } = await import('puppeteer-core');
  const browser = await puppeteer.launch({
    executablePath: chromium,
    args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist'],
    protocolTimeout: 600000,
  });
  t.after(() => browser.close());
  return browser;
}

/** Opens an empty page without limits of time: a busy machine is slow, and each test has a limit of its own. */
export async function newPage(browser) {
  const page = await browser.newPage();
  page.setDefaultTimeout(0);
  return page;
}

/** Opens a page of a server for some folders. `messages` collects warnings and errors of the console. */
export async function open(t, browser, folders, path = '/web/test/browser/page.html', size = [320, 360]) {
  const { server, requests, address } = await serve({ '/web/': web, ...folders });
  t.after(() => server.close());
  const page = await newPage(browser), messages = [];
  page.on('console', (m) => ['error', 'warn'].includes(m.type()) && messages.push(m.text()));
  page.on('pageerror', (error) => messages.push(String(error)));
  await page.setViewport({ width: size[0], height: size[1] });
  await page.goto(address + path);
  return { page, messages, requests };
}
