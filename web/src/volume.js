// A volume (docs/format.md, "volume"): its density and the light in it as 3D textures, and the box in three's scene
// whose pixels march through them.
import {
  AddEquation, BackSide, BoxGeometry, CustomBlending, Data3DTexture, DataUtils, HalfFloatType, LinearFilter, Matrix3,
  Matrix4, Mesh, NearestFilter, OneFactor, OneMinusSrcAlphaFactor, RGBAFormat, RedFormat, ShaderMaterial,
  UnsignedByteType, Vector2, Vector3, WebGL3DRenderTarget,
} from 'three';
import { integerList } from './gpu_textures.js';
import { VOLUME_VERTEX, volumeFragment } from './volume_text.js';

const BLOCK = 8; // voxels of the density along an edge of a block
const STEP = 1; // voxels
const uniform = (value) => ({ value });

function texture3D(data, [x, y, z], type, filter) {
  const texture = new Data3DTexture(data, x, y, z);
  return Object.assign(texture, {
    format: RedFormat, type, magFilter: filter, minFilter: filter, unpackAlignment: 1, needsUpdate: true,
  });
}

// Marks the blocks in which a ray finds density, also between the last voxels of a block and its neighbour's.
function filledBlocks(codes, size) {
  const count = size.map((n) => Math.ceil(n / BLOCK)), filled = new Uint8Array(count[0] * count[1] * count[2]);
  const around = (voxel, n) => {
    const own = Math.floor(voxel / BLOCK), place = voxel % BLOCK;
    return [place === 0 && own > 0 ? own - 1 : own, place === BLOCK - 1 ? Math.min(own + 1, n - 1) : own];
  };
  for (let z = 0, at = 0; z < size[2]; ++z)
    for (let y = 0; y < size[1]; ++y)
      for (let x = 0; x < size[0]; ++x, ++at) {
        if (codes[at] === 0) continue;
        const [i0, i1] = around(x, count[0]), [j0, j1] = around(y, count[1]), [k0, k1] = around(z, count[2]);
        for (let k = k0; k <= k1; ++k)
          for (let j = j0; j <= j1; ++j)
            for (let i = i0; i <= i1; ++i) filled[i + count[0] * (j + count[1] * k)] = 255;
      }
  return texture3D(filled, count, UnsignedByteType, NearestFilter);
}

// The slabs of a texture, one for each output: behind each other along z, and side by side along x where that is full.
// A device with small textures keeps fewer bands.
function slabsOf([x, y, z], outputs, most) {
  for (let bands = Math.sqrt(outputs); ; --bands) {
    const along = Math.max(1, Math.min(Math.floor(most / z), bands * bands));
    const beside = Math.ceil((bands * bands) / along);
    if (x * beside <= most || bands === 1) return { bands, along, size: [x * beside, y, z * along] };
  }
}

export class Volume {
  constructor(json, group, run) {
    Object.assign(this, { json, group, run });
  }

  async load(bundle) {
    const { codes, voxels } = await bundle.volumeGrid(this.json, this.run.count), largest = 2 ** this.json.bits - 1;
    const halves = Uint16Array.from(codes, (code) => DataUtils.toHalfFloat(code / largest));
    this.density = texture3D(halves, this.json.size, HalfFloatType, LinearFilter);
    this.filled = filledBlocks(codes, this.json.size);
    // Of each voxel the entry of its light, plus 1; 0 where there is no sample.
    const [x, y, z] = this.json.transferSize, entryOf = this.group.entriesOf(this.run);
    this.entries = integerList(x * y * z, 2);
    voxels.forEach((voxel, i) => (this.entries.image.data[2 * voxel] = entryOf(this.run.first + i) + 1));
  }

  /** Makes the box; `scene` is the LambentScene, and `worldFromGroup` is at rest. */
  makeMesh(scene, index) {
    const { size, transferSize, matrix, albedo, densityMax } = this.json;
    this.uniforms = {
      density: uniform(this.density), filled: uniform(this.filled), light: uniform(null), depth: uniform(null),
      projection: uniform(new Matrix4()), boxFromView: uniform(new Matrix4()), groupFromView: uniform(new Matrix3()),
      size: uniform(new Vector3(...size)), transferSize: uniform(new Vector3(...transferSize)),
      lightSize: uniform(new Vector3()), albedo: uniform(new Vector3(...albedo)), corner: uniform(new Vector2()),
      densityScale: uniform(densityMax), stepVoxels: uniform(STEP), slabsZ: uniform(1),
    };
    this.material = new ShaderMaterial({
      vertexShader: VOLUME_VERTEX, uniforms: this.uniforms, side: BackSide, depthTest: false, depthWrite: false,
      transparent: true, blending: CustomBlending, blendEquation: AddEquation, blendSrc: OneFactor,
      blendDst: OneMinusSrcAlphaFactor,
    });
    this.material.allowOverride = false;
    this.mesh = new Mesh(new BoxGeometry(), this.material);
    this.mesh.name = 'volume';
    this.mesh.matrixAutoUpdate = false;
    this.mesh.onBeforeRender = (renderer, root, camera) => {
      if (!scene.prepare(renderer)) return;
      this.look(camera, scene.worldFromGroup(index));
      Object.assign(this.uniforms.depth, { value: scene.depthOf(renderer, root, camera, this.uniforms.corner.value) });
    };
    // The box, from -1/2 to 1/2, in the group's frame.
    return new Matrix4().fromArray(matrix)
      .multiply(new Matrix4().makeScale(...size)).multiply(new Matrix4().makeTranslation(0.5, 0.5, 0.5));
  }

  look(camera, worldFromGroup) {
    const { projection, boxFromView, groupFromView } = this.uniforms;
    projection.value.copy(camera.projectionMatrix);
    boxFromView.value.multiplyMatrices(camera.matrixWorldInverse, this.mesh.matrixWorld)
      .multiply(new Matrix4().makeTranslation(-0.5, -0.5, -0.5)).invert();
    groupFromView.value.setFromMatrix4(worldFromGroup.premultiply(camera.matrixWorldInverse).invert());
  }

  /** Makes the texture of the light as large as the device allows. */
  makeTarget(renderer) {
    if (this.target) return;
    const gl = renderer.getContext(), { transferSize } = this.json;
    const slabs = slabsOf(transferSize, this.run.outputs, gl.getParameter(gl.MAX_3D_TEXTURE_SIZE));
    this.target = new WebGL3DRenderTarget(...slabs.size, {
      type: HalfFloatType, format: RGBAFormat, magFilter: LinearFilter, minFilter: LinearFilter, depthBuffer: false,
    });
    this.slabsZ = slabs.along;
    this.outputs = slabs.bands * slabs.bands;
    this.uniforms.light.value = this.target.texture;
    this.uniforms.lightSize.value.set(...slabs.size);
    this.uniforms.slabsZ.value = slabs.along;
    this.material.fragmentShader = volumeFragment(slabs.bands);
    this.material.needsUpdate = true;
  }

  /** Takes light from the samples, which have been shaded, or where there is no transfer the light itself, `open`. */
  shade(renderer, passes, open) {
    this.makeTarget(renderer);
    passes.volume(renderer, this.target, {
      samples: this.run.target.texture, entries: this.entries, size: this.uniforms.transferSize.value,
      slabsZ: this.slabsZ, outputs: this.outputs, isOpen: open !== null, open: open ?? new Float32Array(192), g: this.json.g,
    });
  }

  dispose() {
    for (const one of [this.density, this.filled, this.entries, this.target, this.material, this.mesh?.geometry])
      one?.dispose();
  }
}
