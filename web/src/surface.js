// A draw of the bundle: one side of a primitive at a node, with a mesh of its own in three's scene.
import { BackSide, BufferAttribute, BufferGeometry, FrontSide, Matrix3, Vector2, Vector3 } from 'three';
import { pictureTarget, integerList } from './gpu_textures.js';
import { gridUniforms } from './grid.js';
import { lobeTexture } from './lobe.js';
import { isMatte, litMaterial } from './material.js';
import { packRows } from './rows_texture.js';
import { findSeen, seenKernelTexture, seenList } from './seen_sky.js';

const uniform = (value) => ({ value });

export class Surface {
  constructor(draw, group, rows, vertexCount) {
    Object.assign(this, { draw, group, rows, vertexCount, run: group.runs.get(draw.outputs) });
    this.textures = [];
  }

  /**
   * Puts the surface into the scene: `mesh` is three's mesh of the primitive, `groupFromMesh` is at rest. `shared` are
   * the uniforms of the group, `table` is what the material looks up if it is no diffuse one, or null, and
   * `grids` are those of other bodies; `lamps` says whether there are lamps with shadow cubes, `spheres` whether some of
   * these have a radius, and `ownLamp` is the lamp that the surface is, if any.
   */
  attach(mesh, groupFromMesh, shared, { table, grids, lamps, spheres, ownLamp }) {
    const back = this.draw.side === 'back', glossy = this.draw.outputs > 9;
    const diffuse = isMatte(mesh.material, mesh.userData.lambentDefaultMaterial === true);
    const layered = !glossy && !diffuse && table !== null && table.lobes === 2;
    const geometry = new BufferGeometry();
    geometry.setIndex(mesh.geometry.index);
    for (const [name, attribute] of Object.entries(mesh.geometry.attributes)) geometry.setAttribute(name, attribute);
    geometry.boundingBox = mesh.geometry.boundingBox;
    geometry.boundingSphere = mesh.geometry.boundingSphere;
    const entryOf = this.group.entriesOf(this.run);
    const { words, entries } = packRows(this.rows, 0, this.vertexCount, entryOf);
    geometry.setAttribute('lambentRow', new BufferAttribute(words, 2));
    const normalMatrix = new Matrix3().getNormalMatrix(groupFromMesh).multiplyScalar(back ? -1 : 1);
    this.textures.push(entries);
    this.uniforms = {
      ...shared, lambentSamples: uniform(null), lambentEntries: uniform(entries),
      lambentGroupFromNormal: uniform(normalMatrix), ...gridUniforms(grids),
    };
    this.ownLamp = ownLamp;
    if (ownLamp) this.uniforms.lambentLampPowers = uniform(shared.lambentLampPowers.value.slice());
    if (this.draw.texels) this.attachTexels(mesh, geometry, entryOf);
    const kind = {
      outputs: this.draw.outputs, glossy, layered, table: glossy || layered ? table : null,
      texels: Boolean(this.draw.texels), normalWeight: Boolean(geometry.getAttribute('_normal_weight')),
      grids: glossy ? [] : grids.map((grid) => grid.whole), lamps, spheres,
      framed: Boolean(geometry.getAttribute('tangent') ?? geometry.getAttribute('uv')),
    };
    if (kind.table) {
      this.textures.push(lobeTexture());
      Object.assign(this.uniforms, {
        lambentBrdf: uniform(table.texture), lambentLobes: uniform(lobeTexture()),
        lambentBrdfNodes: uniform(new Vector2(table.roughnesses, table.strengths)),
      });
    }
    if (layered) this.attachSeen(geometry, normalMatrix);
    this.material = litMaterial(mesh.material, kind, back ? BackSide : FrontSide, this.uniforms);
    this.geometry = geometry;
  }

  attachTexels(mesh, geometry, entryOf) {
    const { side, texcoord } = this.draw.texels, count = side * side;
    const { words, entries } = packRows(this.rows, this.vertexCount, this.vertexCount + count, entryOf);
    const rows = integerList(count, 2);
    rows.image.data.set(words);
    this.textures.push(rows, entries);
    this.texels = { rows, entries, target: pictureTarget(side, side) };
    this.uniforms.lambentTexels = uniform(this.texels.target.texture);
    geometry.setAttribute('lambentUv', mesh.geometry.getAttribute(texcoord === 1 ? 'uv1' : 'uv'));
  }

  attachSeen(geometry, normalMatrix) {
    const source = geometry.getAttribute('normal'), normal = new Vector3();
    this.seen = seenList(this.vertexCount);
    this.textures.push(this.seen, seenKernelTexture());
    this.normals = new Float32Array(3 * this.vertexCount);
    for (let v = 0; v < this.vertexCount; ++v)
      normal.fromBufferAttribute(source, v).applyMatrix3(normalMatrix).normalize().toArray(this.normals, 3 * v);
    this.uniforms.lambentSeen = uniform(this.seen);
    this.uniforms.lambentSeenKernel = uniform(seenKernelTexture());
  }

  /** Finds anew what the mirror of a smooth dielectric sees of the sky. */
  findSeen() {
    if (this.seen) findSeen(this.seen, this.group, this.run, this.rows, this.normals);
  }

  /** Takes light from the group's samples, which have been shaded. */
  shade(renderer, passes) {
    const samples = this.run.target.texture;
    this.uniforms.lambentSamples.value = samples;
    if (!this.texels) return;
    const { rows, entries, target } = this.texels;
    passes.texels(renderer, target, { samples, rows, entries });
  }

  // Tables that scenes share come back to the GPU where another scene still draws.
  dispose() {
    this.geometry?.dispose();
    this.material?.dispose();
    this.material?.lambentUniforms?.dfgLUT?.value?.dispose(); // three's own table of metals
    for (const texture of this.textures) texture.dispose();
    this.texels?.target.dispose();
  }
}
