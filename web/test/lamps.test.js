// Holds the light of lamps, and how it is divided among carriers, against closed forms.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Matrix4, PointLight, SpotLight, Vector3 } from 'three';
import { Lamp, MOST_CUBES, divideLamps, lampsAt, shadowsDiffer } from '../src/local_lights.js';
import { unoccludedTransfer } from '../src/sh.js';
import { findSphereLamps } from '../src/sphere_lamps.js';

function lampAt(x, y, z, light = new PointLight(0xffffff, 3)) {
  light.position.set(x, y, z);
  light.updateMatrixWorld(true);
  const lamp = new Lamp(light, null);
  lamp.follow([]);
  return lamp;
}

// A body of half a metre about the origin, at a place.
const body = (x) => ({
  place: new Matrix4().makeTranslation(x, 0, 0), isVolume: false,
  json: { boundsMin: [-0.5, -0.5, -0.5], boundsMax: [0.5, 0.5, 0.5], lights: [], lightSamples: [[0, 0, 0]] },
});

const harmonicsAt = ({ probes }, x = 0) => lampsAt(probes, new Vector3(x, 0, 0));

test('harmonics of a lamp give its irradiance', () => {
  const transfer = unoccludedTransfer(8, 0, 1, 0, new Float64Array(64));
  const received = (lamp) => lamp.lightAt(new Vector3()).rgb
    .reduce((sum, value, i) => sum + (i % 3 === 0 ? value * transfer[Math.floor(i / 3)] : 0), 0);
  const open = 3 / (Math.PI * 4);
  // Eight bands of a clamped cosine err by 2 %.
  const near = (value, wanted) => assert.ok(Math.abs(value - wanted) < 0.025 * open, `${value} is not ${wanted}`);
  near(received(lampAt(0, 2, 0)), open); // I cos / (π d²)
  near(received(lampAt(0, Math.sqrt(2), Math.sqrt(2))), open * Math.SQRT1_2);
  near(received(lampAt(0, 2, 0, new PointLight(0xffffff, 3, 4))), open * (1 - 0.5 ** 4));
  const spot = new SpotLight(0xffffff, 3, 0, 0.6, 0.5);
  spot.add(spot.target);
  spot.target.position.set(0, -1, 0);
  near(received(lampAt(0, 2, 0, spot)), open);
  spot.target.position.set(Math.sin(0.45), -Math.cos(0.45), 0); // between the cones
  const inside = (Math.cos(0.45) - Math.cos(0.6)) / (Math.cos(0.3) - Math.cos(0.6));
  near(received(lampAt(0, 2, 0, spot)), open * inside * inside);
});

test('three does not shine by lamps', () => {
  const { light } = lampAt(0, 1, 0);
  assert.equal(light.layers.mask, 0);
  assert.equal(light.visible, true, 'what hangs from it is drawn');
});

test('a lamp within a body shines by a cube alone, one beside it also by bounces, one afar by harmonics', () => {
  const [room, beside] = divideLamps([lampAt(0, 0.2, 0)], [body(0), body(2)], false).ofGroup;
  assert.deepEqual([room.powers[0], harmonicsAt(room)], [3, { rest: null, beside: null }]);
  assert.equal(beside.powers[0], 3);
  const bounced = harmonicsAt(beside, 2);
  assert.ok(bounced.rest === null && bounced.beside.rgb[0] > 0);
  const far = divideLamps([lampAt(0, 100, 0)], [body(0)], false);
  assert.equal(far.cubes.length, 0);
  const afar = harmonicsAt(far.ofGroup[0]);
  assert.ok(afar.rest.rgb[0] > 0 && afar.beside === null);
  assert.deepEqual(lampsAt(far.ofGroup[0].probes, new Vector3(), () => ({ rest: true })), { rest: null, beside: null });
});

