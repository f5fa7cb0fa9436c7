// Lamps of the glTF scene, as lambent-demo shines them (docs/light-paths.md): by shadow cubes per pixel on the groups
// within or beside which they stand, and by harmonics, as light from infinity, on others. A lamp that is a column of a
// group has its direct light there from the cube, and what bounces from the column. Emissive materials that shine as
// spheres (sphere_lamps.js) do so, too.
import { Matrix4, Vector3 } from 'three';
import { LightVector, MAX_ORDER } from './light_vector.js';
import { evaluateBasis } from './sh.js';

export const MOST_CUBES = 4;
const RADII = 6, FADE_PART = 1 / 6; // of a group's radius, about which a lamp stands beside it
const LEAST_DISTANCE = 0.01; // keeps light values finite
const luminance = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;
const shines = (rgb) => rgb.every(Number.isFinite) && rgb.some((c) => c !== 0);

/** A point or spot light of three, which may be column `index` of `group`. three itself does not shine by it. */
export class Lamp {
  constructor(light, column) {
    Object.assign(this, { light, column, position: new Vector3(), direction: new Vector3(0, 0, -1) });
    // It is its own and only shape, and its intensity is its power.
    Object.assign(this, { isNode: true, lamp: this, shapes: [this], radius: 0, hole: 0, area: 1 });
    light.layers.disableAll();
  }

  /** Takes where it stands and how it shines; `lamps` are the strengths of columns, by group. */
  follow(lamps) {
    const { light, column } = this;
    this.position.setFromMatrixPosition(light.matrixWorld);
    if (light.isSpotLight) {
      this.direction.setFromMatrixPosition(light.target.matrixWorld).sub(this.position);
      if (this.direction.lengthSq() > 0) this.direction.normalize();
    }
    this.power = column ? lamps[column.group][column.index]
      : light.visible ? light.color.toArray().map((c) => c * light.intensity) : [0, 0, 0];
    this.range = light.distance;
    this.outerCosine = light.isSpotLight ? Math.cos(light.angle) : -1;
    this.coneScale = light.isSpotLight
      ? 1 / Math.max(0.001, Math.cos(light.angle * (1 - light.penumbra)) - this.outerCosine) : 0;
  }

  /** What follow() found, as numbers. */
  get state() {
    const { position, direction, power, range, outerCosine, coneScale } = this;
    return [...position, ...direction, ...power, range, outerCosine, coneScale];
  }

  isColumnOf(group) {
    return this.column?.group === group;
  }

  /** The harmonics of its light at a point, where nothing is in the way. */
  lightAt(point) {
    const out = new LightVector(MAX_ORDER), toLight = this.position.clone().sub(point), distance = toLight.length();
    const from = Math.max(distance, LEAST_DISTANCE);
    let share = 1 / (from * from);
    if (this.range > 0) share *= Math.min(Math.max(1 - (from / this.range) ** 4, 0), 1);
    const { x, y, z } = distance > 0 ? toLight.divideScalar(distance) : toLight.set(0, 0, 1);
    if (this.coneScale > 0) {
      const along = distance > 0 ? -this.direction.dot(toLight) : 1;
      share *= Math.min(Math.max((along - this.outerCosine) * this.coneScale, 0), 1) ** 2;
    }
    const basis = evaluateBasis(MAX_ORDER, x, y, z, new Float64Array(MAX_ORDER * MAX_ORDER));
    for (let l = 0; l < MAX_ORDER; ++l)
      for (let i = l * l; i < (l + 1) ** 2; ++i)
        for (let c = 0; c < 3; ++c) out.rgb[3 * i + c] = share * basis[i] * (distance / from) ** l * this.power[c];
    return out;
  }
}

/** Returns how far a lamp is from the middle of a group, in its radii; 0 within its bounds. */
function radiiFrom({ boundsMin, boundsMax }, place, lamp) {
  const inGroup = lamp.position.clone().applyMatrix4(new Matrix4().copy(place).invert()).toArray();
  if (inGroup.every((x, k) => x > boundsMin[k] && x < boundsMax[k])) return 0;
  const low = new Vector3(...boundsMin), high = new Vector3(...boundsMax);
  const radius = 0.5 * high.distanceTo(low) * place.getMaxScaleOnAxis();
  const radii = low.add(high).multiplyScalar(0.5).applyMatrix4(place).distanceTo(lamp.position) / radius;
  return Number.isFinite(radii) ? Math.max(radii, Number.MIN_VALUE) : Infinity;
}

// Returns the share of each lamp's light that shines per pixel, by its distances in radii. If there are more lamps than
// cubes, the first one without a cube sets the distance.
function sharesOf(distances, radii) {
  const near = distances.filter((d) => d === 0 || d < radii).sort((a, b) => a - b), limit = near[MOST_CUBES] ?? radii;
  let count = 0;
  return distances.map((d) => {
    const share = d === 0 ? 1 : d < limit ? Math.min((limit - d) / (FADE_PART * limit), 1) : 0;
    return share > 0 && count++ < MOST_CUBES ? share : 0;
  });
}

