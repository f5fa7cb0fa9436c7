// A rigid group: its cells' transfer, and light at its samples.
import { CodedTransfer, shadedOutputs } from './coded_transfer.js';

export class Group {
  constructor(json) {
    this.json = json;
    // Samples with as many outputs lie in a row, because cells come by rising outputs.
    this.samples = new Map(); // outputs -> {first, count, lit, seen}
    this.cells = [];
    for (const cell of json.cells) {
      if (cell.kind !== 'surface') continue; // volumes and neighborhoods are not shown
      const { outputs } = cell.transfers[0];
      const run = this.samples.get(outputs) ?? { first: cell.firstSample, count: 0 };
      run.count = cell.firstSample + cell.sampleCount - run.first;
      this.samples.set(outputs, run);
      const transfers = cell.transfers.map((t) => new CodedTransfer(t, cell.sampleCount));
      this.cells.push({ json: cell, outputs, transfers });
    }
  }

  /** Loads codebooks and cluster ids. Surfaces can be shaded by the means of the clusters from then on. */
  async load(bundle) {
    await Promise.all(this.cells.flatMap((cell) => cell.transfers.map((t) => t.load(bundle))));
    for (const [outputs, run] of this.samples) run.lit = new Float32Array(run.count * shadedOutputs(outputs) * 3);
  }

  /** Returns all planes that can be loaded, in the order in which they are wanted. */
  planes(bundle) {
    const list = [];
    for (const cell of this.cells)
      for (const transfer of cell.transfers)
        transfer.json.planes.forEach((plane, index) => list.push({ transfer, plane, index }));
    const priority = ({ plane }) => bundle.extension.payloads[plane.payload].priority;
    return list.sort((a, b) => priority(a) - priority(b));
  }

  /** Computes the light at all samples; `light` is in the group's frame (see LambentScene.update). */
  shade(light) {
    for (const run of this.samples.values()) run.lit.fill(0);
    for (const cell of this.cells) {
      const run = this.samples.get(cell.outputs);
      for (const transfer of cell.transfers) transfer.shade(light, run.lit, cell.json.firstSample - run.first);
    }
  }

  /** Returns bands 0..2 of the visibility at glossy samples, nine numbers each, or null where there is none. */
  seen(outputs) {
    const run = this.samples.get(outputs);
    const cells = this.cells.filter((c) => c.outputs === outputs && c.transfers[0].isVisibility);
    if (cells.length === 0) return null;
    const out = new Float32Array(run.count * 9);
    for (const cell of cells) {
      const transfer = cell.transfers[0], { vectors } = transfer.codebook, { size } = transfer.shape;
      const low = new Float32Array((vectors.length / size) * 9);
      for (let v = 0; v < low.length / 9; ++v) low.set(vectors.subarray(v * size, v * size + 9), v * 9);
      transfer.combine(low, 9, out, cell.json.firstSample - run.first);
    }
    return out;
  }
}

/** Writes Σ weight x sample of rows `first` to `last`, `width` numbers each, at a stride. Empty rows are left alone. */
export function gatherRows(rows, first, last, lit, firstSample, width, out, stride = width) {
  const { offsets, samples, weights } = rows;
  for (let row = first; row < last; ++row) {
    const begin = offsets[row], end = offsets[row + 1], to = (row - first) * stride;
    if (begin === end) continue;
    for (let k = 0; k < width; ++k) {
      let sum = 0;
      for (let e = begin; e < end; ++e) sum += (weights ? weights[e] : 1) * lit[(samples[e] - firstSample) * width + k];
      out[to + k] = sum;
    }
  }
}
