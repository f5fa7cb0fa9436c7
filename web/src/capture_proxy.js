// Decodes capture proxies: how a group looks to others, in a few triangles that send out light (docs/format.md,
// "captureProxy"). It is the twin of runtime/bundle/capture_proxy.cpp, without the surface for the group's own parts.
import { Front } from './bytes.js';

const FRONT_ONLY = 0x80, MOST_ENTRIES = 8;

/** Returns levels of detail, the finest first, of triangles, and the entries of samples whose light these reflect. */
export function decodeCaptureProxy(bytes, samples, lamps, subject = 'a capture proxy') {
  const front = new Front(bytes, subject), [levels, positions, triangles, entries] = front.values(Uint32Array, 4);
  const check = (holds, what) => {
    if (!holds) throw new Error(`${subject} is damaged: ${what}`);
  };
  const counts = front.values(Uint32Array, levels), errors = front.values(Float32Array, levels);
  const places = front.values(Float32Array, 3 * positions), emissions = front.values(Float32Array, 3 * triangles);
  const corners = front.split(3 * triangles), lights = front.split(triangles);
  const reflectances = front.split(3 * entries), flags = front.take(triangles), steps = front.integers(entries);
  check([errors, places, emissions].every((list) => list.every(Number.isFinite)), 'a value is not finite');
  check(corners.every((corner) => corner < positions), 'a corner does not exist');
  check(lights.every((light) => light <= lamps), 'a lamp does not exist');
  const sampleOf = new Uint32Array(entries);
  steps.forEach((step, e) => (sampleOf[e] = (e > 0 ? sampleOf[e - 1] : 0) + step));
  check(sampleOf.every((sample) => sample < samples), 'a sample does not exist');

  const rgb = (list, count, i, scale) => [0, 1, 2].map((c) => list[c * count + i] * scale);
  let firstEntry = 0, firstTriangle = 0;
  const all = Array.from({ length: triangles }, (_, t) => {
    const count = flags[t] & ~FRONT_ONLY, first = firstEntry;
    check(count <= MOST_ENTRIES && (firstEntry += count) <= entries, 'a triangle has too many entries');
    return {
      corners: [0, 1, 2].map((k) => corners[k * triangles + t]), frontOnly: (flags[t] & FRONT_ONLY) !== 0,
      emission: rgb(emissions, triangles, t, 1), lamp: lights[t] - 1,
      entries: Array.from({ length: count }, (_, e) => (
        { sample: sampleOf[first + e], reflectance: rgb(reflectances, entries, first + e, 1 / 65535) })),
    };
  });
  check(firstEntry === entries, 'entries are left over');
  const list = Array.from(counts, (count, i) => {
    firstTriangle += count;
    return { first: firstTriangle - count, count, error: errors[i] };
  });
  check(levels > 0 && firstTriangle === triangles, 'levels do not hold all triangles');
  const points = new Float64Array(3 * positions);
  for (let i = 0; i < positions; ++i) for (let k = 0; k < 3; ++k) points[3 * i + k] = places[k * positions + i];
  return { levels: list, positions: points, triangles: all };
}

/** Decodes the light probes of each sample of a cell: `lights` and `weights` (of 255), four of each a sample. */
export function decodeLightWeights(bytes, samples, probes, subject = 'light weights') {
  const front = new Front(bytes, subject), runs = Array.from({ length: 8 }, () => front.take(samples));
  front.finish();
  const lights = new Uint8Array(4 * samples), weights = new Uint8Array(4 * samples);
  for (let s = 0; s < samples; ++s)
    for (let k = 0; k < 4; ++k) {
      lights[4 * s + k] = runs[k][s];
      weights[4 * s + k] = runs[4 + k][s];
    }
  if (lights.some((light) => light >= probes)) throw new Error(`${subject} are damaged: a light probe does not exist`);
  return { lights, weights };
}
