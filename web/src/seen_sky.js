// How much of the sky a smooth dielectric's mirror sees, from the bands t_k = (1/π) ∫ V max(n·s, 0) y_k ds of transfer
// without bounces. Weights b of least squares make Σ b_k t_k as near to the lobe about the mirrored direction as it gets
// (runtime/evaluate/seen_sky.hpp).
import { DataArrayTexture, DataUtils, HalfFloatType, LinearFilter, RGBAFormat } from 'three';
import { floatList } from './gpu_textures.js';
import { lobeDensity } from './lobe.js';
import { evaluateBasis, unoccludedTransfer } from './sh.js';
import { ZonalFactors } from './zonal_factors.js';

const BANDS = 5, COUNT = 15, COSINES = 24, ROUGHNESSES = 9, LAYERS = 4;
const LEAST_ROUGHNESS = 0.3; // narrower lobes are beyond what the bands can tell apart
const DAMPING = 1e-2; // so that errors of the coding do not grow too much
const FACTORS = new ZonalFactors(BANDS, true);
export const SEEN_AXES = FACTORS.axes;

// Directions of half of the hemisphere, whose other half is its mirror image, with the functions y_k max(n·s, 0)/π.
function quadrature() {
  const heights = 40, azimuths = 48, nodes = [], y = new Float64Array(BANDS * BANDS);
  for (let i = 0; i < heights; ++i)
    for (let j = 0; j < azimuths; ++j) {
      const z = (i + 0.5) / heights, phi = (Math.PI * (j + 0.5)) / azimuths, r = Math.sqrt(1 - z * z);
      const direction = [r * Math.cos(phi), r * Math.sin(phi), z], functions = [];
      evaluateBasis(BANDS, ...direction, y);
      for (let l = 0; l < BANDS; ++l) for (let m = 0; m <= l; ++m) functions.push((y[l * (l + 1) + m] * z) / Math.PI);
      nodes.push({ direction, functions, solidAngle: (2 * Math.PI) / (heights * azimuths) });
    }
  return nodes;
}

// The lower factor of Cholesky's decomposition of the damped normal matrix.
function factored(nodes) {
  const a = Array.from({ length: COUNT }, () => new Float64Array(COUNT));
  for (const { functions, solidAngle } of nodes)
    for (let i = 0; i < COUNT; ++i) for (let k = 0; k < COUNT; ++k) a[i][k] += solidAngle * functions[i] * functions[k];
  const trace = a.reduce((sum, row, i) => sum + row[i], 0);
  for (let i = 0; i < COUNT; ++i) a[i][i] += (DAMPING * trace) / COUNT;
  for (let j = 0; j < COUNT; ++j)
    for (let i = j; i < COUNT; ++i) {
      let sum = a[i][j];
      for (let k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = i === j ? Math.sqrt(sum) : sum / a[j][j];
    }
  return a;
}

function solve(factor, right) {
  for (let i = 0; i < COUNT; ++i) {
    for (let k = 0; k < i; ++k) right[i] -= factor[i][k] * right[k];
    right[i] /= factor[i][i];
  }
  for (let i = COUNT; i-- > 0;) {
    for (let k = i + 1; k < COUNT; ++k) right[i] -= factor[k][i] * right[k];
    right[i] /= factor[i][i];
  }
  return right;
}

let kernel = null;

/** Returns the texture of the weights over cosine and roughness. All scenes share it. */
export function seenKernelTexture() {
  if (kernel) return kernel;
  const nodes = quadrature(), factor = factored(nodes);
  const open = nodes.reduce((sum, n) => sum.map((s, i) => s + n.solidAngle * n.functions[i]), Array(COUNT).fill(0));
  const data = new Uint16Array(4 * COSINES * ROUGHNESSES * LAYERS);
  for (let r = 0; r < ROUGHNESSES; ++r) {
    const density = lobeDensity(Math.max(r / (ROUGHNESSES - 1), LEAST_ROUGHNESS));
    for (let c = 0; c < COSINES; ++c) {
      const root = 1 - (c / (COSINES - 1)) ** 2, cosine = 1 - root * root, sine = Math.sqrt(1 - cosine * cosine);
      const right = new Float64Array(COUNT);
      for (const { direction, functions, solidAngle } of nodes) {
        const weight = solidAngle * density(direction[0] * sine + direction[2] * cosine);
        for (let i = 0; i < COUNT; ++i) right[i] += weight * functions[i];
      }
      const b = solve(factor, right), all = b.reduce((sum, value, i) => sum + value * open[i], 0);
      FACTORS.factor(b.map((value) => value / all)).forEach((weight, i) => {
        data[4 * (((i >> 2) * ROUGHNESSES + r) * COSINES + c) + (i & 3)] = DataUtils.toHalfFloat(weight);
      });
    }
  }
  kernel = new DataArrayTexture(data, COSINES, ROUGHNESSES, LAYERS);
  Object.assign(kernel, {
    format: RGBAFormat, type: HalfFloatType, magFilter: LinearFilter, minFilter: LinearFilter, needsUpdate: true,
  });
  return kernel;
}

/** Makes the list of what vertices see of the sky: 25 numbers each, in seven entries. */
export const seenList = (vertices) => floatList(7 * vertices);

/** Writes what vertices see into a list of seenList; `normals` are unit vectors in the group's frame. */
export function findSeen(list, group, run, rows, normals) {
  const { data } = list.image, coefficients = BANDS * BANDS, { outputs } = run, y = new Float64Array(coefficients);
  const seen = new Float32Array(run.count * outputs * coefficients);
  for (const { json, transfers } of group.cells.filter((cell) => cell.run === run)) {
    const transfer = transfers.find((t) => t.shape.order > 0), { shape } = transfer;
    const known = Math.min(shape.columns, coefficients), share = 1 / shape.shadowedChannels;
    for (let c = 0; c < shape.shadowedChannels; ++c)
      for (let o = 0; o < outputs; ++o) {
        const first = (c * outputs + o) * shape.columns, part = transfer.decode(first, first + known);
        for (let s = 0; s < json.sampleCount; ++s) {
          const to = ((json.firstSample - run.first + s) * outputs + o) * coefficients;
          for (let k = 0; k < known; ++k) seen[to + k] += share * part[s * known + k];
        }
      }
  }
  const sum = new Float64Array(outputs * coefficients), { offsets, samples, weights } = rows;
  for (let v = 0; v < normals.length / 3; ++v) {
    unoccludedTransfer(BANDS, ...normals.subarray(3 * v, 3 * v + 3), y);
    sum.fill(0);
    for (let e = offsets[v]; e < offsets[v + 1]; ++e)
      for (let i = 0, from = (samples[e] - run.first) * sum.length; i < sum.length; ++i)
        sum[i] += (weights ? weights[e] : 1) * seen[from + i];
    for (let k = 0; k < coefficients; ++k) {
      let value = outputs === 1 ? sum[k] : 0;
      for (let j = 0; outputs > 1 && j < 9; ++j) value += y[j] * sum[j * coefficients + k];
      data[28 * v + k] = offsets[v] === offsets[v + 1] ? y[k] : value;
    }
  }
  list.needsUpdate = true;
}
