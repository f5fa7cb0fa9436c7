import assert from 'node:assert/strict';
import test from 'node:test';
import { Matrix4, Quaternion, Vector3 } from 'three';
import { evaluateBasis, projectEquirect, unoccludedTransfer } from '../src/sh.js';
import { LightVector } from '../src/light_vector.js';

const directions = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.48, -0.6, 0.64], [-0.36, 0.48, -0.8]];

test('the basis has the signs of docs/conventions.md', () => {
  for (const [x, y, z] of directions) {
    const b = evaluateBasis(3, x, y, z, []);
    const expected = [
      0.282095, 0.488603 * y, 0.488603 * z, 0.488603 * x, 1.092548 * x * y, 1.092548 * y * z,
      0.315392 * (3 * z * z - 1), 1.092548 * x * z, 0.546274 * (x * x - y * y),
    ];
    expected.forEach((value, i) => assert.ok(Math.abs(b[i] - value) < 1e-5, `${i}`));
  }
});

test('the basis is orthonormal up to eight bands', () => {
  const width = 32, height = 160, y = new Float64Array(64), gram = new Float64Array(64 * 64);
  for (let row = 0; row < height; ++row) {
    const z = (2 * (row + 0.5)) / height - 1, s = Math.sqrt(1 - z * z), weight = (4 * Math.PI) / (width * height);
    for (let column = 0; column < width; ++column) {
      const phi = (2 * Math.PI * column) / width;
      evaluateBasis(8, s * Math.cos(phi), s * Math.sin(phi), z, y);
      for (let i = 0; i < 64; ++i) for (let j = 0; j <= i; ++j) gram[64 * i + j] += weight * y[i] * y[j];
    }
  }
  // Even steps of z err by half a percent in the highest band.
  for (let i = 0; i < 64; ++i)
    for (let j = 0; j <= i; ++j) assert.ok(Math.abs(gram[64 * i + j] - (i === j ? 1 : 0)) < 0.02, `${i} ${j}`);
});

test('a picture of a disc projects to the closed form', () => {
  const towards = new Vector3(0.6, 0.64, -0.48), radius = 0.7;
  const rgb = projectEquirect(5, 128, 64, (column, row) => {
    const theta = (Math.PI * (row + 0.5)) / 64, phi = ((column + 0.5) / 128 - 0.5) * 2 * Math.PI;
    const d = new Vector3(Math.sin(theta) * Math.cos(phi), Math.cos(theta), Math.sin(theta) * Math.sin(phi));
    return d.dot(towards) > Math.cos(radius) ? [1, 0.5, 0] : [0, 0, 0];
  });
  const expected = LightVector.disc(towards, radius, { r: 1, g: 0.5, b: 0 }, 5);
  expected.rgb.forEach((value, i) => assert.ok(Math.abs(value - rgb[i]) < 0.02, `${i}`));
});

test('turned light is the light in turned directions', () => {
  const light = new LightVector(8, Float64Array.from({ length: 192 }, (_, i) => Math.sin(3 * i * i + i)));
  const turn = new Quaternion().setFromAxisAngle(new Vector3(0.3, -0.8, 0.5).normalize(), 2.1);
  const turned = light.rotate(turn);
  for (const d of directions) {
    const s = new Vector3(...d), before = s.clone().applyQuaternion(turn.clone().invert());
    light.radiance(before).forEach((value, c) => assert.ok(Math.abs(value - turned.radiance(s)[c]) < 1e-9));
  }
  const matrix = new Matrix4().makeRotationFromQuaternion(turn);
  light.rotate(matrix).rgb.forEach((value, i) => assert.ok(Math.abs(value - turned.rgb[i]) < 1e-12));
});

test('rotateY takes +Z towards +X', () => {
  const light = LightVector.disc(new Vector3(0, 0, 1), 0.3, { r: 1, g: 1, b: 1 }, 5).rotateY(Math.PI / 2);
  const expected = LightVector.disc(new Vector3(1, 0, 0), 0.3, { r: 1, g: 1, b: 1 }, 5);
  light.rgb.forEach((value, i) => assert.ok(Math.abs(value - expected.rgb[i]) < 1e-9));
});

test('light of radiance 1 from everywhere gives E/π = 1 in the open', () => {
  const { rgb } = LightVector.constant(1, 2, 3, 8), t = unoccludedTransfer(8, 0.6, 0, 0.8, new Float64Array(64));
  for (let c = 0; c < 3; ++c) {
    const sum = t.reduce((s, value, i) => s + value * rgb[3 * i + c], 0);
    assert.ok(Math.abs(sum - (c + 1)) < 1e-9);
  }
});
