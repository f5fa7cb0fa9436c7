// What a light probe sees: triangles around it in a small cube map, projected to spherical harmonics. Triangles are
// rasterized on the CPU, since a view must come back there anyway, and once: light that changes is multiplied with the
// weights of the triangles.
import { CUBE_FACES, MAX_ORDER, evaluateBasis } from './sh.js';

const SIZE = 16; // texels along an edge of a face
const SUBSAMPLES = 8; // along an edge of a texel
const PIXELS = SIZE * SUBSAMPLES;
export const TEXELS = 6 * SIZE * SIZE;
const DARK_SIDE = -1, DARK_DEPTH = 1 - 1e-4; // dark sides lose against others in the same place
const COUNT = MAX_ORDER * MAX_ORDER;

// The axes of a direction, with signs, that are s, t and w in each of CUBE_FACES.
const FACE_AXES = [
  { axes: [2, 1, 0], signs: [-1, -1, 1] },
  { axes: [2, 1, 0], signs: [1, -1, -1] },
  { axes: [0, 2, 1], signs: [1, 1, 1] },
  { axes: [0, 2, 1], signs: [1, -1, -1] },
  { axes: [0, 1, 2], signs: [1, -1, 1] },
  { axes: [0, 1, 2], signs: [-1, -1, -1] },
];

const cornerAngle = (u, v) => Math.atan2(u * v, Math.sqrt(u * u + v * v + 1));

// Makes the means of harmonics over texels, and the weights Ω (2 y(centre) - mean y) that project texels, in which the
// leading errors of both cancel (runtime/sh/projection.hpp). Uniform light gives exactly uniform light.
function makeTables() {
  const means = new Float64Array(TEXELS * COUNT), weights = new Float64Array(TEXELS * COUNT);
  const solidAngles = new Float64Array(TEXELS), y = new Float64Array(COUNT), edge = 2 / SIZE, fine = 4;
  const evaluate = (face, s, t) => {
    const d = CUBE_FACES[face](s, t), length = Math.hypot(...d);
    evaluateBasis(MAX_ORDER, d[0] / length, d[1] / length, d[2] / length, y);
    return length ** -3;
  };
  for (let k = 0; k < TEXELS; ++k) {
    const face = Math.floor(k / (SIZE * SIZE)), s = (k % SIZE) * edge - 1, t = (Math.floor(k / SIZE) % SIZE) * edge - 1;
    const at = k * COUNT;
    let sum = 0;
    for (let i = 0; i < fine * fine; ++i) {
      const across = (i % fine) + 0.5, down = Math.floor(i / fine) + 0.5;
      const share = evaluate(face, s + (across / fine) * edge, t + (down / fine) * edge);
      sum += share;
      for (let c = 0; c < COUNT; ++c) means[at + c] += share * y[c];
    }
    solidAngles[k] = cornerAngle(s + edge, t + edge) - cornerAngle(s, t + edge) -
      cornerAngle(s + edge, t) + cornerAngle(s, t);
    evaluate(face, s + edge / 2, t + edge / 2);
    for (let c = 0; c < COUNT; ++c) {
      means[at + c] /= sum;
      weights[at + c] = solidAngles[k] * (2 * y[c] - means[at + c]);
    }
  }
  for (let c = 1; c < COUNT; ++c) {
    let sum = 0;
    for (let k = 0; k < TEXELS; ++k) sum += weights[k * COUNT + c];
    for (let k = 0; k < TEXELS; ++k) weights[k * COUNT + c] -= (sum * solidAngles[k]) / (4 * Math.PI);
  }
  return { means, weights, solidAngles };
}

let tables = null;
const shared = () => (tables ??= makeTables());

const depths = new Float64Array(PIXELS * PIXELS), owners = new Int32Array(PIXELS * PIXELS);
const local = new Float64Array(9), edges = new Float64Array(9);

// Draws a triangle whose corners in `local` are (s w, t w, w), by homogeneous edge functions (Olano and Greer 1997),
// which need no clipping. Returns whether it may have covered a pixel.
function rasterize(owner, frontOnly) {
  const ax = local[0], ay = local[1], aw = local[2], bx = local[3], by = local[4], bw = local[5];
  const cx = local[6], cy = local[7], cw = local[8];
  if (aw <= 0 && bw <= 0 && cw <= 0) return false;
  if (ax > aw && bx > bw && cx > cw || -ax > aw && -bx > bw && -cx > cw) return false;
  if (ay > aw && by > bw && cy > cw || -ay > aw && -by > bw && -cy > cw) return false;
  edges[0] = by * cw - bw * cy, edges[1] = bw * cx - bx * cw, edges[2] = bx * cy - by * cx;
  edges[3] = cy * aw - cw * ay, edges[4] = cw * ax - cx * aw, edges[5] = cx * ay - cy * ax;
  edges[6] = ay * bw - aw * by, edges[7] = aw * bx - ax * bw, edges[8] = ax * by - ay * bx;
  const volume = ax * edges[0] + ay * edges[1] + aw * edges[2]; // the faces' coordinates mirror the world
  if (volume === 0 || (volume < 0 && frontOnly)) return false;
  const sign = Math.sign(volume), scale = (volume < 0 ? DARK_DEPTH : 1) / volume, name = volume < 0 ? DARK_SIDE : owner;
  const qx = scale * (edges[0] + edges[3] + edges[6]), qy = scale * (edges[1] + edges[4] + edges[7]);
  const qw = scale * (edges[2] + edges[5] + edges[8]), step = 2 / PIXELS;
  let low = -1, high = 1;
  if (aw > 0 && bw > 0 && cw > 0) {
    low = Math.max(low, Math.min(ay / aw, by / bw, cy / cw));
    high = Math.min(high, Math.max(ay / aw, by / bw, cy / cw));
  }
  const place = (t) => (t + 1) / step - 0.5, last = Math.min(PIXELS - 1, Math.floor(place(high)));
  for (let row = Math.max(0, Math.ceil(place(low))); row <= last; ++row) {
    const t = (row + 0.5) * step - 1;
    let from = -1, to = 1;
    for (let e = 0; e < 9; e += 3) {
      const slope = sign * edges[e], rest = sign * (edges[e + 1] * t + edges[e + 2]);
      if (slope > 0) from = Math.max(from, -rest / slope);
      else if (slope < 0) to = Math.min(to, -rest / slope);
      else if (rest < 0) to = -2;
    }
    const end = Math.min(PIXELS - 1, Math.floor(place(to)));
    for (let x = Math.max(0, Math.ceil(place(from))); x <= end; ++x) {
      const nearness = qx * ((x + 0.5) * step - 1) + qy * t + qw, at = row * PIXELS + x;
      if (nearness <= depths[at]) continue;
      depths[at] = nearness;
      owners[at] = name;
    }
  }
  return true;
}

