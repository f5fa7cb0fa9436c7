// Holds the types against what the package exports, and compiles programs with them.
import assert from 'node:assert/strict';
import { existsSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { tmpdir } from 'node:os';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import * as lambent from '../src/index.js';

const web = resolve(dirname(fileURLToPath(import.meta.url)), '..');
const types = readFileSync(join(web, 'src/index.d.ts'), 'utf8');

test('types name what the package exports', () => {
  const named = [...types.matchAll(/^export (?:class|function|const) (\w+)/gm)].map(([, name]) => name);
  assert.deepEqual(named.sort(), Object.keys(lambent).sort());
});

test('classes have the members that their types name', () => {
  const scene = new lambent.LambentScene({ groups: [], extension: { groups: [] } }, null);
  const objects = {
    LightVector: new lambent.LightVector(), LambentScene: scene, LambentPlugin: new lambent.LambentPlugin(null),
    KeyLights: new lambent.KeyLights([]),
  };
  for (const [, name, body] of types.matchAll(/^export class (\w+).*?\{\n([^]*?)^\}/gm))
    for (const [, fixed, member] of body.matchAll(/^  (static )?(?:readonly )?(\w+)[(:?]/gm))
      if (member !== 'constructor')
        assert.ok(member in (fixed ? lambent[name] : objects[name]), `${name}.${member} is there`);
});

// A program that uses most of the package as docs/web.md does.
const PROGRAM = `
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { KeyLights, LambentPlugin, LambentScene, LightVector, loadProgressively, splitKeyLights } from 'lambent-three';

const loader = new GLTFLoader().register((parser) => new LambentPlugin(parser));
export async function show(scene: THREE.Scene, map: THREE.DataTexture): Promise<LambentScene> {
  const gltf = await loadProgressively(loader, 'room.lmb.glb', { onPlane: (done, all) => console.log(done / all) });
  const lambent: LambentScene = gltf.userData.lambent;
  const { rest, key, suns, environment } = splitKeyLights(map, { order: 5 });
  lambent.light = rest.rotateY(0.5).add(LightVector.constant(0.1, 0.1, 0.1)).multiplyScalar(2);
  lambent.keyLight = key.rotate(new THREE.Euler(0, 0.5, 0));
  lambent.transfer = 'shadowed';
  lambent.setLamp(0, 1, new THREE.Color(1, 0.5, 0));
  const lights: THREE.Group = new KeyLights(suns).fit(new THREE.Box3().setFromObject(gltf.scene), gltf.scene);
  scene.environment = environment;
  scene.add(gltf.scene, lights);
  const changed: boolean = lambent.update(), [red]: number[] = lambent.light.radiance({ x: 0, y: 1, z: 0 });
  return changed && red > 0 ? lambent : lambent;
}
`;
// Uses that are wrong, each with what the compiler has to say of it.
const WRONG = [
  [`lambent.transfer = 'none';`, /'"none"' is not assignable/],
  [`lambent.light = map;`, /type 'LightVector'/],
  [`lambent.sky = rest;`, /Property 'sky' does not exist/],
  [`LightVector.constant(1);`, /Expected 3-4 arguments/],
  [`lambent.disposed = true;`, /read-only/],
];
const typescript = ['typescript', '@types/three'].every((name) => existsSync(join(web, 'node_modules', name)));

test('a program in TypeScript compiles, and wrong ones do not',
  { skip: typescript ? false : 'typescript or @types/three is not in node_modules (npm ci)' }, async (t) => {
    const { default: ts } = await import('typescript');
    const folder = mkdtempSync(join(tmpdir(), 'lambent-types-'));
    t.after(() => rmSync(folder, { recursive: true }));
    symlinkSync(join(web, 'node_modules'), join(folder, 'node_modules'));
    const write = (name, text) => {
      writeFileSync(join(folder, name), text);
      return join(folder, name);
    };
    const spot = '  lambent.setLamp(';
    const right = write('right.ts', PROGRAM);
    const wrong = WRONG.map(([line], i) => write(`wrong${i}.ts`, PROGRAM.replace(spot, `  ${line}\n${spot}`)));
    const program = ts.createProgram([right, ...wrong], {
      strict: true, noEmit: true, target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.ESNext,
      moduleResolution: ts.ModuleResolutionKind.Bundler, lib: ['lib.es2022.d.ts', 'lib.dom.d.ts'], types: [],
      preserveSymlinks: true, baseUrl: folder, paths: { 'lambent-three': [join(web, 'src/index.d.ts')] },
    });
    const messages = (file) => ts.getPreEmitDiagnostics(program, program.getSourceFile(file))
      .map((d) => ts.flattenDiagnosticMessageText(d.messageText, '\n'));
    assert.deepEqual(messages(right), []);
    assert.deepEqual(messages(join(web, 'src/index.d.ts')), []);
    WRONG.forEach(([line, expected], i) => {
      const said = messages(wrong[i]);
      assert.equal(said.length, 1, `${line} ${said}`);
      assert.match(said[0], expected);
    });
  });