test('no light is lost and none jumps as a lamp moves away', () => {
  const lamps = [1, 1.5, 2, 2.5].map((y) => lampAt(0, y, 0));
  for (const others of [[], lamps]) {
    let before = null;
    for (let y = 0.55; y < 8; y += 0.01) {
      const moving = lampAt(0, y, 0), divided = divideLamps([...others, moving], [body(0)], false);
      const { cubes, ofGroup: [{ powers }] } = divided, { rest } = harmonicsAt(divided.ofGroup[0]);
      assert.ok(cubes.length <= MOST_CUBES);
      const at = cubes.indexOf(moving), share = at < 0 ? 0 : powers[3 * at] / 3;
      // What is not by the cube is by harmonics, here of this lamp and of any other that gave up its cube.
      const mean = 3 * Math.sqrt(1 / (4 * Math.PI)) / y ** 2, byHarmonics = (rest?.rgb[0] ?? 0) / mean;
      assert.ok(share + byHarmonics > 1 - 1e-6, `${share} + ${byHarmonics} at ${y}`);
      assert.ok(before === null || Math.abs(share - before) < 0.1, `from ${before} to ${share} at ${y}`);
      before = share;
    }
    assert.equal(before, 0);
  }
});

// A room with materials that shine as so many spheres each, and their lamps under such strengths.
function bulbs(counts, strengths, scale = 1) {
  const spheres = (count) => Array.from({ length: count }, (_, i) => (
    { center: [0.1 * i, 0.3, 0], radius: 0.05, bodyRadius: 0.06 }));
  const lights = counts.map((count, material) => ({ kind: 'material', material, spheres: spheres(count) }));
  const room = { ...body(1), json: { ...body(1).json, lights } }, lamps = findSphereLamps([room.json]);
  room.place.scale(new Vector3(scale, scale, scale));
  for (const lamp of lamps) lamp.follow([strengths.map((c) => [c, c, c])], [room.place]);
  return { room, lamps };
}

test('materials shine as spheres where there are cubes for all of them, the brightest first', () => {
  const { room, lamps } = bulbs([1, 3, 2, 0], [2, 3, 10, 50]);
  assert.equal(lamps.length, 3, 'a material without spheres shines by its column');
  const { cubes, ofGroup } = divideLamps(lamps, [room, body(0)], false), [own, other] = ofGroup;
  assert.deepEqual(own.apart, [1, 0, 1, 0], 'the second one is brighter than the first and has too many spheres');
  assert.deepEqual(cubes.map(({ lamp }) => lamps.indexOf(lamp)), [2, 2, 0]);
  assert.deepEqual([0, 3, 6, 9].map((i) => own.powers[i]), [10, 10, 2, 0]);
  assert.ok(cubes[1].position.distanceTo(new Vector3(1.1, 0.3, 0)) < 1e-6 && cubes[1].hole > 0.06);
  assert.ok(other.powers.every((power) => power === 0) && other.probes.length === 0, 'others see a body that shines');
});

test('spheres leave cubes to lamps among surfaces, and shine by columns in a group of another size', () => {
  const points = [0, 0.1, 0.2].map((x) => lampAt(x, 0.2, 0)), { room, lamps } = bulbs([2], [1e4]);
  const apart = (all, group, open = false) => divideLamps(all, [group], open).ofGroup[0].apart;
  const here = { ...room, place: new Matrix4() };
  assert.deepEqual(apart([...points, ...lamps], here), [0]);
  assert.deepEqual(apart([...points.slice(1), ...lamps], here), [1]);
  assert.deepEqual(apart(lamps, room, true), [0]);
  const large = bulbs([2], [1e4], 1.1), dark = bulbs([2], [0]);
  assert.deepEqual([apart(large.lamps, large.room), apart(dark.lamps, dark.room)], [[0], [0]]);
});

test('a body in the cube of a bulb shades by captures', () => {
  const { room, lamps } = bulbs([1], [1]), between = lampAt(0, 0.2, 0);
  const differ = (all) => shadowsDiffer(divideLamps(all, [room, body(0)], false), 1, 0);
  assert.equal(differ(lamps), true);
  assert.equal(differ([]), false);
  assert.equal(differ([between]), false, 'both take it by its cube');
});
