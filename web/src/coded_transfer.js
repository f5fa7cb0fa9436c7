// Transfer of a cell as it is coded, and its product with light. Means and axes are multiplied with the light once per
// change of light; each sample then costs one multiply-add per axis, channel and output.
import { positionsOf, shapeOf } from './codebook.js';
import { visibilityProduct } from './visibility.js';

/** Outputs that are shaded: one for E/π, else light of bands 0..2. Further bands of glossy cells are not used. */
export const shadedOutputs = (outputs) => Math.min(outputs, 9);

export class CodedTransfer {
  constructor(json, samples) {
    this.json = json;
    this.shape = shapeOf(json);
    this.samples = samples;
    this.outputs = shadedOutputs(this.shape.outputs);
    this.planes = [];
    this.codebook = null;
  }

  async load(bundle) {
    const { codebook, clusterOf } = await bundle.codebook(this.json, this.samples);
    Object.assign(this, { codebook, ...positionsOf(clusterOf, codebook.axisCounts.length) });
  }

  get isVisibility() {
    return this.shape.visibilityBands > 0;
  }

  // Returns the products of every mean and axis with the light, `outputs` x RGB each. `light.full` counts with
  // bounces, `light.shadowed` without, and the results add up.
  products(light) {
    const { shape, codebook, outputs } = this;
    if (this.isVisibility)
      return visibilityProduct(shape, codebook, light.sum.subarray(0, 3 * shape.order ** 2), outputs);
    const first = shape.order > 0 ? light : light.lamps;
    const hasFull = shape.fullChannels > 0, hasShadowed = shape.shadowedChannels > 0;
    const parts = [];
    const add = (rgb, channels, offset) => rgb && channels > 0 && parts.push({ rgb, channels, offset });
    add(first.full, hasFull ? shape.fullChannels : shape.shadowedChannels, hasFull ? shape.shadowedChannels : 0);
    // A cell that holds bounced light alone has nothing to give to light that counts without bounces.
    if (hasShadowed) add(first.shadowed, shape.shadowedChannels, 0);

    const count = codebook.vectors.length / shape.size, out = new Float32Array(count * outputs * 3);
    const stride = shape.outputs * shape.columns;
    for (const { rgb, channels, offset } of parts) {
      const columns = Math.min(shape.columns, rgb.length / 3);
      for (let v = 0; v < count; ++v)
        for (let o = 0; o < outputs; ++o)
          for (let channel = 0; channel < 3; ++channel) {
            const at = v * shape.size + (offset + (channels === 1 ? 0 : channel)) * stride + o * shape.columns;
            let sum = 0;
            for (let i = 0; i < columns; ++i) sum += codebook.vectors[at + i] * rgb[3 * i + channel];
            out[(v * outputs + o) * 3 + channel] += sum;
          }
    }
    return out;
  }

  /** Adds the light of each sample to `out`, which has `outputs` x RGB per sample, from entry `base` on. */
  shade(light, out, base) {
    if (!this.codebook) return;
    this.combine(this.products(light), this.outputs * 3, out, base);
  }

  /** Adds mean + Σ weight x axis of each sample, given the `width` numbers that stand for each mean and axis. */
  combine(products, width, out, base) {
    const { codebook, starts, sampleAt, planes } = this;
    const mean = new Float64Array(width);
    for (let c = 0; c + 1 < starts.length; ++c) {
      const first = codebook.firstAxis[c], at = (first + c) * width;
      const axes = Math.min(codebook.axisCounts[c], planes.length);
      for (let k = 0; k < width; ++k) mean[k] = products[at + k];
      const scaled = new Float64Array(axes * width);
      for (let j = 0; j < axes; ++j)
        for (let k = 0; k < width; ++k) {
          const product = products[at + (1 + j) * width + k];
          mean[k] += codebook.offsets[first + j] * product;
          scaled[j * width + k] = codebook.scales[first + j] * product;
        }
      for (let position = starts[c]; position < starts[c + 1]; ++position) {
        const to = (base + sampleAt[position]) * width;
        for (let k = 0; k < width; ++k) {
          let sum = mean[k];
          for (let j = 0; j < axes; ++j) sum += planes[j][position] * scaled[j * width + k];
          out[to + k] += sum;
        }
      }
    }
  }
}
