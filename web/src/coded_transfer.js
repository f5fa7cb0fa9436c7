// Transfer of a cell as it is coded, on the GPU: coordinates of means and axes, codes of each sample, and their product
// with light. On the CPU a change of light costs the product of the codebook's basis with the light.
import { decodeTransfer, positionsOf, shapeOf } from './codebook.js';
import { floatList, integerList, listTarget, rowsFor, shortList } from './gpu_textures.js';
import { basisTimesLight } from './light_map.js';

export class CodedTransfer {
  /** Of the outputs, the first `outputs` are shaded. */
  constructor(json, samples, outputs) {
    this.outputs = outputs;
    this.json = json;
    this.shape = shapeOf(json);
    this.samples = samples;
    this.planes = [];
    this.codebook = null;
  }

  /** `blend` has the light probes of each sample, or is null (decodeLightWeights). */
  async load(bundle, blend) {
    this.blend = blend;
    const { codebook, clusterOf } = await bundle.codebook(this.json, this.samples);
    Object.assign(this, { codebook, clusterOf, ...positionsOf(clusterOf, codebook.axisCounts.length) });
    this.makeTextures();
  }

  get isVisibility() {
    return this.shape.visibilityBands > 0;
  }

  makeTextures() {
    const { codebook, clusterOf } = this, { axisCounts, firstAxis, rank } = codebook;
    const clusters = axisCounts.length, count = clusters + firstAxis[clusters];
    this.vectorEntries = Math.ceil(rank / 4);
    // The last codes of a sample fill up an entry with zeros, so the shader may read three vectors past the end.
    this.vectorCount = count + 3;
    this.vectors = floatList(this.vectorCount * this.vectorEntries);
    this.makeLights(1);
    for (let c = 0; c < clusters; ++c) this.addVector(firstAxis[c] + c, firstAxis[c] + c, 1);
    this.places = integerList(this.samples, 4);
    let entries = 0;
    this.firstCode = new Uint32Array(this.samples);
    for (let s = 0; s < this.samples; ++s) {
      const cluster = clusterOf[s], own = Math.ceil(axisCounts[cluster] / 4);
      this.places.image.data.set(
        [firstAxis[cluster] + cluster, own | (this.lightsOf(s) << 8), entries, this.weightsOf(s)], 4 * s);
      this.firstCode[s] = 4 * entries;
      entries += own;
    }
    this.codes = shortList(Math.max(1, entries));
  }

  makeLights(count) {
    this.lightCount = count;
    this.lights?.dispose();
    this.target?.dispose();
    this.target = null;
    this.lights = floatList(count * 4 * this.vectorEntries * this.outputs);
  }

  // The four light probes of a sample in six bits each, and their weights in eight.
  lightsOf(sample) {
    const light = (k) => this.blend.lights[4 * sample + k] << (6 * k);
    return this.blend ? [0, 1, 2, 3].reduce((word, k) => word | light(k), 0) : 0;
  }
  weightsOf(sample) {
    const weight = (k) => this.blend.weights[4 * sample + k] << (8 * k);
    return this.blend ? [0, 1, 2, 3].reduce((word, k) => word | weight(k), 0) : 255;
  }

  /** Returns the coordinates of a sample's transfer in the basis, as far as planes have come. */
  coordinatesOf(sample) {
    const { rank } = this.codebook, { data } = this.vectors.image, width = 4 * this.vectorEntries;
    const mean = this.places.image.data[4 * sample];
    const out = new Float64Array(data.subarray(mean * width, mean * width + rank));
    for (let j = 0; j < this.planes.length && j < this.codebook.axisCounts[this.clusterOf[sample]]; ++j) {
      const code = this.codes.image.data[this.firstCode[sample] + j], first = (mean + 1 + j) * width;
      for (let r = 0; r < rank; ++r) out[r] += code * data[first + r];
    }
    return out;
  }

  // Adds `factor` times a vector of the codebook to one on the GPU.
  addVector(to, from, factor) {
    const { rank, coordinates } = this.codebook, { data } = this.vectors.image, first = 4 * this.vectorEntries * to;
    for (let r = 0; r < rank; ++r) data[first + r] += factor * coordinates[from * rank + r];
  }

  /**
   * Takes the codes of plane j. A weight is offset + scale x code: the offset's share joins the mean, and the axis is
   * kept times its scale, so an axis whose plane has not come adds nothing.
   */
  setPlane(j, codes) {
    this.planes[j] = codes;
    const { axisCounts, firstAxis, offsets, scales } = this.codebook, { data } = this.codes.image;
    for (let c = 0; c < axisCounts.length && axisCounts[c] > j; ++c) {
      const mean = firstAxis[c] + c, axis = mean + 1 + j;
      this.addVector(mean, axis, offsets[firstAxis[c] + j]);
      this.addVector(axis, axis, scales[firstAxis[c] + j]);
    }
    for (let position = 0; position < codes.length; ++position)
      data[this.firstCode[this.sampleAt[position]] + j] = codes[position];
    this.vectors.needsUpdate = this.codes.needsUpdate = true;
  }

  /** Multiplies with the light at each light probe of the cell, or one for all, on the CPU; see basisTimesLight. */
  setLight(lights) {
    if (lights.length !== this.lightCount) this.makeLights(lights.length);
    const { data } = this.lights.image, size = 16 * this.vectorEntries * this.outputs;
    lights.forEach((light, k) =>
      basisTimesLight(this.shape, this.codebook, light, this.outputs, data.subarray(k * size, (k + 1) * size)));
    this.lights.needsUpdate = true;
  }

  /** Multiplies all vectors with the light on the GPU. */
  multiply(renderer, passes) {
    this.target ??= listTarget(rowsFor(this.lightCount * this.vectorCount * this.outputs));
    const { vectors, lights, vectorCount, vectorEntries } = this;
    passes.products(renderer, this.target,
      { vectors, lights, vectorCount, vectorEntries, outputs: this.outputs });
  }

  /** What the pass over samples reads. */
  get textures() {
    const { target, codes, places, vectorCount, lightCount } = this;
    return { products: target.texture, codes, places, counts: [vectorCount, lightCount] };
  }

  /** Decodes values of all samples on the CPU, from the planes that are there. */
  decode(first, last) {
    return decodeTransfer(this.shape, this.codebook, this.clusterOf, this.planes, first, last);
  }

  dispose() {
    for (const one of [this.vectors, this.lights, this.places, this.codes, this.target]) one?.dispose();
  }
}
