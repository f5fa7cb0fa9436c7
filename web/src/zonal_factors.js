// Writes functions on the sphere as sums of zonal functions about a few axes, so that they turn without a rotation
// matrix (Nowrouzezahrai, Simari and Fiume 2012). The axes are those of runtime/sh/zonal.cpp.
import { evaluateBasis } from './sh.js';

// Axes after z, in degrees: theta, phi.
const IN_PLANE = [[70.877, 0], [48.465, 180], [35.135, 0], [78.412, 180], [23.305, 180]];
const ON_SPHERE = [
  [50.897, 336.283], [63.95, 97.713], [86.128, 268.301], [52.917, 58.666], [87.912, 117.891], [59.783, 296.874],
  [24.865, 359.535], [26.242, 71.195], [60.488, 272.484], [40.97, 239.161],
];

function directionOf([theta, phi]) {
  const t = (theta * Math.PI) / 180, p = (phi * Math.PI) / 180, inPlane = phi === 0 || phi === 180;
  return [Math.sin(t) * Math.cos(p), inPlane ? 0 : Math.sin(t) * Math.sin(p), Math.cos(t)];
}

// Inverts a row-major matrix by elimination with row pivots.
function inverted(matrix, count) {
  const inverse = new Float64Array(count * count);
  for (let i = 0; i < count; ++i) inverse[i * count + i] = 1;
  const swap = (m, a, b) => {
    for (let k = 0; k < count; ++k) [m[a * count + k], m[b * count + k]] = [m[b * count + k], m[a * count + k]];
  };
  for (let column = 0; column < count; ++column) {
    let pivot = column;
    for (let row = column + 1; row < count; ++row)
      if (Math.abs(matrix[row * count + column]) > Math.abs(matrix[pivot * count + column])) pivot = row;
    for (const m of [matrix, inverse]) swap(m, column, pivot);
    const scale = 1 / matrix[column * count + column];
    for (const m of [matrix, inverse]) for (let k = 0; k < count; ++k) m[column * count + k] *= scale;
    for (let row = 0; row < count; ++row) {
      const factor = matrix[row * count + column];
      if (row === column || factor === 0) continue;
      for (const m of [matrix, inverse])
        for (let k = 0; k < count; ++k) m[row * count + k] -= factor * m[column * count + k];
    }
  }
  return inverse;
}

/**
 * Factors for functions of so many bands, at most 6. Isotropic ones are symmetric about the xz plane: their axes lie in
 * it, and band l takes l + 1 of them; else band l takes 2l + 1.
 */
export class ZonalFactors {
  constructor(order, isotropic) {
    const axesOfBand = (l) => (isotropic ? l + 1 : 2 * l + 1);
    const others = isotropic ? IN_PLANE : ON_SPHERE;
    this.axes = [[0, 0, 1], ...others.slice(0, axesOfBand(order - 1) - 1).map(directionOf)];
    this.bands = [];
    const y = new Float64Array(order * order);
    for (let l = 0; l < order; ++l) {
      const count = axesOfBand(l), matrix = new Float64Array(count * count);
      for (let i = 0; i < count; ++i) {
        evaluateBasis(order, ...this.axes[i], y);
        const first = l * (l + 1) - (isotropic ? 0 : l);
        for (let m = 0; m < count; ++m) matrix[m * count + i] = y[first + m];
      }
      this.bands.push(inverted(matrix, count));
    }
  }

  /** Returns the weights of a function, band by band, from its coefficients (m >= 0 alone if isotropic). */
  factor(coefficients) {
    const weights = [];
    for (const inverse of this.bands) {
      const count = Math.sqrt(inverse.length), first = weights.length;
      for (let i = 0; i < count; ++i) {
        let sum = 0;
        for (let m = 0; m < count; ++m) sum += inverse[i * count + m] * coefficients[first + m];
        weights.push(sum);
      }
    }
    return weights;
  }
}
