// The light that the triangles of a capture proxy send out, which is linear in the light at the group's light probes:
// each triangle reflects E/π of a few samples, and emits the light of a lamp. The product of reflectances and transfer
// is taken once, so a change of light costs one product for each triangle and probe.
import { Vector3 } from 'three';
import { gauntTable } from './gaunt.js';
import { unoccludedTransfer } from './sh.js';

const NORMAL_OUTPUTS = 9; // of samples whose light is in bands; E/π is taken at the triangle's normal

function normalOf({ positions }, { corners }) {
  const [a, b, c] = corners.map((corner) => new Vector3().fromArray(positions, 3 * corner));
  const across = b.sub(a).cross(c.sub(a));
  return across.lengthSq() > 0 ? across.normalize() : across.set(0, 1, 0);
}

// Returns the weights by which the outputs of samples become E/π at the normal of a triangle.
function outputWeights(proxy, triangle, outputs) {
  if (outputs === 1) return [1];
  const { x, y, z } = normalOf(proxy, triangle);
  return unoccludedTransfer(3, x, y, z, new Float64Array(NORMAL_OUTPUTS));
}

// Adds what coordinates (rank x RGB) in the basis of plain transfer vectors make of each column of light.
function addVectors(transfer, coordinates, outputs, firstChannel, channels, out) {
  const { shape, codebook: { rank, basis } } = transfer, stride = shape.outputs * shape.columns;
  for (let r = 0; r < rank; ++r)
    for (let c = 0; c < 3; ++c) {
      const factor = coordinates[3 * r + c];
      if (factor === 0) continue;
      const at = r * shape.size + (firstChannel + (channels === 1 ? 0 : c)) * stride;
      for (let o = 0; o < outputs.length; ++o)
        for (let i = 0, from = at + o * shape.columns; i < shape.columns; ++i)
          out[3 * i + c] += factor * outputs[o] * basis[from + i];
    }
}

function addVisibility(transfer, coordinates, outputs, out) {
  const { shape, codebook: { rank, basis } } = transfer, values = new Float64Array(3 * shape.size);
  for (let r = 0; r < rank; ++r)
    for (let k = 0; k < shape.size; ++k)
      for (let c = 0; c < 3; ++c) values[3 * k + c] += coordinates[3 * r + c] * basis[r * shape.size + k];
  const { j, k, m, value } = gauntTable(3, shape.visibilityBands, shape.order);
  for (let t = 0; t < value.length; ++t)
    for (let c = 0; c < 3; ++c) out[3 * m[t] + c] += outputs[j[t]] * value[t] * values[3 * k[t] + c];
}

// Adds the share of one transfer to what counts with bounces and to what counts without.
function addTransfer(transfer, coordinates, outputs, full, shadowed) {
  const { shape } = transfer, { shadowedChannels, fullChannels } = shape;
  if (shape.visibilityBands > 0) {
    for (const out of [full, shadowed]) addVisibility(transfer, coordinates, outputs, out);
    return;
  }
  if (shadowedChannels > 0) addVectors(transfer, coordinates, outputs, 0, shadowedChannels, shadowed);
  if (fullChannels > 0) addVectors(transfer, coordinates, outputs, shadowedChannels, fullChannels, full);
  else addVectors(transfer, coordinates, outputs, 0, shadowedChannels, full);
}

export class ProxyLight {
  constructor(proxy, group) {
    Object.assign(this, { proxy, group, lists: null });
    this.radiance = new Float64Array(3 * proxy.triangles.length);
  }

  // Finds the cell of a sample, and its light probes with their weights.
  placeOf(sample) {
    const cell = this.group.cells.find(({ json }) => json.kind === 'surface' && sample >= json.firstSample &&
      sample < json.firstSample + json.sampleCount);
    if (!cell) return null;
    const { json, blend } = cell, own = sample - json.firstSample;
    const blended = (k) => [json.lightSamples[blend.lights[4 * own + k]], blend.weights[4 * own + k] / 255];
    const probes = blend ? [0, 1, 2, 3].map(blended) : [[json.lightSamples[0], 1]];
    return { cell, own, probes: probes.filter(([, weight]) => weight > 0) };
  }

  /** Makes the next shading read transfer again, which changes as weight planes come. */
  forgetTransfer() {
    this.lists = null;
  }

  sentBy(triangle) {
    const sums = new Map(), lampSums = new Map(); // of a cell, and of a probe in it, the coordinates of each transfer
    for (const { sample, reflectance } of triangle.entries) {
      const place = this.placeOf(sample);
      if (!place) continue;
      const { cell, own, probes } = place;
      cell.transfers.forEach((transfer, t) => {
        const coordinates = transfer.coordinatesOf(own), ofSky = transfer.shape.order > 0;
        for (const [probe, weight] of ofSky ? probes : [[-1, 1]]) {
          const list = ofSky ? sums : lampSums, key = `${probe}/${cell.json.firstSample}/${t}`;
          if (!list.has(key)) list.set(key, { probe, cell, transfer, sum: new Float64Array(3 * coordinates.length) });
          const { sum } = list.get(key);
          coordinates.forEach((value, r) => {
            for (let c = 0; c < 3; ++c) sum[3 * r + c] += weight * reflectance[c] * value;
          });
        }
      });
    }
    const columnsOf = (list) => {
      const byProbe = new Map();
      for (const { probe, cell, transfer, sum } of list.values()) {
        const columns = Math.max(transfer.shape.columns, transfer.shape.order ** 2);
        if (!byProbe.has(probe)) byProbe.set(probe, { probe, full: [], shadowed: [] });
        const to = byProbe.get(probe);
        for (const name of ['full', 'shadowed'])
          if (to[name].length < 3 * columns)
            to[name] = Float64Array.from({ length: 3 * columns }, (_, i) => to[name][i] ?? 0);
        addTransfer(transfer, sum, outputWeights(this.proxy, triangle, cell.run.outputs), to.full, to.shadowed);
      }
      return [...byProbe.values()];
    };
    return { sky: columnsOf(sums), lamps: columnsOf(lampSums) };
  }

  /** Finds the radiance of all triangles from light at the probes, in the group's frame, and the strengths of lamps. */
  shade(lights, lamps, mode) {
    this.lists ??= this.proxy.triangles.map((triangle) => this.sentBy(triangle));
    this.lists.forEach(({ sky, lamps: columns }, t) => {
      const { lamp, emission } = this.proxy.triangles[t], sum = [0, 0, 0];
      const add = (values, rgb) => {
        const count = Math.min(values.length, rgb.length);
        for (let i = 0; i < count; ++i) sum[i % 3] += values[i] * rgb[i];
      };
      for (const entry of sky) add(entry[mode], lights[lights.length === 1 ? 0 : entry.probe].rgb);
      for (const entry of columns) add(entry[mode], lamps.flat());
      // Truncated light may be negative somewhere, but a surface sends out none that is.
      for (let c = 0; c < 3; ++c)
        this.radiance[3 * t + c] = Math.max(0, sum[c]) + (lamp >= 0 ? emission[c] * lamps[lamp][c] : 0);
    });
  }
}
