// Shadow cubes of lamps: distances from the lamp as six tiles in a row of one texture, a row for each lamp, or for each
// sphere of one. 0 means that nothing is there. A row is drawn anew when its lamp or something that casts shadows has
// moved.
import {
  DoubleSide, FloatType, Matrix3, Matrix4, Mesh, NearestFilter, NoBlending, PerspectiveCamera, RedFormat, Scene,
  ShaderMaterial, Vector3, WebGLRenderTarget,
} from 'three';
import { MOST_CUBES } from './local_lights.js';

export const CUBE_SIZE = 512; // texels along an edge of a face
const NEAR = 2e-3, FAR = 1e6;
const FACES = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

const VERTEX = /* glsl */ `
uniform mat3 maskTransform;
varying vec3 fromLight;
varying vec2 vMaskUv;
#ifdef MASK_UV
attribute vec2 MASK_UV;
#endif
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  fromLight = world.xyz - cameraPosition;
  #ifdef MASK_UV
    vMaskUv = (maskTransform * vec3(MASK_UV, 1.0)).xy;
  #endif
  gl_Position = projectionMatrix * viewMatrix * world;
}`;
const FRAGMENT = /* glsl */ `
uniform sampler2D mask;
uniform float coverage, cutoff;
uniform float hole; // the lamp's own body, which is nearer to its centre, casts no shadow
varying vec3 fromLight;
varying vec2 vMaskUv;
void main() {
  #ifdef MASK_UV
    if (coverage * texture2D(mask, vMaskUv).a < cutoff) discard;
  #endif
  float metres = length(fromLight);
  if (metres < hole) discard;
  gl_FragDepth = metres / (1.0 + metres);
  gl_FragColor = vec4(metres, 0.0, 0.0, 1.0);
}`;

function casterMaterial({ map, opacity, alphaTest }, hole) {
  const masked = map && alphaTest > 0;
  if (masked) map.updateMatrix();
  return new ShaderMaterial({
    vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, blending: NoBlending,
    defines: masked ? { MASK_UV: map.channel === 0 ? 'uv' : `uv${map.channel}` } : {},
    uniforms: {
      mask: { value: masked ? map : null }, maskTransform: { value: masked ? map.matrix : new Matrix3() },
      coverage: { value: opacity }, cutoff: { value: alphaTest }, hole,
    },
  });
}

export class ShadowCubes {
  /** `meshes` cast shadows, both sides of each, unless they are blended. `texture` is the uniform of the texture. */
  constructor(meshes, texture) {
    this.texture = texture;
    this.hole = { value: 0 };
    this.scene = new Scene();
    this.scene.matrixWorldAutoUpdate = false;
    this.casters = meshes.filter(({ material }) => !material.transparent).map((source) => {
      const caster = new Mesh(source.geometry, casterMaterial(source.material, this.hole));
      caster.matrixAutoUpdate = false;
      this.scene.add(caster);
      return { source, caster };
    });
    this.cameras = FACES.map((forward, face) => {
      const camera = new PerspectiveCamera(90, 1, NEAR, FAR), ahead = new Vector3(...forward);
      const up = face === 2 || face === 3 ? new Vector3(0, 0, 1) : new Vector3(0, 1, 0);
      camera.matrixAutoUpdate = camera.matrixWorldAutoUpdate = false;
      camera.userData.turn = new Matrix4().makeBasis(ahead.clone().cross(up), up, ahead.negate());
      return camera;
    });
    this.drawn = []; // the lamps of the rows, where they stood
  }

  /** Draws what has changed around lamps; `passes` keep the renderer as it was. */
  update(renderer, passes, lamps) {
    let moved = false;
    for (const { source, caster } of this.casters) {
      if (caster.matrixWorld.equals(source.matrixWorld)) continue;
      caster.matrixWorld.copy(source.matrixWorld);
      moved = true;
    }
    if (moved) this.forget();
    if (lamps.length > this.rows) this.makeRoom(lamps.length);
    const drawn = ({ position, hole }, row) =>
      this.drawn[row]?.position.equals(position) && this.drawn[row].hole === hole;
    const changed = lamps.map((_, row) => row).filter((row) => !drawn(lamps[row], row));
    if (changed.length > 0)
      passes.during(renderer, () => changed.forEach((row) => this.draw(renderer, row, lamps[row])));
  }

  get rows() {
    return this.target ? this.target.height / CUBE_SIZE : 0;
  }

  makeRoom(rows) {
    this.target?.dispose();
    this.target = new WebGLRenderTarget(6 * CUBE_SIZE, Math.min(rows, MOST_CUBES) * CUBE_SIZE, {
      type: FloatType, format: RedFormat, magFilter: NearestFilter, minFilter: NearestFilter, depthBuffer: true,
    });
    this.target.scissorTest = true;
    this.texture.value = this.target.texture;
    this.forget();
  }

  draw(renderer, row, { position, hole }) {
    this.hole.value = hole;
    this.cameras.forEach((camera, face) => {
      camera.matrixWorld.copy(camera.userData.turn).setPosition(position);
      camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
      this.target.viewport.set(face * CUBE_SIZE, row * CUBE_SIZE, CUBE_SIZE, CUBE_SIZE);
      this.target.scissor.copy(this.target.viewport);
      this.drawFace(renderer, this.target, camera);
    });
    this.drawn[row] = { position: position.clone(), hole };
  }

  drawFace(renderer, target, camera) {
    renderer.setRenderTarget(target);
    renderer.setClearColor(0x000000, 0);
    renderer.clear();
    renderer.render(this.scene, camera);
  }

  /** Makes the next update draw all rows. */
  forget() {
    this.drawn = [];
  }

  dispose() {
    this.target?.dispose();
    for (const { caster } of this.casters) caster.material.dispose();
  }
}
