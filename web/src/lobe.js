// The lobe with which a rough surface blurs its reflection of the sky, as lambent-demo takes it
// (runtime/lighting/sky.cpp): K(theta) ~ D_GGX(theta / 2) max(cos theta, 0) about the mirrored view, with
// integral 1. It scales the bands of light by ∫ K P_l.
import { DataTexture, FloatType, RGBAFormat } from 'three';

export const LOBE_LEVELS = 17; // of roughness (level / 16)^1.5
const BANDS = 6, STEPS = 2048;

const alphaOf = (roughness) => Math.max(roughness * roughness, 1e-3);

function shape(alpha, cosine) {
  const root = 0.5 * (1 + cosine) * (alpha * alpha - 1) + 1;
  return Math.max(cosine, 0) / (root * root);
}

// Calls `add(share, cosine)` for steps of the lobe, and returns the sum of the shares.
function integrate(roughness, add) {
  const alpha = alphaOf(roughness), thetaAt = (u) => 0.5 * Math.PI * u ** 3; // dense where narrow lobes are
  let all = 0;
  for (let i = 0; i < STEPS; ++i) {
    const ring = Math.cos(thetaAt(i / STEPS)) - Math.cos(thetaAt((i + 1) / STEPS));
    const cosine = Math.cos(thetaAt((i + 0.5) / STEPS)), share = 2 * Math.PI * ring * shape(alpha, cosine);
    all += share;
    add(share, cosine);
  }
  return all;
}

/** Returns K as a function of the cosine from the mirrored direction. */
export function lobeDensity(roughness) {
  const alpha = alphaOf(roughness), all = integrate(roughness, () => {});
  return (cosine) => shape(alpha, cosine) / all;
}

/** Returns the factors of the bands. */
export function lobeBands(roughness) {
  const bands = new Float64Array(BANDS);
  if (roughness === 0) return bands.fill(1);
  const all = integrate(roughness, (share, cosine) => {
    for (let l = 0, p = 1, before = 0; l < BANDS; ++l) {
      bands[l] += share * p;
      [before, p] = [p, ((2 * l + 1) * cosine * p - l * before) / (l + 1)];
    }
  });
  return bands.map((value) => value / all);
}

let texture = null;

/** Returns a texture of the factors: bands 0 to 3 and 4 to 5 in two columns, levels in rows. All scenes share it. */
export function lobeTexture() {
  if (texture) return texture;
  const data = new Float32Array(4 * 2 * LOBE_LEVELS);
  for (let level = 0; level < LOBE_LEVELS; ++level)
    data.set(lobeBands((level / (LOBE_LEVELS - 1)) ** 1.5), 8 * level);
  texture = new DataTexture(data, 2, LOBE_LEVELS, RGBAFormat, FloatType);
  texture.needsUpdate = true;
  return texture;
}
