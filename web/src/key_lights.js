// Suns of an environment map. Few bands blur them, so their direct light comes by three's shadow maps, and transfer
// brings what they bounce.
import {
  Color, DataTexture, DirectionalLight, DoubleSide, FloatType, Group, LinearFilter, Matrix4, RGBAFormat, Sphere, Vector3,
} from 'three';
import { LightVector, equirectTexels } from './light_vector.js';
import { projectEquirect } from './sh.js';

const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

/**
 * Divides an environment map into its suns and the rest: at most `most` discs of `radius` (radians) that are 30 times
 * as bright as the mean, and bring at least 4 % of the light. Returns `rest` and `key` as light vectors, `suns` with a
 * direction and the irradiance that falls straight on, and `environment`, the map without them for three's mirrors, in
 * which lights of KeyLights make highlights of their own.
 */
export function splitKeyLights(texture, { order = 5, most = 2, radius = 0.14 } = {}) {
  const { width, height, texel } = equirectTexels(texture), texels = [];
  let total = 0;
  for (let row = 0; row < height; ++row) {
    const top = (Math.PI * row) / height, bottom = (Math.PI * (row + 1)) / height, theta = (top + bottom) / 2;
    const solidAngle = ((2 * Math.PI) / width) * (Math.cos(top) - Math.cos(bottom));
    for (let column = 0; column < width; ++column) {
      const rgb = texel(column, row), bright = luminance(rgb);
      if (!Number.isFinite(bright)) continue;
      total += bright * solidAngle;
      texels.push({ column, row, theta, rgb, bright, solidAngle });
    }
  }
  const least = (30 * total) / (4 * Math.PI);
  const bright = texels.filter((t) => t.bright > least).sort((a, b) => b.bright - a.bright);
  for (const t of bright) {
    const phi = ((t.column + 0.5) / width - 0.5) * 2 * Math.PI, s = Math.sin(t.theta);
    t.direction = new Vector3(s * Math.cos(phi), Math.cos(t.theta), s * Math.sin(phi));
  }
  const suns = [], taken = new Set();
  while (suns.length < most) {
    const first = bright.find((t) => !taken.has(t));
    if (!first) break;
    const disc = bright.filter((t) => !taken.has(t) && t.direction.dot(first.direction) > Math.cos(radius));
    const sun = { direction: new Vector3(), irradiance: new Color(0, 0, 0) };
    for (const t of disc) {
      sun.direction.addScaledVector(t.direction, t.bright * t.solidAngle);
      sun.irradiance.add(new Color(...t.rgb).multiplyScalar(t.solidAngle));
    }
    if (luminance(sun.irradiance.toArray()) < 0.04 * total) break;
    sun.direction.normalize();
    disc.forEach((t) => taken.add(t));
    suns.push(sun);
  }
  const inSun = new Set([...taken].map((t) => t.row * width + t.column)), none = [0, 0, 0];
  const part = (key) => (x, y) => (inSun.has(y * width + x) === key ? texel(x, y) : none);
  const rest = new LightVector(order, projectEquirect(order, width, height, part(false)));
  const key = new LightVector(order, suns.length ? projectEquirect(order, width, height, part(true)) : undefined);
  return { rest, key, suns, environment: suns.length ? withoutTexels(texture, width, height, part(false)) : texture };
}

// Returns a map of the same layout with the radiance of `texel`.
function withoutTexels(texture, width, height, texel) {
  const data = new Float32Array(4 * width * height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) data.set([...texel(x, height - 1 - y), 1], 4 * (y * width + x));
  const map = new DataTexture(data, width, height, RGBAFormat, FloatType);
  const { mapping, wrapS, wrapT } = texture;
  map.magFilter = map.minFilter = LinearFilter;
  return Object.assign(map, { mapping, wrapS, wrapT, needsUpdate: true });
}

/** Fits the shadow map of a directional light to a sphere in the world; world matrices must be up to date. */
export function fitShadow(light, { center, radius }) {
  const [from, to] = [light, light.target].map((end) => new Vector3().setFromMatrixPosition(end.matrixWorld));
  const { camera } = light.shadow, axes = new Matrix4().lookAt(from, to, camera.up); // as three turns the camera
  const { x, y, z } = center.clone().sub(from).applyMatrix4(axes.transpose());
  Object.assign(camera, { left: x - radius, right: x + radius, top: y + radius, bottom: y - radius });
  Object.assign(camera, { near: -z - 1.5 * radius, far: -z + 1.5 * radius });
  camera.updateProjectionMatrix();
  light.shadow.normalBias = (3 * radius) / light.shadow.mapSize.x;
}

/** Lets all meshes below `root` cast and receive shadows, but neither volumes nor what is blended. */
export function takeShadows(root) {
  root.traverse((object) => {
    if (!object.isMesh || object.material.transparent) return;
    object.castShadow = object.receiveShadow = true;
    object.material.shadowSide = DoubleSide; // rooms have walls without a back
  });
}

/** Directional lights for the suns that splitKeyLights found. Turn this group as the light turns. */
export class KeyLights extends Group {
  constructor(suns, { size = 2048 } = {}) {
    super();
    this.lights = suns.map(({ direction, irradiance }) => {
      const light = new DirectionalLight(0xffffff, 1);
      light.color.copy(irradiance);
      light.userData.direction = direction.clone();
      light.castShadow = true;
      light.shadow.mapSize.set(size, size);
      this.add(light, light.target);
      return light;
    });
  }

  /** Fits the shadow maps to a box in the world, and lets all meshes below `root` cast and receive shadows. */
  fit(box, root) {
    const sphere = box.getBoundingSphere(new Sphere()), { center, radius } = sphere;
    this.position.copy(center);
    for (const light of this.lights) {
      light.position.copy(light.userData.direction).multiplyScalar(2 * radius);
      light.updateWorldMatrix(true, false);
      light.target.updateWorldMatrix(true, false);
      fitShadow(light, sphere);
    }
    if (root) takeShadows(root);
    return this;
  }

  dispose() {
    for (const light of this.lights) light.dispose();
  }
}
