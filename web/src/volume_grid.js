// Decodes what a volume holds besides transfer: its density, and the voxels of its samples (docs/format.md, section 4).
import { Front } from './bytes.js';

const countOf = ([x, y, z]) => x * y * z;

/** Returns the codes of the density, x fastest. */
export function decodeDensity(bytes, { size, bits }, subject = 'a density') {
  const front = new Front(bytes, subject);
  const codes = bits === 16 ? front.values(Uint16Array, countOf(size)) : front.take(countOf(size));
  front.finish();
  return codes;
}

/** Returns the voxels that have a sample, rising. */
export function decodeVoxels(bytes, size, samples, subject = 'a list of voxels') {
  const front = new Front(bytes, subject), voxels = front.integers(samples);
  front.finish();
  for (let i = 1; i < samples; ++i) voxels[i] += voxels[i - 1];
  if (voxels.some((voxel, i) => voxel < 0 || voxel >= countOf(size) || (i > 0 && voxel <= voxels[i - 1])))
    throw new Error(`${subject} is damaged: it is not in order`);
  return voxels;
}
