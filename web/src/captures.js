// Light between groups (docs/design/captures.md): each light probe of a group sees the capture proxies of others,
// which hide the sky and send out light, unless a group's grid brings that. What is seen is found anew when something
// moved, for a few probes at a time; light then goes to and fro until it is at rest.
import { Matrix4, Vector3 } from 'three';
import { boxesMeet } from './boxes.js';
import { TEXELS, hiddenPeak, lookAround, projectTexels, texelsOf } from './capture_cube.js';
import { hidesLamp } from './lamp_shadows.js';
import { LightVector, Rotation } from './light_vector.js';
import { lampsAt, shadowsDiffer } from './local_lights.js';
import { ProxyLight } from './proxy_light.js';

const TEXEL_ANGLE = Math.PI / 32, LEAST_SHARE = 0.25, LEVEL_ERROR = 0.5; // of a texel
const MOST_STEPS = 16, LEAST_CHANGE = 1e-3;
const MOST_VIEWS = 8; // found anew in an update
const LAMP_LEVEL = 1; // of bodies that hide lamps and are not seen
const MOST_BRIGHTNESS = 1e6; // a body as much brighter than the sky is seen however small it is

function boundsOf({ positions, triangles }) {
  const low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate(), point = new Vector3();
  const corners = triangles.flatMap((triangle) => triangle.corners);
  for (const corner of corners) {
    low.min(point.fromArray(positions, 3 * corner));
    high.max(point);
  }
  const centre = low.add(high).multiplyScalar(0.5);
  const distances = corners.map((corner) => point.fromArray(positions, 3 * corner).distanceTo(centre));
  return { centre, radius: Math.max(...distances) };
}

const hasSurfaces = ({ json }) => !json.volume && json.cells.some((cell) => cell.kind === 'surface');

// Tells whether the grid of a group has the light of its lamps too, if there are any.
const carriesLamps = ({ json }) => json.lights.length === 0 || json.cells.every((cell) =>
  cell.kind !== 'neighborhood' || cell.transfers.some((transfer) => transfer.order === 0));

const both = (a, b) => (a && b ? a.add(b) : a ?? b ?? null);
const same = (a, b) => a && a.length === b.length && a.every((value, i) => value === b[i]);

function differs(now, before) {
  let change = 0, power = 0;
  for (const [name, whole] of [['light', 0], ['key', 1]])
    (now[name]?.rgb ?? []).forEach((value, i) => {
      const old = before[name]?.rgb[i] ?? 0, all = (before.light.rgb[i] ?? 0) + (before.key?.rgb[i] ?? 0);
      change += (value - old) ** 2;
      if (whole === 0) power += all * all;
    });
  return change > LEAST_CHANGE ** 2 * power;
}

export class Captures {
  /** `proxies` has the capture proxy of each group, or null. */
  constructor(groups, proxies) {
    this.groups = groups;
    this.bodies = proxies.map((proxy, g) => proxy && {
      proxy, light: new ProxyLight(proxy, groups[g]), ...boundsOf(proxy), turn: null,
    });
    this.order = Math.max(...groups.flatMap(({ json }) => json.cells.flatMap(
      (cell) => cell.transfers.map((transfer) => transfer.order))));
    this.probes = groups.map(({ json }) => json.lightSamples.map((place) => ({
      place: new Vector3(...place), world: new Vector3(),
      around: null, view: null, seen: [], asked: 0, sky: null, lamps: null,
    })));
    this.incident = groups.map(() => null);
    this.byGrids = groups.map(() => new Set()); // the bodies of which grids bring the light to a group
    this.seen = new Set(); // the groups that probes of others see
    this.updates = 0;
  }

  /** Makes the next update read transfer again. */
  forgetTransfer() {
    for (const body of this.bodies) body?.light.forgetTransfer();
  }

  // Finds of each group the other bodies of which grids bring the light. Its probes do not see them, nor what the transfer
  // of a volume knows already.
  findLeftOut(places, divided) {
    const box = ({ json: { boundsMin, boundsMax } }) => [boundsMin, boundsMax];
    this.byGrids = this.groups.map((receiver, b) => new Set(this.groups.map((_, g) => g).filter((g) => {
      const body = this.groups[g];
      if (g === b || !body.grid || !hasSurfaces(receiver) || !carriesLamps(body)) return false;
      const { boundsMin, boundsMax } = body.json.neighborhood;
      return boxesMeet(boundsMin, boundsMax, places[g], ...box(receiver), places[b])
        && (body.json.volume || !shadowsDiffer(divided, g, b));
    })));
    this.leftOut = this.groups.map(({ json: { within } }, b) =>
      new Set([...this.byGrids[b], ...(within === undefined ? [] : [within])]));
  }

