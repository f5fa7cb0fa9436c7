// Holds directional lights of the glTF: their light, and that their shadow maps see the scene.
import assert from 'node:assert/strict';
import test from 'node:test';
import { BoxGeometry, DirectionalLight, Group, Mesh, MeshLambertMaterial, Vector3 } from 'three';
import { unoccludedTransfer } from '../src/sh.js';
import { SceneSuns } from '../src/suns.js';

// A box about (5, 1, -3), and a light on a node far away that shines from (0.6, 0.8, 0).
function place() {
  const root = new Group(), box = new Mesh(new BoxGeometry(2, 1, 4), new MeshLambertMaterial());
  box.position.set(5, 1, -3);
  const light = new DirectionalLight(0xffffff, 3);
  light.position.set(-40, 7, 2);
  light.target.position.set(-0.6, -0.8, 0);
  light.add(light.target);
  root.add(box, light);
  root.updateMatrixWorld(true);
  return { root, box, light, suns: new SceneSuns([light], root) };
}

test('light of a sun is its irradiance, and dark suns give none', () => {
  const { light, suns } = place(), transfer = unoccludedTransfer(5, 0.6, 0.8, 0, new Float64Array(25));
  assert.equal(suns.follow(), true);
  const received = suns.light.rgb.reduce((sum, value, i) => sum + (i % 3 === 0 ? value * transfer[Math.floor(i / 3)] : 0), 0);
  assert.ok(Math.abs(received - 3 / Math.PI) < 0.03, `${received}`); // E/π, as five bands know it
  assert.equal(suns.follow(), false, 'nothing changed');
  light.visible = false;
  assert.equal(suns.follow(), true);
  assert.equal(suns.light, null);
});

test('the shadow map of a sun holds the scene wherever its node stands', () => {
  const { root, box, light, suns } = place();
  assert.ok(box.castShadow && box.receiveShadow && light.castShadow);
  for (const turn of [0, 1, 2.5]) {
    light.rotation.set(0.3 * turn, turn, 0);
    root.updateMatrixWorld(true);
    suns.follow();
    light.shadow.updateMatrices(light);
    const { camera } = light.shadow, spread = [0, 1, 2].map(() => []);
    for (const x of [-1, 1])
      for (const y of [-0.5, 0.5])
        for (const z of [-2, 2])
          new Vector3(5 + x, 1 + y, -3 + z).applyMatrix4(camera.matrixWorldInverse).applyMatrix4(camera.projectionMatrix)
            .toArray().forEach((value, axis) => spread[axis].push(value));
    for (const values of spread) {
      assert.ok(values.every((value) => Math.abs(value) < 1), `turn ${turn}`);
      assert.ok(Math.abs(Math.min(...values) + Math.max(...values)) < 1e-5, 'in the middle');
    }
  }
});
