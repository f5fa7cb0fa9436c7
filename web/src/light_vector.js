import {
  CubeCamera, DataUtils, Euler, FloatType, HalfFloatType, Matrix3, Matrix4, WebGLCubeRenderTarget,
} from 'three';
import {
  MAX_ORDER, discZonal, evaluateBasis, projectCube, projectEquirect, rotateCoefficients, rotationBands,
} from './sh.js';

const toMatrix3 = (turn) => {
  if (turn.isMatrix3) return turn;
  const matrix = new Matrix4();
  if (turn.isMatrix4) matrix.extractRotation(turn);
  else if (turn.isEuler) matrix.makeRotationFromEuler(turn);
  else matrix.makeRotationFromQuaternion(turn);
  return new Matrix3().setFromMatrix4(matrix);
};

/** A rotation of many lights, of which the harmonics' part is done once; see LightVector.rotate. */
export class Rotation {
  constructor(turn) {
    this.bands = rotationBands(MAX_ORDER, toMatrix3(turn).elements);
  }
}

/** Returns the size of an equirectangular texture, and its radiance at a column and a row from the top. */
export function equirectTexels(texture) {
  const { data, width, height } = texture.image ?? {};
  if (!data) throw new Error('light needs a texture with pixels, as HDRLoader makes it');
  const channels = data.length / (width * height);
  let value = (at) => data[at];
  if (texture.type === HalfFloatType) value = (at) => DataUtils.fromHalfFloat(data[at]);
  else if (!(data instanceof Float32Array)) value = (at) => data[at] / 255;
  // The first row of the data is the bottom of the picture, unless the upload turns it over.
  const texel = (column, row) => {
    const at = ((texture.flipY ? row : height - 1 - row) * width + column) * channels;
    return [value(at), value(at + 1), value(at + 2)];
  };
  return { width, height, texel };
}

/** Light from infinity: the radiance L(s) = Σ l_i y_i(s) that arrives from direction s, as n² x RGB coefficients. */
export class LightVector {
  constructor(order = 5, rgb = new Float64Array(3 * order * order)) {
    this.order = order;
    this.rgb = rgb;
  }

  /** Light of the same radiance from everywhere. */
  static constant(r, g, b, order = 5) {
    const light = new LightVector(order);
    light.rgb.set([r, g, b].map((c) => c * Math.sqrt(4 * Math.PI)));
    return light;
  }

  /** A disc of even radiance about a direction, of an angular radius in radians, such as a sun. */
  static disc(direction, radius, color, order = 5) {
    const light = new LightVector(order), basis = new Float64Array(order * order);
    const { x, y, z } = direction.clone().normalize();
    evaluateBasis(order, x, y, z, basis);
    for (let l = 0; l < order; ++l)
      for (let i = l * l; i < (l + 1) * (l + 1); ++i) {
        const value = Math.sqrt((4 * Math.PI) / (2 * l + 1)) * discZonal(l, radius) * basis[i];
        light.rgb.set([color.r * value, color.g * value, color.b * value], 3 * i);
      }
    return light;
  }

  /**
   * Projects an equirectangular texture whose pixels are at hand, as HDRLoader and EXRLoader make it: half floats,
   * floats or bytes (taken as linear), RGB or RGBA. three.js looks up direction s at u = atan2(s.z, s.x) / 2π + 0.5,
   * which is the layout of docs/conventions.md.
   */
  static fromEquirect(texture, order = 5) {
    const { width, height, texel } = equirectTexels(texture);
    return new LightVector(order, projectEquirect(order, width, height, texel));
  }

  /**
   * Renders what stands around a point of a scene, its background included, and projects it. Baked scenes should be
   * hidden meanwhile, as light is what comes from outside of them.
   */
  static fromScene(renderer, scene, position, order = 5, size = 32) {
    const target = new WebGLCubeRenderTarget(size, { type: FloatType }), camera = new CubeCamera(0.1, 1000, target);
    if (position) camera.position.copy(position);
    camera.update(renderer, scene);
    const faces = [0, 1, 2, 3, 4, 5].map((face) => {
      const pixels = new Float32Array(4 * size * size);
      renderer.readRenderTargetPixels(target, 0, 0, size, size, pixels, face);
      return pixels;
    });
    target.dispose();
    return new LightVector(order, projectCube(order, size, faces));
  }

  clone() {
    return new LightVector(this.order, this.rgb.slice());
  }

  /** Returns the light turned by a Quaternion, Euler, matrix or Rotation. */
  rotate(turn) {
    const out = new LightVector(this.order);
    const bands = turn instanceof Rotation ? turn.bands : rotationBands(this.order, toMatrix3(turn).elements);
    rotateCoefficients(this.order, bands, this.rgb, out.rgb);
    return out;
  }

  /** Returns the light turned about +Y by an angle in radians; positive takes +Z towards +X. */
  rotateY(angle) {
    return this.rotate(new Euler(0, angle, 0));
  }

  add(other) {
    const order = Math.max(this.order, other.order), out = new LightVector(order);
    for (const light of [this, other]) light.rgb.forEach((value, i) => (out.rgb[i] += value));
    return out;
  }

  multiplyScalar(factor) {
    return new LightVector(this.order, this.rgb.map((value) => value * factor));
  }

  /** Returns the light with its first bands alone. */
  truncate(order) {
    return new LightVector(Math.min(order, this.order), this.rgb.slice(0, 3 * Math.min(order, this.order) ** 2));
  }

  /** Returns the radiance that arrives from a direction, as [r, g, b]. */
  radiance(direction) {
    const basis = evaluateBasis(this.order, direction.x, direction.y, direction.z, new Float64Array(this.order ** 2));
    return [0, 1, 2].map((c) => basis.reduce((sum, y, i) => sum + y * this.rgb[3 * i + c], 0));
  }
}

export { MAX_ORDER };
