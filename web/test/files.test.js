// Holds viewer/files.txt, which lambent view and packages go by, against what the viewer imports.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { dirname, join, normalize } from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { listedFiles } from '../site/listed_files.js';

const web = join(dirname(fileURLToPath(import.meta.url)), '..');
const there = existsSync(join(web, 'node_modules/three'));

// Returns all files that a module leads to by its imports, and by the loaders' paths of decoders.
function reached(first, map) {
  const found = new Set(), wanted = [first];
  while (wanted.length > 0) {
    const file = wanted.pop();
    if (found.has(file)) continue;
    found.add(file);
    const text = readFileSync(join(web, file), 'utf8');
    for (const [, word] of text.matchAll(/^(?:import|export|\})[^;'"]*?from\s+['"]([^'"]+)['"]/gm)) {
      const prefix = Object.keys(map).filter((p) => word === p || (p.endsWith('/') && word.startsWith(p))).at(-1);
      wanted.push(prefix ? normalize(join('viewer', map[prefix] + word.slice(prefix.length)))
        : normalize(join(dirname(file), word)));
    }
  }
  return found;
}

test('files.txt names what the viewer loads, and no module besides',
  { skip: there ? false : 'node_modules is not here (npm ci)' }, () => {
    const page = readFileSync(join(web, 'viewer/index.html'), 'utf8');
    const { imports } = JSON.parse(/<script type="importmap">([^]*?)<\/script>/.exec(page)[1]);
    const modules = reached('viewer/viewer.js', imports), listed = new Set(listedFiles(web));
    for (const module of modules) assert.ok(listed.has(module), `${module} is not listed`);
    assert.ok(modules.size > 20, `${modules.size} modules`);
    const besides = [...listed].filter((file) => /\.m?js$/.test(file) && !modules.has(file));
    // The decoder is no module: DRACOLoader makes a worker of it.
    assert.deepEqual(besides, ['node_modules/three/examples/jsm/libs/draco/gltf/draco_wasm_wrapper.js']);
  });
