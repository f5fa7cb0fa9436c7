// The product of a codebook's basis with light: of each basis vector the light that it brings, as outputs x RGBA. A is
// the visibility itself, where the vectors are visibilities.
import { gauntTable } from './gaunt.js';

/**
 * Writes rank x outputs x 4 numbers, for the first `outputs` of the shape. `light.full` (n² x RGB) counts with bounces,
 * `light.shadowed` without, and the results add up; `light.sum` is the light of visibilities; `light.lamps` has the same
 * for the group's lamps.
 */
export function basisTimesLight(shape, { rank, basis }, light, outputs, out) {
  out.fill(0);
  if (shape.visibilityBands > 0) visibilityTimesLight(shape, rank, basis, light.sum, outputs, out);
  else for (const part of partsOf(shape, light)) vectorsTimesLight(shape, rank, basis, part, outputs, out);
}

// Returns the channels of the vectors that count for each part of the light.
function partsOf(shape, light) {
  const { full, shadowed } = shape.order > 0 ? light : light.lamps;
  const hasFull = shape.fullChannels > 0, parts = [];
  const add = (rgb, channels, first) => rgb && channels > 0 && parts.push({ rgb, channels, first });
  add(full, hasFull ? shape.fullChannels : shape.shadowedChannels, hasFull ? shape.shadowedChannels : 0);
  // A cell that holds bounced light alone has nothing to give to light that counts without bounces.
  add(shadowed, shape.shadowedChannels, 0);
  return parts;
}

function vectorsTimesLight(shape, rank, basis, { rgb, channels, first }, outputs, out) {
  const columns = Math.min(shape.columns, rgb.length / 3), stride = shape.outputs * shape.columns;
  for (let r = 0, to = 0; r < rank; ++r)
    for (let o = 0; o < outputs; ++o, to += 4)
      for (let c = 0; c < 3; ++c) {
        const at = r * shape.size + (first + (channels === 1 ? 0 : c)) * stride + o * shape.columns;
        let sum = 0;
        for (let i = 0; i < columns; ++i) sum += basis[at + i] * rgb[3 * i + c];
        out[to + c] += sum;
      }
}

function visibilityTimesLight(shape, rank, basis, rgb, outputs, out) {
  const { size } = shape;
  const { j, k, m, value } = gauntTable(Math.sqrt(outputs), shape.visibilityBands, shape.order);
  const matrix = new Float64Array(3 * outputs * size); // [output][channel][k] = ∫ y_o y_k L
  for (let t = 0; t < value.length; ++t)
    for (let c = 0; c < 3; ++c) matrix[(3 * j[t] + c) * size + k[t]] += value[t] * (rgb[3 * m[t] + c] ?? 0);
  for (let r = 0, to = 0; r < rank; ++r)
    for (let o = 0; o < outputs; ++o, to += 4) {
      for (let c = 0; c < 3; ++c) {
        const at = (3 * o + c) * size;
        let sum = 0;
        for (let i = 0; i < size; ++i) sum += matrix[at + i] * basis[r * size + i];
        out[to + c] += sum;
      }
      out[to + 3] = basis[r * size + o];
    }
}