  // Returns the groups that a point sees, each with the coarsest level of detail that is fine enough.
  seenFrom(point, spheres, own, leftOut) {
    const seen = [];
    spheres.forEach((sphere, g) => {
      if (!sphere || g === own || leftOut.has(g)) return;
      const { centre, radius, scale, brightness } = sphere, distance = centre.distanceTo(point);
      const sine = radius / distance, share = sine >= 1 ? 1 : 0.5 * (1 - Math.sqrt(1 - sine * sine));
      if (!(radius > 0) || share * TEXELS * brightness < LEAST_SHARE) return;
      let level = 0;
      this.bodies[g].proxy.levels.forEach(({ error }, i) => {
        if (error * scale <= LEVEL_ERROR * TEXEL_ANGLE * (distance - radius)) level = i;
      });
      seen.push([g, level]);
    });
    return seen;
  }

  // Finds which views are out of date, and renews some: first those that never were, then those that wait longest.
  look(places, sky, lamps, leftOut) {
    const all = Math.max(...[0, 1, 2].map((c) => 0.28209479 * sky.rgb[c]), 0);
    const spheres = this.bodies.map((body, g) => {
      if (!body) return null;
      const emitted = ({ lamp, emission }) => (
        lamp < 0 ? 0 : Math.max(...emission.map((value, c) => value * lamps[g][lamp][c])));
      const scale = places[g].getMaxScaleOnAxis(), peak = Math.max(0, ...body.proxy.triangles.map(emitted));
      const brightness = Math.min(Math.max(all > 0 ? peak / all : MOST_BRIGHTNESS * peak, 1), MOST_BRIGHTNESS);
      return { centre: body.centre.clone().applyMatrix4(places[g]), radius: scale * body.radius, scale, brightness };
    });
    const waiting = [];
    this.probes.forEach((probes, g) => probes.forEach((probe) => {
      probe.world.copy(probe.place).applyMatrix4(places[g]);
      const seen = this.seenFrom(probe.world, spheres, g, leftOut[g]);
      const around = seen.length === 0 ? []
        : [...probe.world.toArray(), ...seen.flatMap(([body, level]) => [body, level, ...places[body].elements])];
      if (!same(probe.around, around)) waiting.push({ probe, seen, around });
    }));
    const urgent = ({ probe, seen }) => probe.around === null || seen.length === 0;
    const later = waiting.filter((one) => !urgent(one)).sort((a, b) => a.probe.asked - b.probe.asked);
    const renewed = [...waiting.filter(urgent), ...later.slice(0, MOST_VIEWS)];
    for (const { probe, seen, around } of renewed) {
      const view = seen.length > 0 ? this.viewOf(probe.world, seen, places) : null;
      Object.assign(probe, { around, view, seen, asked: this.updates, sky: null });
    }
    return renewed.length > 0;
  }

  viewOf(point, seen, places) {
    const corners = [], frontOnly = [], owners = [], at = new Vector3(), fromPoint = new Matrix4();
    for (const [g, level] of seen) {
      const { positions, levels, triangles } = this.bodies[g].proxy, { first, count } = levels[level];
      fromPoint.makeTranslation(-point.x, -point.y, -point.z).multiply(places[g]);
      for (let t = first; t < first + count; ++t) {
        for (const corner of triangles[t].corners)
          corners.push(...at.fromArray(positions, 3 * corner).applyMatrix4(fromPoint));
        frontOnly.push(triangles[t].frontOnly);
        owners.push([g, t]);
      }
    }
    const view = lookAround(corners, frontOnly, this.order * this.order);
    return { ...view, owners: view.indices.map((i) => owners[i]) };
  }