/**
 * Divides the light of lamps among the carriers. `groups` are {json, place, isVolume}; where `open`, light knows no
 * transfer. Returns the shapes of lamps with `cubes`, and for each group the `powers` of these on its pixels, the lamps
 * that reach its light `probes` with the shares of them that shine `beside` it per pixel, and for each column 1 if it is
 * `apart`, so that a cube shines in its place. `state` changes with the light at the probes.
 */
export function divideLamps(lamps, groups, open) {
  const shining = lamps.filter((lamp) => shines(lamp.power)), nodes = shining.filter(({ isNode }) => isNode);
  const radii = nodes.map((lamp) => groups.map(({ json, place }) => radiiFrom(json, place, lamp)));
  const nearest = nodes.map((lamp, k) => Math.min(Infinity,
    ...groups.map(({ isVolume }, g) => (isVolume || lamp.isColumnOf(g) ? Infinity : radii[k][g]))));
  const shares = sharesOf(nearest, open ? 0 : RADII), cubes = nodes.filter((_, k) => shares[k] > 0);
  const apart = open ? [] : shining.filter((lamp) => lamp.column && hasItsSize(groups[lamp.column.group].place));
  const intensity = ({ power, area }) => luminance(power) * area;
  apart.sort((a, b) => intensity(b) - intensity(a));
  for (const { shapes } of apart)
    if (!cubes.includes(shapes[0]) && cubes.length + shapes.length <= MOST_CUBES) cubes.push(...shapes);
  return { open, cubes, ofGroup: groups.map((group, g) => lightOf(group, g)) };

  function lightOf({ json, place, isVolume }, g) {
    const powers = new Float32Array(3 * MOST_CUBES), columns = json.lights.map(() => 0), probes = [];
    const put = (shape, share) => powers.set(shape.lamp.power.map((c) => share * c), 3 * cubes.indexOf(shape));
    for (const lamp of apart) {
      if (!lamp.isColumnOf(g) || !cubes.includes(lamp.shapes[0])) continue;
      for (const shape of lamp.shapes) put(shape, 1);
      columns[lamp.column.index] = 1;
    }
    nodes.forEach((lamp, k) => {
      if (lamp.isColumnOf(g)) return;
      const within = !isVolume && radii[k][g] === 0, straight = isVolume || open && !within ? 0 : shares[k];
      if (straight > 0) put(lamp, straight);
      if (within && straight > 0) return; // what bounces of it is left out
      probes.push({ lamp, beside: straight });
    });
    const state = probes.flatMap(({ lamp, beside }) => [beside, ...lamp.state]);
    if (probes.length > 0) state.push(...place.elements);
    return { powers, probes, apart: columns, state };
  }
}

/**
 * Tells whether a body's shadow in the light of lamps would reach a receiver twice, by the grid around the body and by a
 * cube, or not at all; `divided` is of divideLamps. Then the receiver takes the body's light by captures. Where all is
 * open, no grid shows, and samples take the mean of the light at probes, which the few beside a body must not darken.
 */
export function shadowsDiffer({ open, cubes, ofGroup }, body, receiver) {
  if (open) return false;
  // The share of a lamp that a group has by harmonics, or null if that is in its column.
  const byHarmonics = (lamp, g) => {
    const one = ofGroup[g].probes.find((probe) => probe.lamp === lamp);
    return one ? 1 - one.beside : lamp.isColumnOf(g) ? null : 0;
  };
  return cubes.some(({ lamp }) => {
    const sent = byHarmonics(lamp, body), had = byHarmonics(lamp, receiver);
    if (had !== null) return sent !== null && sent !== had;
    // The body takes a lamp that is a material as light of another body, so its grid always has it.
    return ofGroup[receiver].apart[lamp.column.index] > 0 && (!lamp.isNode || sent > 0);
  });
}

/**
 * Returns the light of lamps at a light probe: the `rest`, of which transfer brings all, and what shines `beside` the
 * group per pixel, of which it brings the bounces; null if there is none. `hidden` tells which of both does not arrive.
 */
export function lampsAt(lamps, point, hidden = () => ({})) {
  const sums = { rest: null, beside: null };
  for (const { lamp, beside } of lamps) {
    const dark = hidden(lamp, beside), light = lamp.lightAt(point);
    for (const [name, share] of [['rest', 1 - beside], ['beside', beside]])
      if (share > 0 && !dark[name])
        sums[name] = (sums[name] ?? new LightVector(MAX_ORDER)).add(light.multiplyScalar(share));
  }
  return sums;
}

// Tells whether a group has the size that it was baked with; columns know of no other.
function hasItsSize(place) {
  const axes = [new Vector3(), new Vector3(), new Vector3()];
  place.extractBasis(...axes);
  return axes.every((a, i) => axes.every((b, j) => Math.abs(a.dot(b) - (i === j ? 1 : 0)) < 1e-3));
}
