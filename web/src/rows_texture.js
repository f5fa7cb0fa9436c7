// Rows of weighted samples as shaders read them: two words a row. (entry, 1) is one sample of weight 1, (first, n) a run
// of n words (entry, weight) in a list, and (0, 0) a row without samples.
import { integerList } from './gpu_textures.js';

const bits = new Uint32Array(1), float = new Float32Array(bits.buffer);

/** Returns the `words` of rows `first` to `last`, and the list of their runs. `entryOf` maps samples to entries. */
export function packRows({ offsets, samples, weights }, first, last, entryOf) {
  const words = new Uint32Array(2 * (last - first)), runs = [];
  for (let row = first; row < last; ++row) {
    const begin = offsets[row], count = offsets[row + 1] - begin, to = 2 * (row - first);
    words[to + 1] = count;
    if (count === 1) words[to] = entryOf(samples[begin]);
    if (count < 2) continue;
    words[to] = runs.length / 2;
    for (let e = begin; e < begin + count; ++e) {
      float[0] = weights[e];
      runs.push(entryOf(samples[e]), bits[0]);
    }
  }
  const entries = integerList(Math.max(1, runs.length / 2), 2);
  entries.image.data.set(runs);
  return { words, entries };
}
