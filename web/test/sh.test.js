import assert from 'node:assert/strict';
import test from 'node:test';
import { Matrix4, Quaternion, Vector3 } from 'three';
import { evaluateBasis, projectEquirect, unoccludedTransfer } from '../src/sh.js';
import { gauntTable } from '../src/gaunt.js';
import { lobeBands } from '../src/lobe.js';
import { LightVector } from '../src/light_vector.js';
import { ZonalFactors } from '../src/zonal_factors.js';

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

test('light that meets nothing arrives as it is', () => {
  const { j, k, m, value } = gauntTable(5, 9, 5);
  const light = Float64Array.from({ length: 25 }, (_, i) => Math.cos(5 * i)), arrived = new Float64Array(25);
  for (let t = 0; t < value.length; ++t) // V = 1 has √(4π) in its first band alone
    if (k[t] === 0) arrived[j[t]] += value[t] * Math.sqrt(4 * Math.PI) * light[m[t]];
  arrived.forEach((value, i) => assert.ok(Math.abs(value - light[i]) < 1e-9));
});

test('products of light and visibility are those of the functions', () => {
  const { j, k, m, value } = gauntTable(3, 3, 2); // bands 0..2 hold the whole product of bands 0..1
  const visibility = [0.7, 0.2, -0.4, 0.3], light = [1, -0.6, 0.1, 0.5], product = new Float64Array(9);
  for (let t = 0; t < value.length; ++t) product[j[t]] += value[t] * (visibility[k[t]] ?? 0) * light[m[t]];
  const at = (c, y) => c.reduce((sum, value, i) => sum + value * y[i], 0);
  for (const d of directions) {
    const y = evaluateBasis(3, ...d, []);
    assert.ok(Math.abs(at(product, y) - at(visibility, y) * at(light, y)) < 1e-9);
  }
});

test('zonal factors add up to the function that they factor', () => {
  for (const isotropic of [true, false]) {
    const factors = new ZonalFactors(5, isotropic), coefficients = [], whole = [];
    for (let l = 0; l < 5; ++l)
      for (let n = -l; n <= l; ++n) {
        const value = isotropic && n < 0 ? 0 : Math.sin(7 * l + 3 * n + 1);
        if (!isotropic || n >= 0) coefficients.push(value);
        whole.push(value);
      }
    const weights = factors.factor(coefficients), sum = new Float64Array(25);
    factors.axes.forEach((axis, i) => {
      const y = evaluateBasis(5, ...axis, []);
      for (let l = 0; l < 5; ++l) {
        if (i >= (isotropic ? l + 1 : 2 * l + 1)) continue;
        const weight = weights[(isotropic ? (l * (l + 1)) / 2 : l * l) + i];
        for (let q = l * l; q < (l + 1) ** 2; ++q) sum[q] += weight * y[q];
      }
    });
    whole.forEach((value, q) => assert.ok(Math.abs(value - sum[q]) < 1e-9));
  }
});

test('the lobe of a mirror keeps all bands, and wider ones less', () => {
  assert.ok(lobeBands(0).every((value) => value === 1));
  let before = lobeBands(0);
  for (const roughness of [0.1, 0.3, 0.6, 1]) {
    const bands = lobeBands(roughness);
    assert.ok(Math.abs(bands[0] - 1) < 1e-12);
    for (let l = 1; l < 4; ++l) assert.ok(bands[l] < before[l] && bands[l] <= bands[l - 1]);
    before = bands;
  }
});

test('the lobe of roughness 1 is the clamped cosine', () => {
  // D is even there, so K = max(cos, 0)/π, whose bands are A_l/π.
  [1, 2 / 3, 1 / 4, 0, -1 / 24].forEach((value, l) => assert.ok(Math.abs(lobeBands(1)[l] - value) < 1e-4));
});
