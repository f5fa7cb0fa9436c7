// Passes that multiply transfer with light on the GPU, as lambent-demo's compute kernels do. They run when light or
// transfer changed, in steps:
//   products: each mean and axis of a codebook, X, times the light at each light probe, Y: Σ_r X_v,r Y_r,o for every
//             output o
//   samples:  mean + Σ code x axis of each sample, blended over its light probes
//   texels:   Σ weight x sample, for draws that keep their light in a texture
//   grid:     the change of light around a body as a picture
//   volume:   the light in a volume as a 3D texture
// Vertices take their samples themselves (shader_text.js).
import {
  BufferAttribute, BufferGeometry, Camera, Color, GLSL3, Mesh, NoBlending, RawShaderMaterial, Scene,
} from 'three';
import { PLACE_TEXT } from './gpu_textures.js';

const HEAD = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
out vec4 result;
${PLACE_TEXT}
vec4 entry(sampler2D list, int i) { return texelFetch(list, lambentPlace(i), 0); }
uvec4 words(usampler2D list, int i) { return texelFetch(list, lambentPlace(i), 0); }
uniform int width, firstRow; // of the rows of the target that are written
int written() { return (int(gl_FragCoord.y) - firstRow) * width + int(gl_FragCoord.x); }
`;

const PRODUCTS = /* glsl */ `${HEAD}
uniform sampler2D vectors; // four coordinates in each entry
uniform sampler2D lights;  // of each light probe and coordinate, the outputs
uniform int vectorCount, vectorEntries, outputs;
void main() {
  int all = written() / outputs, v = all % vectorCount, o = written() % outputs;
  int light = all / vectorCount * vectorEntries * 4 * outputs + o;
  result = vec4(0.0);
  for (int r = 0; r < vectorEntries; ++r) {
    vec4 x = entry(vectors, v * vectorEntries + r);
    for (int k = 0; k < 4; ++k) result += x[k] * entry(lights, light + (4 * r + k) * outputs);
  }
}`;

const samplesText = (transfers) => /* glsl */ `${HEAD}
${Array.from({ length: transfers }, (_, t) => `
uniform sampler2D products${t};
uniform usampler2D codes${t};   // four codes in each entry
uniform usampler2D places${t};  // of each sample: its cluster's first product, count of entries and light probes, the
                                // first entry, weights of light probes
uniform ivec2 counts${t};       // of vectors, and of light probes`).join('')}
uniform int sampleCount, outputs;
void main() {
  int s = written() / outputs, o = written() % outputs;
  result = vec4(0.0);
  if (s >= sampleCount) return;
  ${Array.from({ length: transfers }, (_, t) => `{
    uvec4 place = words(places${t}, s);
    for (int l = 0; l < 4; ++l) {
      bool shared = counts${t}.y == 1;
      float weight = shared ? 1.0 : float((place.w >> (8 * l)) & 255u) / 255.0;
      if (weight == 0.0) continue;
      int light = shared ? 0 : int((place.y >> (8 + 6 * l)) & 63u);
      int p = (light * counts${t}.x + int(place.x)) * outputs + o;
      vec4 sum = entry(products${t}, p);
      for (uint e = 0u; e < (place.y & 255u); ++e) {
        vec4 code = vec4(words(codes${t}, int(place.z + e)));
        for (int k = 0; k < 4; ++k) sum += code[k] * entry(products${t}, p += outputs);
      }
      result += weight * sum;
      if (shared) break;
    }
  }`).join('\n  ')}
}`;

const TEXELS = /* glsl */ `${HEAD}
uniform sampler2D samples;
uniform usampler2D rows, entries;
void main() {
  uvec4 row = words(rows, written());
  result = vec4(0.0);
  if (row.y == 0u) return;
  if (row.y == 1u) result = entry(samples, int(row.x));
  for (uint e = 0u; row.y > 1u && e < row.y; ++e) {
    uvec4 one = words(entries, int(row.x + e));
    result += uintBitsToFloat(one.y) * entry(samples, int(one.x));
  }
  result.a = 1.0;
}`;

// The outputs of points side by side, slices of z one above the other (grid.js).
const GRID = /* glsl */ `${HEAD}
uniform sampler2D samples;
uniform vec3 size;
uniform int outputs;
void main() {
  ivec3 counts = ivec3(size);
  ivec2 at = ivec2(gl_FragCoord.xy);
  int point = at.y * counts.x + at.x % counts.x; // slices of z follow each other, as points do
  result = entry(samples, point * outputs + at.x / counts.x);
}`;

// Output j of a voxel goes to slab j of the texture, times g^l of its band: the convolution with the phase function.
// Alpha 1 marks voxels with light.
const VOLUME = /* glsl */ `${HEAD}
uniform sampler2D samples;
uniform usampler2D entries;
uniform vec3 size, open[64];
uniform float g;
uniform int slabsZ, outputs, layer;
uniform bool isOpen;
void main() {
  ivec3 counts = ivec3(size), at = ivec3(gl_FragCoord.xy, layer);
  int j = at.x / counts.x * slabsZ + at.z / counts.z;
  at -= ivec3(at.x / counts.x, 0, at.z / counts.z) * counts;
  uint place = words(entries, at.x + counts.x * (at.y + counts.y * at.z)).r;
  result = vec4(0.0);
  if (place == 0u || j >= outputs) return;
  vec3 light = isOpen ? (outputs == 1 ? 0.282094792 : 1.0) * open[j] : entry(samples, int(place) - 1 + j).rgb;
  float factor = 1.0;
  for (int band = 1; band * band <= j; ++band) factor *= g;
  result = vec4(clamp(factor * light, -65504.0, 65504.0), 1.0);
}`;

const VERTICES = 'in vec3 position; void main() { gl_Position = vec4(position, 1.0); }';

export class Passes {
  constructor() {
    this.materials = new Map();
    this.camera = new Camera();
    this.scene = new Scene();
    this.scene.matrixWorldAutoUpdate = false;
    const triangle = new BufferGeometry();
    triangle.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.mesh = new Mesh(triangle);
    this.mesh.frustumCulled = false;
    this.scene.add(this.mesh);
  }

  material(name, text) {
    if (!this.materials.has(name))
      this.materials.set(name, new RawShaderMaterial({
        glslVersion: GLSL3, vertexShader: VERTICES, fragmentShader: text(), blending: NoBlending, depthTest: false,
        depthWrite: false, uniforms: { width: { value: 0 }, firstRow: { value: 0 } },
      }));
    return this.materials.get(name);
  }

  /** Runs `work`, which draws, and leaves the renderer as it was, also in the middle of a picture. */
  during(renderer, work) {
    const { xr, shadowMap, autoClear } = renderer;
    const before = [renderer.getRenderTarget(), renderer.getActiveCubeFace(), renderer.getActiveMipmapLevel()];
    const xrEnabled = xr.enabled, { autoUpdate } = shadowMap;
    const clear = renderer.getClearColor(new Color()), clearAlpha = renderer.getClearAlpha();
    xr.enabled = shadowMap.autoUpdate = renderer.autoClear = false;
    try {
      work();
    } finally {
      renderer.setRenderTarget(...before);
      renderer.setClearColor(clear, clearAlpha);
      Object.assign(renderer, { autoClear });
      xr.enabled = xrEnabled;
      shadowMap.autoUpdate = autoUpdate;
    }
  }

  // Draws rows of a target, or of a layer of it.
  draw(renderer, material, target, firstRow, rows, uniforms, layer = 0) {
    for (const [name, value] of Object.entries({ ...uniforms, width: target.width, firstRow }))
      (material.uniforms[name] ??= { value: null }).value = value;
    material.uniformsNeedUpdate = true;
    target.viewport.set(0, firstRow, target.width, rows);
    target.scissor.copy(target.viewport);
    this.mesh.material = material;
    renderer.setRenderTarget(target, layer);
    renderer.render(this.scene, this.camera);
  }

  products(renderer, target, uniforms) {
    this.draw(renderer, this.material('products', () => PRODUCTS), target, 0, target.height, uniforms);
  }

  samples(renderer, target, firstRow, rows, transfers, uniforms) {
    const all = { ...uniforms };
    transfers.forEach((textures, t) => {
      for (const [name, value] of Object.entries(textures)) all[`${name}${t}`] = value;
    });
    const material = this.material(`samples${transfers.length}`, () => samplesText(transfers.length));
    this.draw(renderer, material, target, firstRow, rows, all);
  }

  texels(renderer, target, uniforms) {
    this.draw(renderer, this.material('texels', () => TEXELS), target, 0, target.height, uniforms);
  }

  grid(renderer, target, uniforms) {
    this.draw(renderer, this.material('grid', () => GRID), target, 0, target.height, uniforms);
  }

  volume(renderer, target, uniforms) {
    const material = this.material('volume', () => VOLUME);
    for (let layer = 0; layer < target.depth; ++layer)
      this.draw(renderer, material, target, 0, target.height, { ...uniforms, layer }, layer);
  }

  dispose() {
    for (const material of this.materials.values()) material.dispose();
    this.mesh.geometry.dispose();
  }
}
