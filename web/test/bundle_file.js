// Opens a bundle from a file, without three.
import { readFileSync } from 'node:fs';
import { Bundle } from '../src/bundle.js';

export function openBundle(path) {
  const file = readFileSync(path), length = file.readUInt32LE(12);
  const json = JSON.parse(file.toString('utf8', 20, 20 + length));
  const binary = new Uint8Array(file.buffer, file.byteOffset + 28 + length, file.readUInt32LE(20 + length));
  const views = json.bufferViews;
  return new Bundle(json, async (index) => {
    const { byteOffset = 0, byteLength } = views[index];
    return binary.subarray(byteOffset, byteOffset + byteLength);
  });
}
