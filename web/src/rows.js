// Decodes vertex rows: the samples that each vertex (and then each texel) is interpolated from.
import { Front } from './bytes.js';

const SINGLE = 2, SPARSE = 3;

/** Returns `offsets` (one more than rows), `samples` and `weights`; weights are null where each row has one sample. */
export function decodeRows(bytes, rows, sampleCount, subject = 'vertex rows') {
  const front = new Front(bytes, subject);
  const [kind, entries] = front.values(Uint32Array, 2);
  if ((kind !== SINGLE && kind !== SPARSE) || (kind === SINGLE && entries !== rows))
    throw new Error(`${subject} are damaged or of an unknown kind`);
  let offsets = null, weights = null;
  if (kind === SPARSE) offsets = front.values(Uint32Array, rows + 1);
  const samples = front.values(Uint32Array, entries); // stored as differences
  for (let e = 1; e < entries; ++e) samples[e] += samples[e - 1];
  if (kind === SPARSE) {
    weights = Float32Array.from(front.values(Uint16Array, entries), (w) => w / 65535);
    if (offsets[0] !== 0 || offsets[rows] !== entries || offsets.some((o, v) => v > 0 && o < offsets[v - 1]))
      throw new Error(`${subject} are damaged: their offsets do not rise to the number of entries`);
  } else {
    offsets = Uint32Array.from({ length: rows + 1 }, (_, v) => v);
  }
  front.finish();
  if (samples.some((s) => s >= sampleCount)) throw new Error(`${subject} are damaged: a sample does not exist`);
  return { offsets, samples, weights };
}
