// Runs lambent view as a user does: the page that it serves shows the bundle, nothing comes from elsewhere, an
// interrupt ends it, and what is wrong is said in one line.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import { chmodSync, copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import test from 'node:test';
import { listedFiles } from '../../site/listed_files.js';
import { bin, launch, list, newPage, skip, web, work } from './browser.js';

const map = process.env.LAMBENT_TEST_MAP;
const options = { skip: skip || (map ? false : 'LAMBENT_TEST_MAP is not set'), timeout: 600000 };
const lambent = () => join(bin, 'lambent'), bundle = () => resolve(list.split(',')[0]);

// Starts it and returns the process and the address that it prints.
async function view(t, words, environment = {}, program = lambent()) {
  const process_ = spawn(program, ['view', bundle(), ...words], {
    stdio: ['ignore', 'pipe', 'pipe'], env: { ...process.env, DISPLAY: '', WAYLAND_DISPLAY: '', ...environment },
  });
  t.after(() => process_.kill('SIGKILL'));
  let said = '';
  process_.stderr.on('data', (text) => (said += text));
  const [line] = await Promise.race([once(process_.stdout, 'data'), once(process_, 'exit').then(() => [''])]);
  const address = /^(http:\/\/127\.0\.0\.1:\d+\/) shows /.exec(String(line))?.[1];
  assert.ok(address, `${line}${said}`);
  return { process: process_, address, said: () => said };
}

async function interrupt({ process }) {
  const ended = once(process, 'exit');
  process.kill('SIGINT');
  assert.deepEqual(await ended, [0, null], 'an interrupt ends it with exit code 0');
}

test('lambent view shows a bundle under a map', options, async (t) => {
  mkdirSync(work, { recursive: true });
  const viewing = await view(t, ['--light', resolve(map), '--no-browser']), browser = await launch(t);
  const page = await newPage(browser), messages = [], elsewhere = [];
  page.on('console', (m) => ['error', 'warn'].includes(m.type()) && messages.push(m.text()));
  page.on('pageerror', (error) => messages.push(String(error)));
  page.on('request', (request) => {
    const url = request.url();
    if (!/^(blob|data):/.test(url) && !url.startsWith(viewing.address)) elsewhere.push(url);
  });
  page.on('requestfailed', (request) => {
    const { errorText } = request.failure(); // a busy Chromium aborts some; the page must show the bundle all the same
    if (errorText !== 'net::ERR_ABORTED') messages.push(`${request.url()}: ${errorText}`);
  });
  await page.setViewport({ width: 640, height: 360 });
  await page.goto(viewing.address);
  await page.waitForFunction('window.lambentViewer');
  await page.evaluate(() => window.lambentViewer.opened);
  await page.waitForFunction(() => /light [0-9.]+ ms/.test(document.getElementById('status').value));
  assert.ok(await page.evaluate(() => document.getElementById('hint').hidden), 'the bundle is shown');
  assert.equal(await page.evaluate(() => /plain glTF/.test(document.getElementById('status').value)), false);
  await page.screenshot({ path: join(work, 'view.png') });
  assert.deepEqual(messages, []);
  assert.deepEqual(elsewhere, []);
  await interrupt(viewing);
});

test('lambent view opens the browser that xdg-open knows', options, async (t) => {
  const folder = join(work, 'programs'), asked = join(folder, 'asked');
  mkdirSync(folder, { recursive: true });
  const script = `printf %s "$*" > '${asked}.part' && mv '${asked}.part' '${asked}'`;
  writeFileSync(join(folder, 'xdg-open'), `#!/bin/sh\n${script}\n`);
  chmodSync(join(folder, 'xdg-open'), 0o755);
  const viewing = await view(t, [], { PATH: `${folder}:${process.env.PATH}`, DISPLAY: ':9' });
  while (!existsSync(asked)) await sleep(10); // the test's own limit ends this
  assert.equal(readFileSync(asked, 'utf8'), viewing.address);
  await interrupt(viewing);
  assert.equal(viewing.said(), '');

  const without = await view(t, []);
  await interrupt(without);
  assert.match(without.said(), /^lambent: no browser can be opened here;[^\n]*\n$/);
});

test('lambent view runs where it is installed, and says in one line that its files are not', options, async (t) => {
  const prefix = join(work, 'installed'), script = resolve(web, '../cmake/package/web.cmake');
  mkdirSync(join(prefix, 'bin'), { recursive: true });
  copyFileSync(lambent(), join(prefix, 'bin/lambent'));
  const program = join(prefix, 'bin/lambent');
  const lost = spawnSync(program, ['view', bundle(), '--no-browser'], { encoding: 'utf8' });
  assert.equal(lost.status, 1, lost.stderr);
  assert.match(lost.stderr, /^lambent: [^\n]*share\/lambent\/web[^\n]*npm ci[^\n]*\n$/);

  execFileSync('cmake', [`-DCMAKE_INSTALL_PREFIX=${prefix}`, `-DWEB=${web}`, '-P', script], { stdio: 'ignore' });
  const { address } = await view(t, ['--no-browser'], {}, program);
  for (const file of listedFiles(web)) {
    const answer = await fetch(new URL(file, address));
    assert.equal(answer.status, 200, file);
    assert.ok(Buffer.from(await answer.arrayBuffer()).equals(readFileSync(join(web, file))), file);
  }
});

test('lambent view says in one line what is wrong', options, async (t) => {
  const { address } = await view(t, ['--no-browser']);
  for (const [words, line] of [
    [[bundle(), '--light', 'sky.png'], /sky\.png: is no environment map/],
    [[bundle(), '--light', 'lost.hdr'], /lost\.hdr: /],
    [[bundle(), '--no-browser', '--port', new URL(address).port], /cannot be listened at/],
  ]) {
    const ended = spawnSync(lambent(), ['view', ...words], { encoding: 'utf8' });
    assert.equal(ended.status, 1, ended.stderr);
    assert.match(ended.stderr, /^lambent: [^\n]*\n$/);
    assert.match(ended.stderr, line);
  }
});