  /**
   * Brings light to rest. `light` and `key` come from infinity (`key` may be null), `divided` is of divideLamps (another
   * object whenever it differs) and `lamps` are the strengths of columns; `turns` are rotations from the world, and
   * `changed` says whether any light or transfer is new. Returns the groups at whose probes the light changed.
   */
  update({ places, turns, light, key, divided, lamps, mode, changed }) {
    ++this.updates;
    const moved = !places.every((place, g) => this.places?.[g].equals(place)), risen = new Set();
    if (moved || divided !== this.divided) this.findLeftOut(places, divided);
    this.divided = divided;
    const looked = this.look(places, light, lamps, this.leftOut);
    if (moved || changed) this.shineLamps(places, divided.ofGroup);
    this.places = places;
    if (!moved && !looked && !changed) return risen;
    if (changed) this.sky = this.skyOf(light, key);
    if (looked) this.seen = new Set(this.probes.flat().flatMap(({ view }) => view?.owners.map(([g]) => g) ?? []));
    const stale = new Set([...this.seen].filter((g) => changed || !this.bodies[g].turn?.equals(turns[g])));
    for (let step = 0; step < MOST_STEPS; ++step) {
      this.groups.forEach((_, g) => {
        const now = this.gather(g, light, key), old = this.incident[g];
        if (old && old.length === now.length && !now.some((one, p) => differs(one, old[p]))) return;
        this.incident[g] = now;
        risen.add(g);
        stale.add(g);
      });
      const shining = [...stale].filter((g) => this.seen.has(g));
      stale.clear();
      for (const g of shining) {
        const rotation = new Rotation(turns[g]), all = this.incident[g].map((one) => both(one.light, one.key));
        this.bodies[g].light.shade(all.map((one) => one.rotate(rotation)), lamps[g], mode);
        this.bodies[g].turn = turns[g].clone();
      }
      if (shining.length === 0) break;
    }
    return risen;
  }

  skyOf(light, key) {
    const texels = texelsOf(light);
    return { texels, through: projectTexels(texels, this.order ** 2), keyTexels: key && texelsOf(key) };
  }

  // Finds the light of lamps at all probes. Bodies that are seen hide all of it, and those that are left out hide what
  // shines beside a group per pixel, where they stand in the lamp's cube.
  shineLamps(places, ofGroup) {
    ofGroup.forEach(({ probes: lamps }, g) => this.probes[g].forEach((probe) => {
      const hides = (g, level, lamp) => {
        const body = this.bodies[g], most = (body?.proxy.levels.length ?? 0) - 1;
        return body && hidesLamp(body, Math.min(level, most), places[g], probe.world, lamp.position);
      };
      const hidden = (lamp, beside) => {
        const rest = probe.seen.some(([body, level]) => hides(body, level, lamp));
        const inCube = () => beside > 0 && [...this.leftOut[g]].some((body) => hides(body, LAMP_LEVEL, lamp));
        return { rest, beside: rest || inCube() };
      };
      probe.lamps = lamps.length > 0 ? lampsAt(lamps, probe.world, hidden) : null;
    }));
  }

  // Returns the light at the probes of a group: one for all where none sees a body or a lamp.
  gather(g, light, key) {
    if (this.probes[g].every(({ view, lamps }) => view === null && lamps === null)) return [{ light, key }];
    return this.probes[g].map((probe) => {
      const { rest, beside } = probe.lamps ?? {};
      if (!probe.view) return { light: both(light, rest), key: both(key, beside) };
      if (probe.sky?.of !== this.sky) probe.sky = { of: this.sky, ...this.skyAt(probe.view, light, key) };
      const captured = new LightVector(this.order, probe.sky.rgb.slice());
      this.addBodies(probe.view, captured.rgb);
      return { light: both(captured, rest), key: both(key?.multiplyScalar(probe.sky.keyShare), beside) };
    });
  }

  // Returns what a view leaves of the sky, in which the error of the texels is taken out as far as the sky is seen, and
  // what it leaves of suns.
  skyAt({ hidden }, light, key) {
    const { texels, through, keyTexels } = this.sky, rgb = projectTexels(texels, this.order ** 2, hidden);
    const visible = [0, 1, 2].map((c) => (through[c] > 0 ? Math.min(Math.max(1 - rgb[c] / through[c], 0), 1) : 1));
    rgb.forEach((lost, i) => (rgb[i] = through[i] - lost + visible[i % 3] * ((light.rgb[i] ?? 0) - through[i])));
    return { rgb, keyShare: key ? 1 - hiddenPeak(keyTexels, hidden) : 0 };
  }

  addBodies({ owners, rows }, rgb) {
    const count = this.order ** 2;
    owners.forEach(([g, t], row) => {
      const { radiance } = this.bodies[g].light, [red, green, blue] = radiance.subarray(3 * t, 3 * t + 3);
      for (let i = 0; i < count; ++i) {
        const weight = rows[row * count + i];
        rgb[3 * i] += weight * red;
        rgb[3 * i + 1] += weight * green;
        rgb[3 * i + 2] += weight * blue;
      }
    });
  }
}
