import { Matrix3, Matrix4, Euler, DataUtils, HalfFloatType } from 'three';
import { MAX_ORDER, evaluateBasis, discZonal, projectEquirect, rotateCoefficients } from './sh.js';

const toMatrix3 = (turn) => {
  if (turn.isMatrix3) return turn;
  const matrix = new Matrix4();
  if (turn.isMatrix4) matrix.extractRotation(turn);
  else if (turn.isEuler) matrix.makeRotationFromEuler(turn);
  else matrix.makeRotationFromQuaternion(turn);
  return new Matrix3().setFromMatrix4(matrix);
};

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
   * floats or bytes, RGB or RGBA, the first row at the bottom where `flipY` is set. three.js looks up direction s at
   * u = atan2(s.z, s.x) / 2π + 0.5, which is the layout of docs/conventions.md.
   */
  static fromEquirect(texture, order = 5) {
    const { data, width, height } = texture.image ?? {};
    if (!data) throw new Error('LightVector.fromEquirect needs a texture with pixels, as HDRLoader makes it');
    const channels = data.length / (width * height);
    const value = texture.type === HalfFloatType
      ? (at) => DataUtils.fromHalfFloat(data[at])
      : data instanceof Float32Array ? (at) => data[at] : (at) => data[at] / 255;
    // Row 0 of the data has v = 0, which is the bottom of the picture, unless the upload turns it over.
    const fromTop = (row) => (texture.flipY ? row : height - 1 - row);
    const rgb = projectEquirect(order, width, height, (x, y) => {
      const at = (fromTop(y) * width + x) * channels;
      return [value(at), value(at + 1), value(at + 2)];
    });
    return new LightVector(order, rgb);
  }

  clone() {
    return new LightVector(this.order, this.rgb.slice());
  }

  /** Returns the light turned by a Quaternion, Euler or matrix. */
  rotate(turn) {
    const out = new LightVector(this.order);
    rotateCoefficients(this.order, toMatrix3(turn).elements, this.rgb, out.rgb);
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
