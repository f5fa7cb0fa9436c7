// Holds what light probes see against closed forms, and what capture proxies send out against decoded transfer.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Matrix4, Vector3 } from 'three';
import { openBundle } from './bundle_file.js';
import { boxesMeet } from '../src/boxes.js';
import { TEXELS, hiddenPeak, lookAround, projectTexels, texelsOf } from '../src/capture_cube.js';
import { decodeTransfer } from '../src/codebook.js';
import { Group } from '../src/group.js';
import { hidesLamp } from '../src/lamp_shadows.js';
import { LightVector } from '../src/light_vector.js';
import { ProxyLight } from '../src/proxy_light.js';

const COUNT = 25, path = process.env.LAMBENT_TEST_BUNDLE, skip = path ? false : 'LAMBENT_TEST_BUNDLE is not set';
const sumOf = ({ rows }, i) => rows.reduce((sum, value, at) => sum + (at % COUNT === i ? value : 0), 0);
const look = (triangles, frontOnly = false) => lookAround(triangles.flat(2), triangles.map(() => frontOnly), COUNT);

// The twelve triangles of a box about the probe, seen from inside.
function room() {
  const list = [];
  for (let axis = 0; axis < 3; ++axis)
    for (const side of [-2, 3]) {
      const at = (u, v) => [0, 1, 2].map((k) => (k === axis ? side : k === (axis + 1) % 3 ? u : v));
      const [a, b, c, d] = [at(-2, -2), at(3, -2), at(3, 3), at(-2, 3)];
      list.push(...(side < 0 ? [[a, b, c], [a, c, d]] : [[a, c, b], [a, d, c]]));
    }
  return list;
}
const turnedAway = ([a, b, c]) => [a, c, b];

test('a closed room of even radiance is even light, and hides the sky', () => {
  const view = look(room());
  assert.ok(view.hidden.every((share) => share === 1));
  assert.ok(Math.abs(sumOf(view, 0) - Math.sqrt(4 * Math.PI)) < 1e-6);
  for (let i = 1; i < COUNT; ++i) assert.ok(Math.abs(sumOf(view, i)) < 1e-6, `coefficient ${i}`);
});

