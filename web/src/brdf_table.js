// Tables of b(v), what a BRDF reflects of each harmonic of the light (Kautz, Sloan and Snyder 2002), and their textures
// by weights of zonal functions, packed as in runtime/streaming/brdf_texture.cpp.
import { ClampToEdgeWrapping, DataArrayTexture, DataUtils, HalfFloatType, LinearFilter, RGBAFormat } from 'three';
import { Front } from './bytes.js';
import { ZonalFactors } from './zonal_factors.js';

/** Decodes a table; `values` are [strength][roughness][azimuth][angle][lobe][coefficient]. */
export function decodeBrdfTable(bytes, subject = 'a BRDF table') {
  const front = new Front(bytes, subject);
  const [order, lobes, angles, azimuths, roughnesses, strengths] = front.values(Uint32Array, 6);
  if (!(order >= 1 && order <= 6) || (lobes !== 2 && lobes !== 3) || angles < 2)
    throw new Error(`${subject} is damaged: its counts are wrong`);
  const isotropic = azimuths === 1, count = isotropic ? (order * (order + 1)) / 2 : order * order;
  const nodes = strengths * roughnesses * azimuths * angles * lobes;
  const scales = front.values(Float32Array, nodes), codes = front.split(nodes * count);
  front.finish();
  const values = new Float32Array(nodes * count), signed = new Int16Array(codes.buffer);
  for (let n = 0; n < nodes; ++n)
    for (let k = 0; k < count; ++k) values[n * count + k] = scales[n] * signed[n * count + k];
  return { order, lobes, angles, azimuths, roughnesses, strengths, isotropic, count, values };
}

/** A table as shaders look it up. */
export class BrdfTexture {
  constructor(table) {
    const { order, lobes, angles, azimuths, roughnesses, strengths, isotropic, count, values } = table;
    Object.assign(this, { order, lobes, isotropic, roughnesses, strengths });
    const factors = new ZonalFactors(order, isotropic), stride = lobes === 2 ? 2 : 4;
    this.axes = factors.axes;
    this.perNode = Math.ceil((stride * count) / 4);
    const height = isotropic ? roughnesses : azimuths;
    const layers = this.perNode * (isotropic ? 1 : strengths * roughnesses);
    const data = new Uint16Array(4 * angles * height * layers);
    let node = 0;
    for (let strength = 0; strength < strengths; ++strength)
      for (let roughness = 0; roughness < roughnesses; ++roughness)
        for (let azimuth = 0; azimuth < azimuths; ++azimuth)
          for (let angle = 0; angle < angles; ++angle)
            for (let lobe = 0; lobe < lobes; ++lobe, node += count) {
              const down = isotropic ? roughness : azimuth;
              const layer = isotropic ? 0 : (strength * roughnesses + roughness) * this.perNode;
              factors.factor(values.subarray(node, node + count)).forEach((weight, p) => {
                const component = stride * p + lobe;
                const texel = ((layer + (component >> 2)) * height + down) * angles + angle;
                data[4 * texel + (component & 3)] = DataUtils.toHalfFloat(weight);
              });
            }
    this.texture = new DataArrayTexture(data, angles, height, layers);
    Object.assign(this.texture, {
      format: RGBAFormat, type: HalfFloatType, magFilter: LinearFilter, minFilter: LinearFilter,
      wrapS: ClampToEdgeWrapping, wrapT: ClampToEdgeWrapping, needsUpdate: true,
    });
  }

  dispose() {
    this.texture.dispose();
  }
}

/** Returns the table that a glTF material looks up, or null; `families` are those of the bundle's tables. */
export function tableFor(material, families, layered = false) {
  const measured = material?.extras?.lambent?.brdf;
  if (measured !== undefined) return !layered && families[measured] === 'measured' ? measured : null;
  const anisotropic = !layered && (material?.extensions?.KHR_materials_anisotropy?.anisotropyStrength ?? 0) !== 0;
  const wanted = anisotropic ? ['anisotropicGgx', 'ggx'] : ['ggx', 'anisotropicGgx'];
  const found = wanted.map((family) => families.indexOf(family)).find((index) => index >= 0);
  return found ?? null;
}
