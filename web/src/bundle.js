// Reads what the extension says of a bundle, and its payloads. Bytes come through a function, so that they may lie in
// memory or arrive piece by piece.
import { decompress } from 'fzstd';
import { shapeOf, decodeCodebook, decodeClusterIds, decodeWeightPlane } from './codebook.js';
import { decodeBrdfTable } from './brdf_table.js';
import { decodeCaptureProxy, decodeLightWeights } from './capture_proxy.js';
import { decodeRows } from './rows.js';
import { decodeDensity, decodeVoxels } from './volume_grid.js';

export const EXTENSION = 'LAMBENT_radiance_transfer';
const OLDEST_VERSION = 5, NEWEST_VERSION = 8;

export class Bundle {
  /** `viewBytes(index)` returns a promise of the bytes of a bufferView. */
  constructor(json, viewBytes) {
    this.json = json;
    this.viewBytes = viewBytes;
    this.extension = json.extensions?.[EXTENSION];
    if (!this.extension) throw new Error(`the file has no extension ${EXTENSION}`);
    const { version } = this.extension;
    if (!(version >= OLDEST_VERSION && version <= NEWEST_VERSION))
      throw new Error(`the bundle has format ${version}, and formats ${OLDEST_VERSION} to ${NEWEST_VERSION} are known`);
  }

  get groups() {
    return this.extension.groups;
  }
  get draws() {
    return this.extension.draws;
  }

  /** Returns the decompressed bytes of a payload of the type that its use asks for. */
  async payload(index, type) {
    const payload = this.extension.payloads[index];
    if (payload?.type !== type) throw new Error(`payload ${index} is no ${type}`);
    const bytes = await this.viewBytes(payload.bufferView);
    if (payload.codec === 'raw') return bytes.subarray(0, payload.rawLength);
    if (payload.codec !== 'zstd') throw new Error(`payload ${index} has the unknown codec ${payload.codec}`);
    const out = decompress(bytes);
    if (out.length !== payload.rawLength) throw new Error(`payload ${index} is damaged: it has another length`);
    return out;
  }

  /** Returns the number of vertices of a draw's primitive. */
  vertexCount(draw) {
    const mesh = this.json.meshes[this.json.nodes[draw.node].mesh];
    return this.json.accessors[mesh.primitives[draw.primitive].attributes.POSITION].count;
  }

  async rows(draw) {
    const texels = draw.texels ? draw.texels.side ** 2 : 0;
    const bytes = await this.payload(draw.rows, 'vertexRows');
    return decodeRows(bytes, this.vertexCount(draw) + texels, this.groups[draw.group].sampleCount);
  }

  /** Returns the codebook of a transfer and the cluster of each sample. */
  async codebook(transfer, samples) {
    const [bytes, ids] = await Promise.all([
      this.payload(transfer.codebook, 'codebook'),
      transfer.clusterIds === undefined ? null : this.payload(transfer.clusterIds, 'clusterIds'),
    ]);
    return {
      codebook: decodeCodebook(bytes, shapeOf(transfer), transfer.clusters),
      clusterOf: decodeClusterIds(ids, transfer.clusters, samples),
    };
  }

  /** Returns how others see a group, or null. */
  async captureProxy({ proxy, sampleCount, lights }) {
    if (proxy === undefined) return null;
    return decodeCaptureProxy(await this.payload(proxy, 'captureProxy'), sampleCount, lights.length);
  }

  /** Returns the light probes of each sample of a cell, or null if all have the same. */
  async lightWeights({ lightWeights, lightSamples, sampleCount }) {
    if (lightWeights === undefined) return null;
    return decodeLightWeights(await this.payload(lightWeights, 'lightWeights'), sampleCount, lightSamples.length);
  }

  async brdfTable(entry) {
    return decodeBrdfTable(await this.payload(entry.payload, 'brdfTable'));
  }

  /** Returns the density codes of a volume, and the voxels of its transfer grid at which its samples lie. */
  async volumeGrid(volume, samples) {
    const [density, voxels] = await Promise.all(
      [this.payload(volume.density, 'density'), this.payload(volume.voxels, 'voxels')]);
    return { codes: decodeDensity(density, volume), voxels: decodeVoxels(voxels, volume.transferSize, samples) };
  }

  async plane(plane) {
    return decodeWeightPlane(await this.payload(plane.payload, 'weightPlane'), plane.bits, plane.count);
  }
}
