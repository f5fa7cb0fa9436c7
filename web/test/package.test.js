// Packs what users install, and imports it in a project of its own.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readdirSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';

const web = resolve(dirname(fileURLToPath(import.meta.url)), '..');

test('the packed package holds all that it imports', (t) => {
  const folder = mkdtempSync(join(tmpdir(), 'lambent-package-')), modules = join(folder, 'node_modules');
  t.after(() => rmSync(folder, { recursive: true }));
  execFileSync('npm', ['pack', '--silent', '--pack-destination', folder], { cwd: web });
  const [packed] = readdirSync(folder).filter((name) => name.endsWith('.tgz'));
  mkdirSync(join(modules, 'lambent-three'), { recursive: true });
  execFileSync('tar', ['xzf', join(folder, packed), '-C', join(modules, 'lambent-three'), '--strip-components=1']);
  for (const name of ['three', 'fzstd']) symlinkSync(join(web, 'node_modules', name), join(modules, name));
  writeFileSync(join(folder, 'main.mjs'),
    `import * as lambent from 'lambent-three'; console.log(Object.keys(lambent).sort().join(' '));`);
  const names = execFileSync('node', ['main.mjs'], { cwd: folder, encoding: 'utf8' }).trim().split(' ');
  assert.deepEqual(names, [
    'KeyLights', 'LambentPlugin', 'LambentScene', 'LightVector', 'MAX_ORDER', 'loadProgressively', 'splitKeyLights']);
});