test('a triangle has its solid angle', () => {
  const corners = [[1, 0.3, -0.4], [-0.2, 1.1, -0.5], [0.3, 0.2, 1.4]].map((p) => new Vector3(...p));
  const [a, b, c] = corners, [la, lb, lc] = corners.map((p) => p.length());
  const volume = a.dot(b.clone().cross(c)); // Van Oosterom and Strackee 1983
  const angle = 2 * Math.atan2(Math.abs(volume), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  const triangle = corners.map((p) => p.toArray()), view = look([volume < 0 ? triangle : turnedAway(triangle)]);
  assert.ok(Math.abs(sumOf(view, 0) / 0.28209479 / angle - 1) < 5e-3);
});

test('surfaces are black from behind, or not there', () => {
  const black = look(room().map(turnedAway)), open = look(room().map(turnedAway), true);
  assert.equal(black.indices.length, 0);
  assert.ok(black.hidden.every((share) => share === 1));
  assert.ok(open.hidden.every((share) => share === 0));
});

test('what is nearer hides what is behind it', () => {
  const far = room().map((triangle) => triangle.map((p) => p.map((x) => 2 * x)));
  const { indices } = look([...far, ...room()]);
  assert.ok(indices.length > 0 && indices.every((t) => t >= far.length));
});

test('texels bring light back as it was', () => {
  const light = LightVector.constant(1, 2, 3).add(LightVector.disc(new Vector3(1, 2, -1), 1, { r: 3, g: 2, b: 1 }));
  const all = new Float32Array(TEXELS).fill(1), texels = texelsOf(light);
  const through = projectTexels(texels, COUNT), whole = projectTexels(texels, COUNT, all);
  const norm = (values) => Math.hypot(...values);
  assert.ok(norm(light.rgb.map((value, i) => through[i] - value)) < 2e-3 * norm(light.rgb));
  assert.deepEqual(whole, through);
});

test('a sun is hidden by what stands before it, and by nothing else', () => {
  const sun = texelsOf(LightVector.disc(new Vector3(1, 0.4, 0.2), 0.01, { r: 1e4, g: 1e4, b: 1e4 }));
  const before = (x) => look([[[x, -1, -1], [x, 2, -1], [x, 0.5, 2]], [[x, -1, -1], [x, 0.5, 2], [x, 2, -1]]], true).hidden;
  const floor = look([[[-99, -0.01, -99], [0, -0.01, 99], [99, -0.01, -99]]], true).hidden;
  assert.ok(hiddenPeak(sun, before(1)) > 0.95);
  assert.ok(hiddenPeak(sun, before(-1)) < 1e-3);
  assert.ok(floor.some((share) => share > 0) && hiddenPeak(sun, floor) < 0.02);
});

test('boxes meet where they overlap', () => {
  const low = [-1, -1, -1], high = [1, 1, 1], at = (x, turn) => new Matrix4().makeRotationZ(turn).setPosition(x, 0, 0);
  assert.ok(boxesMeet(low, high, at(0, 0), low, high, at(1.9, 0)));
  assert.ok(!boxesMeet(low, high, at(0, 0), low, high, at(2.1, 0)));
  assert.ok(boxesMeet(low, high, at(0, 0), low, high, at(2.3, Math.PI / 4)));
});

test('a body hides a lamp behind it, and none before it', () => {
  const positions = [0, -1, -1, 0, 1, -1, 0, 0, 1];
  const proxy = { positions, triangles: [{ corners: [0, 1, 2] }], levels: [{ first: 0, count: 1 }] };
  const body = { proxy, centre: new Vector3(), radius: 1.5 }, place = new Matrix4().makeTranslation(2, 0, 0);
  const hides = (x, y) => hidesLamp(body, 0, place, new Vector3(), new Vector3(x, y, 0));
  assert.deepEqual([hides(4, 0), hides(1, 0), hides(4, 4), hides(-4, 0)], [true, false, false, false]);
});

test('proxies send out what the transfer of their samples brings', { skip }, async () => {
  const bundle = openBundle(path), json = bundle.groups[0], group = new Group(json);
  const proxy = await bundle.captureProxy(json);
  await group.load(bundle);
  for (const { transfer, plane, index } of group.planes(bundle)) transfer.setPlane(index, await bundle.plane(plane));
  const sky = LightVector.constant(1, 0.8, 0.6).add(LightVector.disc(new Vector3(1, 2, 1), 0.8, { r: 3, g: 2, b: 1 }));
  const sender = new ProxyLight(proxy, group);
  sender.shade([sky], json.lights.map(({ color }) => color), 'full');
  const cells = group.cells.filter((cell) => cell.json.kind === 'surface');
  assert.ok(cells.every((cell) => cell.run.outputs === 1 && cell.transfers.length === 1), 'diffuse, without lamps');
  const decode = ({ shape, codebook, clusterOf, planes }) => decodeTransfer(shape, codebook, clusterOf, planes);
  const decoded = new Map(cells.map(({ transfers: [transfer] }) => [transfer, decode(transfer)]));
  let lit = 0;
  proxy.triangles.forEach(({ entries }, t) => [0, 1, 2].forEach((c) => {
    let sum = 0;
    for (const { sample, reflectance } of entries) {
      const { json: { firstSample }, transfers: [{ shape }], transfers: [transfer] } = cells.find(
        (cell) => sample >= cell.json.firstSample && sample < cell.json.firstSample + cell.json.sampleCount);
      const { columns, size, shadowedChannels, fullChannels } = shape, values = decoded.get(transfer);
      const [first, channels] = fullChannels > 0 ? [shadowedChannels, fullChannels] : [0, shadowedChannels];
      const channel = first + (channels === 3 ? c : 0);
      for (let i = 0; i < columns; ++i)
        sum += reflectance[c] * values[(sample - firstSample) * size + channel * columns + i] * sky.rgb[3 * i + c];
    }
    lit += sum;
    assert.ok(Math.abs(sender.radiance[3 * t + c] - Math.max(0, sum)) < 1e-4, `triangle ${t}`);
  }));
  assert.ok(lit > 0);
});
