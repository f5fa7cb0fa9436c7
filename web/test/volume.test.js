// Decodes what a volume holds (docs/format.md, "density" and "voxels").
import assert from 'node:assert/strict';
import test from 'node:test';
import { decodeDensity, decodeVoxels } from '../src/volume_grid.js';

// Four runs of bytes of zigzag integers, the lowest bytes first.
const integers = (...values) =>
  Uint8Array.from([0, 8, 16, 24].flatMap((shift) => values.map((v) => (((v << 1) ^ (v >> 31)) >>> shift) & 255)));

test('density has codes of one or two bytes', () => {
  assert.deepEqual([...decodeDensity(Uint8Array.of(0, 7, 255, 1), { size: [2, 1, 2], bits: 8 })], [0, 7, 255, 1]);
  assert.deepEqual([...decodeDensity(Uint8Array.of(1, 2, 255, 255), { size: [1, 2, 1], bits: 16 })], [513, 65535]);
  assert.throws(() => decodeDensity(new Uint8Array(3), { size: [2, 1, 2], bits: 8 }), /a density is damaged/);
  assert.throws(() => decodeDensity(new Uint8Array(5), { size: [2, 1, 2], bits: 8 }), /a density is damaged/);
});

test('voxels with a sample rise', () => {
  assert.deepEqual([...decodeVoxels(integers(3, 1, 300), [8, 8, 8], 3)], [3, 4, 304]);
  for (const steps of [[3, 0], [3, -1], [3, 600], [-1, 2]])
    assert.throws(() => decodeVoxels(integers(...steps), [8, 8, 8], 2), /a list of voxels is damaged: it is not in order/);
  assert.throws(() => decodeVoxels(integers(3, 1), [8, 8, 8], 3), /it is too short/);
});
