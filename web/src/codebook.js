// Decodes transfer that is coded by clustered principal components: codebooks, cluster ids and weight planes. It is
// the twin of runtime/transfer/codebook.cpp; docs/format.md, section 4, has the byte tables.
import { Front, unzigzag } from './bytes.js';

/**
 * Shape of a transfer vector, from its JSON. Values are indexed [channel][output][column], shadowed channels first;
 * those of a visibility have one index.
 */
export function shapeOf(transfer) {
  const columns = transfer.order * transfer.order + transfer.lightColumns;
  const bands = transfer.visibilityBands ?? 0;
  const channels = transfer.shadowedChannels + transfer.fullChannels;
  return {
    order: transfer.order,
    lamps: transfer.lightColumns,
    shadowedChannels: transfer.shadowedChannels,
    fullChannels: transfer.fullChannels,
    outputs: transfer.outputs,
    visibilityBands: bands,
    columns,
    size: bands > 0 ? bands * bands : channels * transfer.outputs * columns,
  };
}

function halfToFloat(half) {
  const sign = half & 0x8000 ? -1 : 1, exponent = (half >> 10) & 31, fraction = half & 1023;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  return exponent === 31 ? (fraction ? NaN : sign * Infinity) : sign * 2 ** (exponent - 25) * (1024 + fraction);
}

// Reads a codebook whose vectors are coordinates in a basis that the clusters share.
function sharedVectors(front, axisCounts, axes, size) {
  const clusters = axisCounts.length;
  const [rank] = front.values(Uint32Array, 1);
  if (rank > size) throw new Error(`${front.subject} is damaged: its basis is larger than a vector`);
  const valueScales = front.values(Float32Array, size), basisScales = front.values(Float32Array, rank);
  const [meanScale] = front.values(Float32Array, 1);
  const integers = front.integers(rank * size);
  const means = front.integers(rank * clusters), directions = front.integers(rank * axes);
  const basis = new Float32Array(rank * size);
  for (let r = 0; r < rank; ++r)
    for (let i = 0; i < size; ++i) basis[r * size + i] = valueScales[i] * basisScales[r] * integers[r * size + i];

  const coordinates = new Float32Array((clusters + axes) * rank);
  let next = 0;
  const put = (source, first, stride, scale) => {
    for (let r = 0; r < rank; ++r) coordinates[next++] = scale * source[first + r * stride];
  };
  const sharing = []; // number of clusters that have an axis j, for each j
  for (const count of axisCounts) for (let j = 0; j < count; ++j) sharing[j] = (sharing[j] ?? 0) + 1;
  for (let c = 0; c < clusters; ++c) {
    put(means, c, clusters, meanScale);
    for (let j = 0, first = c; j < axisCounts[c]; ++j) {
      put(directions, first, sharing[j], 1);
      first += rank * sharing[j];
    }
  }
  return { rank, basis, coordinates };
}

// Reads a codebook of plain vectors: coordinates in the basis of the values themselves.
function plainVectors(front, count, size) {
  const basis = new Float32Array(size * size);
  for (let i = 0; i < size; ++i) basis[i * size + i] = 1;
  return { rank: size, basis, coordinates: Float32Array.from(front.split(count * size), halfToFloat) };
}

/**
 * Decodes a codebook: `axisCounts` of each cluster, `firstAxis` (one more entry than clusters), `offsets` and `scales`
 * of the weights of each axis, and vectors: of each cluster the mean, then its axes, each as `rank` `coordinates` in a
 * `basis` of `rank` x `shape.size` numbers.
 */