/**
 * Looks around among triangles, whose corners are relative to the probe, nine numbers each, in world axes. Returns of
 * each triangle that is seen its index and `count` weights, by which its radiance comes into the harmonics, and of each
 * texel the share of it that is `hidden`.
 */
export function lookAround(corners, frontOnly, count) {
  const { weights } = shared(), triangles = frontOnly.length, sums = new Float64Array(triangles * count);
  const seen = new Uint8Array(triangles), hidden = new Float32Array(TEXELS), part = 1 / SUBSAMPLES ** 2;
  const add = (owner, run, texel) => {
    if (owner <= 0 || run === 0) return;
    seen[owner - 1] = 1;
    for (let i = 0, from = texel * COUNT, to = (owner - 1) * count; i < count; ++i)
      sums[to + i] += run * part * weights[from + i];
  };
  for (let face = 0; face < 6; ++face) {
    depths.fill(0);
    owners.fill(0);
    let drawn = false;
    const { axes, signs } = FACE_AXES[face];
    for (let t = 0; t < triangles; ++t) {
      for (let k = 0; k < 9; k += 3)
        for (let i = 0; i < 3; ++i) local[k + i] = signs[i] * corners[9 * t + k + axes[i]];
      drawn = rasterize(t + 1, frontOnly[t]) || drawn;
    }
    if (!drawn) continue;
    for (let texel = 0; texel < SIZE * SIZE; ++texel) {
      const first = Math.floor(texel / SIZE) * SUBSAMPLES * PIXELS + (texel % SIZE) * SUBSAMPLES;
      const k = face * SIZE * SIZE + texel;
      let owner = 0, run = 0, covered = 0;
      for (let y = 0; y < SUBSAMPLES; ++y)
        for (let x = 0; x < SUBSAMPLES; ++x) { // neighbours mostly see the same triangle
          const here = owners[first + y * PIXELS + x];
          if (here !== 0) ++covered;
          if (here !== owner) {
            add(owner, run, k);
            owner = here;
            run = 0;
          }
          ++run;
        }
      add(owner, run, k);
      hidden[k] = covered * part;
    }
  }
  const indices = [];
  seen.forEach((is, t) => is && indices.push(t));
  const rows = new Float64Array(indices.length * count);
  indices.forEach((t, i) => rows.set(sums.subarray(t * count, (t + 1) * count), i * count));
  return { indices, rows, hidden };
}

/** Returns the mean radiance of a light vector in each texel, RGB. */
export function texelsOf({ rgb }) {
  const { means } = shared(), out = new Float64Array(3 * TEXELS);
  for (let k = 0; k < TEXELS; ++k)
    for (let i = 0; i < rgb.length / 3; ++i) {
      const y = means[k * COUNT + i];
      for (let c = 0; c < 3; ++c) out[3 * k + c] += y * rgb[3 * i + c];
    }
  return out;
}

/** Projects texels, each times a share of it if there are `shares`, to `count` coefficients. */
export function projectTexels(texels, count, shares = null) {
  const { weights } = shared(), out = new Float64Array(3 * count);
  for (let k = 0; k < TEXELS; ++k) {
    const share = shares ? shares[k] : 1;
    if (share === 0) continue;
    const r = share * texels[3 * k], g = share * texels[3 * k + 1], b = share * texels[3 * k + 2];
    for (let i = 0, at = k * COUNT; i < count; ++i) {
      const w = weights[at + i];
      out[3 * i] += w * r;
      out[3 * i + 1] += w * g;
      out[3 * i + 2] += w * b;
    }
  }
  return out;
}

/**
 * Returns the share of the texels at the peak of a light that is hidden. The bands of a small sun reach far around it, so
 * texels count by a high power of their radiance, `texels`.
 */
export function hiddenPeak(texels, hidden) {
  const { solidAngles } = shared(), bright = (k) => Math.max(0, texels[3 * k] + texels[3 * k + 1] + texels[3 * k + 2]);
  let most = 0, all = 0, lost = 0;
  for (let k = 0; k < TEXELS; ++k) most = Math.max(most, bright(k));
  for (let k = 0; k < TEXELS && most > 0; ++k) {
    const weight = solidAngles[k] * (bright(k) / most) ** 16;
    all += weight;
    lost += hidden[k] * weight;
  }
  return all > 0 ? lost / all : 0;
}
