// Direct light of glossy cells, which store the visibility V: l'_j = Σ Γ_jkm V_k l_m with Γ_jkm = ∫ y_j y_k y_m. The
// integrals are exact on a grid of Gauss-Legendre by even angles; most of them are 0.
import { evaluateBasis } from './sh.js';

// Returns directions and weights that integrate products of harmonics of less than `bands` bands together.
function grid(bands) {
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
  return points;
}

const tables = new Map();

/** Returns the integrals that are not 0 as lists j, k, m and value, for so many bands of each. */
export function gauntTable(outBands, visibilityBands, order) {
  const key = `${outBands},${visibilityBands},${order}`;
  if (tables.has(key)) return tables.get(key);
  const most = Math.max(outBands, visibilityBands, order), basis = new Float64Array(most * most);
  const outs = outBands ** 2, size = visibilityBands ** 2, lights = order ** 2;
  const sums = new Float64Array(outs * lights * size);
  for (const [x, y, z, weight] of grid(outBands + visibilityBands + order)) {
    evaluateBasis(most, x, y, z, basis);
    for (let j = 0, at = 0; j < outs; ++j)
      for (let m = 0; m < lights; ++m) {
        const factor = weight * basis[j] * basis[m];
        for (let k = 0; k < size; ++k, ++at) sums[at] += factor * basis[k];
      }
  }
  const table = { j: [], k: [], m: [], value: [] };
  for (let j = 0, at = 0; j < outs; ++j)
    for (let m = 0; m < lights; ++m)
      for (let k = 0; k < size; ++k, ++at) {
        if (Math.abs(sums[at]) < 1e-12) continue;
        table.j.push(j);
        table.k.push(k);
        table.m.push(m);
        table.value.push(sums[at]);
      }
  tables.set(key, table);
  return table;
}