export function decodeCodebook(bytes, shape, clusters, subject = 'a codebook') {
  const front = new Front(bytes, subject);
  const [form] = front.values(Uint32Array, 1);
  if (form > 1) throw new Error(`${subject} has the unknown form ${form}`);
  const axisCounts = front.split(clusters), firstAxis = new Uint32Array(clusters + 1);
  for (let c = 0; c < clusters; ++c) {
    if (axisCounts[c] > (c > 0 ? axisCounts[c - 1] : shape.size))
      throw new Error(`${subject} is damaged: its numbers of axes are wrong`);
    firstAxis[c + 1] = firstAxis[c] + axisCounts[c];
  }
  const axes = firstAxis[clusters];
  const offsets = front.values(Float32Array, axes), scales = front.values(Float32Array, axes);
  const vectors = form === 0
    ? plainVectors(front, clusters + axes, shape.size) : sharedVectors(front, axisCounts, axes, shape.size);
  front.finish();
  const finite = (values) => values.every(Number.isFinite);
  if (!finite(vectors.basis) || !finite(vectors.coordinates) || !finite(offsets) || !finite(scales))
    throw new Error(`${subject} is damaged: a value is not finite`);
  return { axisCounts, firstAxis, offsets, scales, ...vectors };
}

/** Returns values `first` to `last` of all vectors of a codebook. */
export function expandVectors({ firstAxis, rank, basis, coordinates }, size, first = 0, last = size) {
  const count = firstAxis.length - 1 + firstAxis.at(-1), width = last - first;
  const out = new Float32Array(count * width), sum = new Float64Array(width);
  for (let v = 0; v < count; ++v) {
    sum.fill(0);
    for (let r = 0; r < rank; ++r) {
      const weight = coordinates[v * rank + r];
      if (weight === 0) continue;
      for (let i = 0, b = r * size + first; i < width; ++i, ++b) sum[i] += weight * basis[b];
    }
    out.set(sum, v * width);
  }
  return out;
}

/** Returns the cluster of each sample of a cell. Cells of one cluster have no payload. */
export function decodeClusterIds(bytes, clusters, samples, subject = 'cluster ids') {
  if (!bytes) return new Uint16Array(samples);
  const front = new Front(bytes, subject);
  const ids = clusters > 256 ? front.split(samples) : Uint16Array.from(front.take(samples));
  front.finish();
  if (ids.some((id) => id >= clusters)) throw new Error(`${subject} are damaged: a cluster does not exist`);
  return ids;
}

/** Returns the samples in the order of the codes: a stable sort by cluster. `starts` has a cluster's first position. */
export function positionsOf(clusterOf, clusters) {
  const starts = new Uint32Array(clusters + 1);
  for (const id of clusterOf) ++starts[id + 1];
  for (let c = 0; c < clusters; ++c) starts[c + 1] += starts[c];
  const next = starts.slice(), sampleAt = new Uint32Array(clusterOf.length);
  for (let s = 0; s < clusterOf.length; ++s) sampleAt[next[clusterOf[s]]++] = s;
  return { starts, sampleAt };
}

/** Returns the codes of a weight plane in the order of positionsOf. */
export function decodeWeightPlane(bytes, bits, count, subject = 'a weight plane') {
  const front = new Front(bytes, subject);
  const words = bits === 16 ? front.split(count) : front.take(count);
  front.finish();
  const codes = bits === 16 ? new Uint16Array(count) : new Uint8Array(count);
  let code = 0;
  for (let i = 0; i < count; ++i) codes[i] = code = code + unzigzag(words[i]); // arrays reduce modulo 2^bits
  return codes;
}

/**
 * Returns values `first` to `last` of the transfer vectors of a cell, decoded on the CPU. Shading decodes in shaders;
 * this serves what is needed once, and tests.
 */
export function decodeTransfer(shape, codebook, clusterOf, planes, first = 0, last = shape.size) {
  const width = last - first, out = new Float32Array(clusterOf.length * width);
  const vectors = expandVectors(codebook, shape.size, first, last);
  const { sampleAt } = positionsOf(clusterOf, codebook.axisCounts.length);
  const value = new Float64Array(width);
  sampleAt.forEach((sample, position) => {
    const cluster = clusterOf[sample], axis = codebook.firstAxis[cluster], mean = (axis + cluster) * width;
    for (let i = 0; i < width; ++i) value[i] = vectors[mean + i];
    for (let j = 0; j < Math.min(codebook.axisCounts[cluster], planes.length); ++j) {
      const weight = codebook.offsets[axis + j] + codebook.scales[axis + j] * planes[j][position];
      for (let i = 0, v = mean + (1 + j) * width; i < width; ++i, ++v) value[i] += weight * vectors[v];
    }
    out.set(value, sample * width);
  });
  return out;
}
