// A rigid group: its cells' transfer, and light at its samples.
import { CodedTransfer } from './coded_transfer.js';
import { GRID_OUTPUTS, Grid } from './grid.js';
import { LIST_WIDTH, listTarget, rowsFor } from './gpu_textures.js';
import { Volume } from './volume.js';

export class Group {
  constructor(json) {
    this.json = json;
    // Samples with as many outputs lie in a row, because cells come by rising outputs. Their light is a list of
    // `outputs` entries each, in which every cell begins a row of the target.
    this.runs = new Map(); // outputs, 'volume' or 'neighborhood' -> {first, count, outputs, rows, target}
    this.cells = [];
    for (const cell of json.cells) {
      const isGrid = cell.kind === 'neighborhood', stored = cell.transfers[0].outputs;
      const outputs = isGrid ? Math.min(stored, GRID_OUTPUTS) : stored; // receivers have a normal
      const key = cell.kind === 'surface' ? outputs : cell.kind;
      const run = this.runs.get(key) ?? { first: cell.firstSample, count: 0, outputs, rows: 0, target: null };
      run.count = cell.firstSample + cell.sampleCount - run.first;
      this.runs.set(key, run);
      const rows = rowsFor(cell.sampleCount * outputs);
      const transfers = cell.transfers.map((t) => new CodedTransfer(t, cell.sampleCount, outputs));
      this.cells.push({ json: cell, run, firstRow: run.rows, rows, transfers });
      run.rows += rows;
    }
    // Cells of a grid are as long as whole rows, but for the last, so its points follow each other.
    const around = this.runs.get('neighborhood');
    this.grid = around ? new Grid(json.neighborhood, around, Boolean(json.volume)) : null;
    this.volume = json.volume ? new Volume(json.volume, this, this.runs.get('volume')) : null;
  }

  /** Loads codebooks and cluster ids. Surfaces can be shaded by the means of the clusters from then on. */
  async load(bundle) {
    await Promise.all([this.volume?.load(bundle), ...this.cells.map(async (cell) => {
      cell.blend = await bundle.lightWeights(cell.json);
      await Promise.all(cell.transfers.map((t) => t.load(bundle, cell.blend)));
    })]);
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

  /** Returns a function from samples to the entries of their light. */
  entriesOf(run) {
    const cells = this.cells.filter((cell) => cell.run === run);
    const firstEntry = new Uint32Array(run.count);
    for (const { json, firstRow } of cells)
      for (let s = 0; s < json.sampleCount; ++s)
        firstEntry[json.firstSample - run.first + s] = firstRow * LIST_WIDTH + s * run.outputs;
    return (sample) => firstEntry[sample - run.first];
  }

  /**
   * Takes light in the group's frame, of each light probe or one for all, for surfaces and for what has no shadow maps
   * and cubes (see LambentScene).
   */
  setLight(lights) {
    for (const { json, transfers } of this.cells) {
      const all = lights.map(({ surface, other }) => (json.kind === 'surface' ? surface : other));
      const own = all.length > 1 ? json.lightSamples.map((probe) => all[probe]) : all;
      for (const transfer of transfers) transfer.setLight(transfer.shape.order > 0 ? own : own.slice(0, 1)); // lamps'
    }
  }

  /** Makes the targets of the light at samples; their textures are what surfaces read. */
  makeTargets() {
    for (const run of this.runs.values()) run.target ??= listTarget(run.rows);
  }

  /** Computes the light at all samples on the GPU. */
  shade(renderer, passes) {
    for (const { json, run, firstRow, rows, transfers } of this.cells) {
      for (const transfer of transfers) transfer.multiply(renderer, passes);
      passes.samples(renderer, run.target, firstRow, rows, transfers.map((t) => t.textures),
        { sampleCount: json.sampleCount, outputs: run.outputs });
    }
    this.grid?.draw(renderer, passes);
  }

  dispose() {
    for (const cell of this.cells) for (const transfer of cell.transfers) transfer.dispose();
    for (const run of this.runs.values()) run.target?.dispose();
    this.grid?.dispose();
    this.volume?.dispose();
  }
}
