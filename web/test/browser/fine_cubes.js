// Draws shadow cubes as a rasterizer with finer vertices would. Chromium's software renderer moves vertices to
// sixteenths of a pixel, where that of lambent-demo has 256ths, so shadows of thin edges lie in other texels. Faces are
// drawn seven times as large, and the middle one of 7 x 7 texels is kept, whose centre is that of the texel.
import {
  FloatType, GLSL3, Mesh, NearestFilter, OrthographicCamera, PlaneGeometry, RawShaderMaterial, RedFormat, Scene,
  WebGLRenderTarget,
} from 'three';
import { CUBE_SIZE, ShadowCubes } from '../../src/shadow_cubes.js';

const FINER = 7;

/** Makes all cubes fine from now on; returns a function that ends it. */
export function drawCubesFinely() {
  const coarse = ShadowCubes.prototype.drawFace, size = FINER * CUBE_SIZE;
  const large = new WebGLRenderTarget(size, size, {
    type: FloatType, format: RedFormat, magFilter: NearestFilter, minFilter: NearestFilter,
  });
  const origin = { value: null };
  const middle = new Mesh(new PlaneGeometry(2, 2), new RawShaderMaterial({
    glslVersion: GLSL3, depthTest: false, depthWrite: false, uniforms: { face: { value: large.texture }, origin },
    vertexShader: 'in vec3 position; void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
    fragmentShader: `precision highp float;
      uniform highp sampler2D face;
      uniform vec4 origin; // of the tile
      out vec4 metres;
      void main() {
        metres = texelFetch(face, ${FINER} * ivec2(gl_FragCoord.xy - origin.xy) + ${FINER >> 1}, 0);
      }`,
  }));
  const scene = new Scene(), camera = new OrthographicCamera();
  middle.frustumCulled = false;
  scene.add(middle);
  ShadowCubes.prototype.drawFace = function (renderer, target, from) {
    coarse.call(this, renderer, large, from);
    origin.value = target.viewport;
    renderer.setRenderTarget(target);
    renderer.render(scene, camera);
  };
  return () => {
    ShadowCubes.prototype.drawFace = coarse;
    large.dispose();
    middle.geometry.dispose();
    middle.material.dispose();
  };
}
