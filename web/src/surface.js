// A draw of the bundle: one side of a primitive at a node, with a mesh of its own in three's scene.
import {
  BackSide, BufferAttribute, BufferGeometry, DataTexture, DataUtils, DynamicDrawUsage, FrontSide, HalfFloatType,
  InterleavedBuffer, InterleavedBufferAttribute, LinearFilter, Matrix3, RGBAFormat, Vector3,
} from 'three';
import { gatherRows } from './group.js';
import { shadedOutputs } from './coded_transfer.js';
import { unoccludedTransfer } from './sh.js';
import { isMatte, litMaterial } from './material.js';

const VECTOR_WIDTH = 4, MAPPED_WIDTH = 28; // numbers per vertex: light, and the open share of the sky

export class Surface {
  constructor(draw, group, rows, vertexCount) {
    Object.assign(this, { draw, group, rows, vertexCount });
    this.mapped = draw.outputs > 1;
    this.width = this.mapped ? MAPPED_WIDTH : VECTOR_WIDTH;
    this.values = new Float32Array(vertexCount * this.width);
  }

  /** Puts the surface into the scene: `mesh` is three's mesh of the primitive, `groupFromMesh` is at rest. */
  attach(mesh, groupFromMesh, groupFromWorld) {
    const back = this.draw.side === 'back';
    this.findNormals(mesh.geometry, groupFromMesh, back);
    const geometry = new BufferGeometry();
    geometry.setIndex(mesh.geometry.index);
    for (const [name, attribute] of Object.entries(mesh.geometry.attributes)) geometry.setAttribute(name, attribute);
    geometry.boundingBox = mesh.geometry.boundingBox;
    geometry.boundingSphere = mesh.geometry.boundingSphere;
    if (this.mapped) {
      this.buffer = new InterleavedBuffer(this.values, MAPPED_WIDTH).setUsage(DynamicDrawUsage);
      for (let i = 0; i < 7; ++i)
        geometry.setAttribute(`lambentLight${i}`, new InterleavedBufferAttribute(this.buffer, 4, 4 * i));
    } else {
      this.buffer = new BufferAttribute(this.values, VECTOR_WIDTH).setUsage(DynamicDrawUsage);
      geometry.setAttribute('lambentLight', this.buffer);
    }
    const uniforms = { lambentGroupFromWorld: { value: groupFromWorld } };
    const { texels } = this.draw;
    if (texels) {
      this.texture = new DataTexture(
        new Uint16Array(4 * texels.side ** 2), texels.side, texels.side, RGBAFormat, HalfFloatType);
      this.texture.magFilter = this.texture.minFilter = LinearFilter;
      uniforms.lambentTexels = { value: this.texture };
      geometry.setAttribute('lambentUv', mesh.geometry.getAttribute(texels.texcoord === 1 ? 'uv1' : 'uv'));
    }
    const isDefault = mesh.userData.lambentDefaultMaterial === true;
    this.material = litMaterial(mesh.material, {
      matte: isMatte(mesh.material, isDefault),
      mapped: this.mapped,
      texels: Boolean(texels),
      normalWeight: Boolean(geometry.getAttribute('_normal_weight')),
      side: back ? BackSide : FrontSide,
      uniforms,
    });
    this.geometry = geometry;
  }

  // Keeps unit normals in the group's frame, on the visible side, for light where nothing is known of shadows.
  findNormals(geometry, groupFromMesh, back) {
    const matrix = new Matrix3().getNormalMatrix(groupFromMesh), normal = new Vector3();
    const source = geometry.getAttribute('normal');
    this.normals = new Float32Array(3 * this.vertexCount);
    for (let v = 0; v < this.vertexCount; ++v) {
      normal.fromBufferAttribute(source, v).applyMatrix3(matrix).normalize();
      this.normals.set([normal.x, normal.y, normal.z].map((n) => (back ? -n : n)), 3 * v);
    }
  }

  /** Writes light at all vertices as if nothing were in the way; `rgb` is light in the group's frame. */
  shadeUnshadowed(rgb, onlyEmptyRows) {
    const order = Math.sqrt(rgb.length / 3), transfer = new Float64Array(order * order);
    const { offsets } = this.rows;
    for (let v = 0; v < this.vertexCount; ++v) {
      if (onlyEmptyRows && offsets[v] !== offsets[v + 1]) continue;
      const at = v * this.width;
      if (this.mapped) {
        for (let k = 0; k < 27; ++k) this.values[at + k] = rgb[k] ?? 0;
        continue;
      }
      const [x, y, z] = this.normals.subarray(3 * v, 3 * v + 3);
      unoccludedTransfer(order, x, y, z, transfer);
      for (let c = 0; c < 3; ++c) {
        let sum = 0;
        for (let i = 0; i < transfer.length; ++i) sum += transfer[i] * rgb[3 * i + c];
        this.values[at + c] = sum;
      }
    }
  }

  /** Takes light from the group's samples. `rgb` shades vertices that have none. */
  shade(rgb, unshadowed) {
    const run = this.group.samples.get(this.draw.outputs), width = shadedOutputs(this.draw.outputs) * 3;
    this.shadeUnshadowed(rgb, !unshadowed);
    if (!unshadowed)
      gatherRows(this.rows, 0, this.vertexCount, run.lit, run.first, width, this.values, this.width);
    if (this.texture) this.shadeTexels(run, unshadowed);
    this.upload();
  }

  shadeTexels(run, unshadowed) {
    // Without shadows the vertices know better, so texels are only used with transfer.
    const side = this.draw.texels.side, count = side * side, { data } = this.texture.image;
    const light = new Float32Array(3 * count);
    if (!unshadowed)
      gatherRows(this.rows, this.vertexCount, this.vertexCount + count, run.lit, run.first, 3, light);
    const one = DataUtils.toHalfFloat(1);
    for (let t = 0; t < count; ++t) {
      for (let c = 0; c < 3; ++c) data[4 * t + c] = DataUtils.toHalfFloat(light[3 * t + c]);
      data[4 * t + 3] = unshadowed ? 0 : one;
    }
    this.texture.needsUpdate = true;
  }

  /**
   * Keeps the open share of the sky at each vertex, E/π under light of radiance 1 without bounces, which the samples
   * hold at this moment. Of glossy cells the light is the visibility itself, so the same formula serves.
   */
  keepOpenShare() {
    const run = this.group.samples.get(this.draw.outputs), width = shadedOutputs(this.draw.outputs) * 3;
    const light = new Float32Array(this.vertexCount * width), y = new Float64Array(9);
    gatherRows(this.rows, 0, this.vertexCount, run.lit, run.first, width, light);
    for (let v = 0; v < this.vertexCount; ++v) {
      let open = light[v * width];
      if (this.mapped) {
        unoccludedTransfer(3, ...this.normals.subarray(3 * v, 3 * v + 3), y);
        open = 0;
        for (let j = 0; j < 9; ++j) open += y[j] * light[v * width + 3 * j];
      }
      if (this.rows.offsets[v] === this.rows.offsets[v + 1]) open = 1;
      this.values[v * this.width + this.width - 1] = open;
    }
    this.upload();
  }

  upload() {
    this.buffer.needsUpdate = true;
  }

  dispose() {
    this.geometry?.dispose();
    this.material?.dispose();
    this.texture?.dispose();
  }
}

