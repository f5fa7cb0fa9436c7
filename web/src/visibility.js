// Direct light of glossy cells, which store the visibility V: l'_j = Σ Γ_jkm V_k l_m with Γ_jkm = ∫ y_j y_k y_m. The
// integral is exact on a grid of Gauss-Legendre by even angles, so no table of Γ is needed.
import { evaluateBasis } from './sh.js';

const grids = new Map();

// Returns directions and weights that integrate products of harmonics of less than `bands` bands together.
function grid(bands) {
  if (grids.has(bands)) return grids.get(bands);
  const rows = Math.ceil(bands / 2) + 1, columns = bands + 1, points = [];
  for (let i = 0; i < rows; ++i) {
    let z = Math.cos((Math.PI * (i + 0.75)) / (rows + 0.5)), slope = 1;
    for (let step = 0; step < 20; ++step) { // Newton's method finds the root of the Legendre polynomial
      let before = 1, value = z;
      for (let k = 2; k <= rows; ++k) [before, value] = [value, ((2 * k - 1) * z * value - (k - 1) * before) / k];
      slope = (rows * (z * value - before)) / (z * z - 1);
      z -= value / slope;
    }
    const weight = (2 / ((1 - z * z) * slope * slope)) * ((2 * Math.PI) / columns), s = Math.sqrt(1 - z * z);
    for (let j = 0; j < columns; ++j) {
      const phi = (2 * Math.PI * (j + 0.5)) / columns;
      points.push([s * Math.cos(phi), s * Math.sin(phi), z, weight]);
    }
  }
  grids.set(bands, points);
  return points;
}

/** Returns, for every vector of a codebook of visibilities, light in the first `outputs` coefficients, RGB. */
export function visibilityProduct(shape, codebook, rgb, outputs) {
  const size = shape.size, order = Math.sqrt(rgb.length / 3), outBands = Math.sqrt(outputs);
  const points = grid(shape.visibilityBands + order + outBands);
  // matrix[(o * 3 + channel) * size + k] = ∫ y_o y_k L
  const matrix = new Float64Array(outputs * 3 * size), basis = new Float64Array(size);
  const most = Math.max(shape.visibilityBands, order, outBands), all = new Float64Array(most * most);
  for (const [x, y, z, weight] of points) {
    evaluateBasis(most, x, y, z, all);
    basis.set(all.subarray(0, size));
    for (let channel = 0; channel < 3; ++channel) {
      let radiance = 0;
      for (let i = 0; i < order * order; ++i) radiance += all[i] * rgb[3 * i + channel];
      for (let o = 0; o < outputs; ++o) {
        const factor = weight * radiance * all[o], at = (o * 3 + channel) * size;
        for (let k = 0; k < size; ++k) matrix[at + k] += factor * basis[k];
      }
    }
  }
  const count = codebook.vectors.length / size, width = outputs * 3, out = new Float32Array(count * width);
  for (let v = 0; v < count; ++v)
    for (let row = 0; row < width; ++row) {
      let sum = 0;
      for (let k = 0; k < size; ++k) sum += matrix[row * size + k] * codebook.vectors[v * size + k];
      out[v * width + row] = sum;
    }
  return out;
}
