// Reads NumPy arrays of float32 and uint32 that `lambent export` writes.
import { readFileSync } from 'node:fs';

export function readNpy(path) {
  const file = readFileSync(path), header = file.readUInt16LE(8);
  const text = file.toString('latin1', 10, 10 + header);
  const type = { '<f4': Float32Array, '<u4': Uint32Array }[/'descr': '([^']*)'/.exec(text)[1]];
  const shape = /'shape': \(([^)]*)\)/.exec(text)[1].split(',').filter((n) => n.trim()).map(Number);
  const bytes = file.subarray(10 + header);
  return { shape, data: new type(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)) };
}
