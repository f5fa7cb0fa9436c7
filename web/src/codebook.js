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

// Multiplies out a codebook whose vectors are coordinates in a shared basis.
function expand(front, axisCounts, axes, size) {
  const clusters = axisCounts.length;
  const [rank] = front.values(Uint32Array, 1);
  if (rank > size) throw new Error(`${front.subject} is damaged: its basis is larger than a vector`);
  const valueScales = front.values(Float32Array, size), basisScales = front.values(Float32Array, rank);
  const [meanScale] = front.values(Float32Array, 1);
  const integers = front.integers(rank * size);
  const means = front.integers(rank * clusters), directions = front.integers(rank * axes);
  const basis = new Float64Array(rank * size);
  for (let r = 0; r < rank; ++r)
    for (let i = 0; i < size; ++i) basis[r * size + i] = valueScales[i] * basisScales[r] * integers[r * size + i];

  const vectors = new Float32Array((clusters + axes) * size), sum = new Float64Array(size);
  let next = 0;
  const put = (coordinates, first, stride, scale) => {
    sum.fill(0);
    for (let r = 0; r < rank; ++r) {
      const weight = scale * coordinates[first + r * stride];
      if (weight === 0) continue;
      for (let i = 0, b = r * size; i < size; ++i, ++b) sum[i] += weight * basis[b];
    }
    vectors.set(sum, next);
    next += size;
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
  return vectors;
}

/**
 * Decodes a codebook: `axisCounts` of each cluster, `firstAxis` (one more entry than clusters), `offsets` and `scales`
 * of the weights of each axis, and `vectors`: of each cluster the mean, then its axes.
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
    ? Float32Array.from(front.split((clusters + axes) * shape.size), halfToFloat)
    : expand(front, axisCounts, axes, shape.size);
  front.finish();
  if (!vectors.every(Number.isFinite)) throw new Error(`${subject} is damaged: a value is not finite`);
  return { axisCounts, firstAxis, offsets, scales, vectors };
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

/** Returns the whole transfer vectors of a cell. Only tests need them; shading multiplies the codebook instead. */
export function decodeTransfer(shape, codebook, clusterOf, planes) {
  const out = new Float32Array(clusterOf.length * shape.size);
  const { sampleAt } = positionsOf(clusterOf, codebook.axisCounts.length);
  sampleAt.forEach((sample, position) => {
    const cluster = clusterOf[sample], first = codebook.firstAxis[cluster];
    const mean = (first + cluster) * shape.size;
    for (let i = 0; i < shape.size; ++i) {
      let value = codebook.vectors[mean + i];
      for (let j = 0; j < Math.min(codebook.axisCounts[cluster], planes.length); ++j) {
        const weight = codebook.offsets[first + j] + codebook.scales[first + j] * planes[j][position];
        value += weight * codebook.vectors[mean + (1 + j) * shape.size + i];
      }
      out[sample * shape.size + i] = value;
    }
  });
  return out;
}
