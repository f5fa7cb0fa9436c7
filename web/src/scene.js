// What a bundle adds to three's scene: groups with transfer, the light that they stand in, and the surfaces that show
// it. Light is set once and turned into the frame of each group. Samples are shaded on the GPU, when light, transfer or a
// group's rotation changed, before the first surface of the group is drawn.
import { Matrix3, Matrix4, Quaternion, Vector3, Vector4 } from 'three';
import { BrdfTexture, tableFor } from './brdf_table.js';
import { Captures } from './captures.js';
import { canWriteLists } from './gpu_textures.js';
import { Group } from './group.js';
import { MOST_CUBES, divideLamps, lampsAt } from './local_lights.js';
import { Surface } from './surface.js';
import { LightVector, Rotation } from './light_vector.js';
import { Passes } from './passes.js';
import { SceneDepth } from './scene_depth.js';
import { ShadowCubes } from './shadow_cubes.js';
import { findSphereLamps } from './sphere_lamps.js';

const MOST_COEFFICIENTS = 64; // of eight bands
const KNOWN_COEFFICIENTS = 36; // of the six bands that mirrors know
const MOST_GRIDS = 8; // that a surface receives from
const TRANSFERS = ['full', 'shadowed', 'unshadowed'];
const listOf = (length, make) => Array.from({ length }, make);

const both = (a, b) => (a && b ? a.add(b) : a ?? b ?? null);
const equal = (a, b) => a === b || (a && b && a.length === b.length && a.every((value, i) => value === b[i]));

// Tells whether two divisions of lamps give the same light.
function sameLamps(a, b) {
  return equal(a.powers, b.powers) && equal(a.apart, b.apart) && equal(a.state, b.state);
}

export class LambentScene {
  /** Loads what surfaces need before their planes come. `root` is the glTF scene in three. */
  static async create(bundle, root) {
    const scene = new LambentScene(bundle, root);
    const looked = new Set(bundle.draws.map((draw) => scene.tableIndex(draw)));
    scene.tables = await Promise.all(bundle.extension.brdfTables.map(async (entry, index) =>
      (looked.has(index) ? new BrdfTexture(await bundle.brdfTable(entry)) : null)));
    await Promise.all(scene.groups.map((group) => group.load(bundle)));
    if (scene.groups.length > 1) {
      const proxies = await Promise.all(bundle.groups.map((json) => bundle.captureProxy(json)));
      if (proxies.some((proxy) => proxy !== null)) scene._captures = new Captures(scene.groups, proxies);
    }
    const wanted = bundle.draws.filter((draw) => scene.groups[draw.group].runs.has(draw.outputs));
    scene.surfaces = await Promise.all(wanted.map(async (draw) =>
      new Surface(draw, scene.groups[draw.group], await bundle.rows(draw), bundle.vertexCount(draw))));
    return scene;
  }

  constructor(bundle, root) {
    this.bundle = bundle;
    this.root = root;
    this.groups = bundle.groups.map((json) => new Group(json));
    this.surfaces = [];
    this.lamps = bundle.groups.map((json) => json.lights.map((lamp) => [...lamp.color]));
    this._light = LightVector.constant(1, 1, 1);
    this._key = null;
    this._suns = null; // of the glTF
    this._transfer = 'full';
    this._order = 8;
    this._changed = true;
    this._turns = this.groups.map(() => null);
    this._unshaded = this.groups.map(() => true);
    this._planesLeft = this.planes().length;
    this._seenChanged = true;
    this._passes = new Passes();
    this._depth = new SceneDepth();
    this._gpu = null; // where the light lies that has been shaded
    this._frame = -1;
    // For each group the other bodies that have grids, the first of them if there are many.
    this._bodiesAround = this.groups.map((_, g) =>
      this.groups.map((_, i) => i).filter((i) => i !== g && this.groups[i].grid).slice(0, MOST_GRIDS));
    this._sphereLamps = findSphereLamps(bundle.groups);
    this._shining = []; // these and the lamps at nodes
    this._divided = null;
    this._cubes = null;
    this._captures = null; // where there are several groups
    this._open = null; // the light of each group where there are no captures
    this._lampUniforms = {
      lambentCubes: { value: null },
      lambentLampPlaces: { value: listOf(MOST_CUBES, () => new Vector4()) },
      lambentLampAims: { value: listOf(MOST_CUBES, () => new Vector4()) },
      lambentLampCones: { value: new Float32Array(MOST_CUBES) },
      lambentLampRadii: { value: new Float32Array(MOST_CUBES) },
    };
    this.uniforms = this.groups.map((_, g) => ({
      ...this._lampUniforms,
      lambentGridKept: { value: this._bodiesAround[g].map(() => 1) },
      lambentLampPowers: { value: new Float32Array(3 * MOST_CUBES) },
      lambentKeyed: { value: false },
      lambentKey: { value: new Float32Array(27) },
      lambentGroupFromWorld: { value: new Matrix3() },
      lambentOpen: { value: false },
      lambentSky: { value: new Float32Array(3 * MOST_COEFFICIENTS) },
      lambentKnown: { value: new Float32Array(3 * KNOWN_COEFFICIENTS) },
    }));
    this.disposed = false;
  }

  /** Light from infinity in the world, without key lights. */
  get light() {
    return this._light;
  }
  set light(light) {
    this._light = light;
    this._changed = true;
  }

  /**
   * Light of suns that shine directly by shadow maps (KeyLights), besides directional lights of the glTF. Transfer brings only what they bounce.
   */
  get keyLight() {
    return this._key;
  }
  set keyLight(light) {
    this._key = light;
    this._changed = true;
  }

  /** 'full' (with bounces), 'shadowed' or 'unshadowed'. */
  get transfer() {
    return this._transfer;
  }
  set transfer(word) {
    if (!TRANSFERS.includes(word)) throw new Error(`transfer is one of ${TRANSFERS.join(', ')}, not ${word}`);
    this._transfer = word;
    this._changed = true;
  }

  /** Bands of the light that count, at most. */
  get order() {
    return this._order;
  }
  set order(order) {
    this._order = order;
    this._changed = true;
  }

  /**
   * Sets the light of a lamp that was baked into a group: colour times strength. The surfaces of a material glow by it.
   */
  setLamp(group, index, { r, g, b }) {
    this.lamps[group][index] = [r, g, b];
    this._changed = true;
    const { kind, material } = this.groups[group].json.lights[index];
    if (kind !== 'material') return;
    for (const { draw, material: shown } of this.surfaces) {
      if (draw.group !== group || this.materialOf(draw) !== material) continue;
      shown.emissive.setRGB(r, g, b);
      shown.emissiveIntensity = 1;
    }
  }

  /** Adds a weight plane that has arrived; planes of a transfer come in order. */
  addPlane({ transfer, index }, codes) {
    transfer.setPlane(index, codes);
    this._changed = true;
    if (--this._planesLeft === 0) this._seenChanged = true;
  }

  /** Returns the planes in the order in which they are wanted. */
  planes() {
    const all = this.groups.flatMap((group) => group.planes(this.bundle));
    const priority = ({ plane }) => this.bundle.extension.payloads[plane.payload].priority;
    return all.sort((a, b) => priority(a) - priority(b));
  }

  async loadPlanes() {
    for (const entry of this.planes()) this.addPlane(entry, await this.bundle.plane(entry.plane));
  }

  // Returns world_from_group as it stands: the motion of the root since rest times the frame at rest.
  worldFromGroup(index) {
    const { json } = this.groups[index], node = this.nodes?.[json.node];
    const rest = new Matrix4().compose(
      new Vector3(...json.restTranslation), new Quaternion(...json.restRotation), new Vector3(1, 1, 1));
    if (!node) return rest.premultiply(this.root.matrixWorld);
    return rest.premultiply(this.restInverses[json.node]).premultiply(node.matrixWorld);
  }

  /** Takes the lamps at nodes, and the meshes that cast shadows in the light of all lamps. */
  setLamps(lamps, meshes) {
    this._shining = [...lamps, ...this._sphereLamps];
    if (this._shining.length > 0) this._cubes = new ShadowCubes(meshes, this._lampUniforms.lambentCubes);
  }

  /** Takes the suns of the glTF (SceneSuns). */
  setSuns(suns) {
    this._suns = suns;
  }

  // Returns the light of all suns, the glTF's and others.
  get _keys() {
    return both(this._key, this._suns?.light);
  }

  /** Tells whether a group has lamps that shine as spheres. */
  hasSpheres(group) {
    return this._sphereLamps.some((lamp) => lamp.isColumnOf(group));
  }

  /** Returns the lamp of spheres that a draw is, or undefined. */
  sphereLampOf(draw) {
    const { lights } = this.groups[draw.group].json, material = this.materialOf(draw);
    return this._sphereLamps.find(({ column: { group, index } }) =>
      group === draw.group && lights[index].material === material);
  }

  // Returns the index of a draw's material, or undefined.
  materialOf({ node, primitive }) {
    const { json } = this.bundle;
    return json.meshes[json.nodes[node].mesh].primitives[primitive].material;
  }

  /**
   * Brings light to the groups in which something changed; world matrices must be up to date. Returns whether there was
   * one. It happens by itself before a surface is drawn.
   */
  update() {
    if (this._seenChanged) this.findSeen();
    if (this._suns?.follow()) this._changed = true;
    const places = this.groups.map((_, index) => this.worldFromGroup(index)), before = this._divided;
    const turns = places.map((place) => new Matrix4().extractRotation(place).invert());
    this.divideLamps(places);
    const same = this._divided.ofGroup.map((divided, index) => before && sameLamps(before.ofGroup[index], divided));
    const risen = this.gatherLight(places, turns, same.includes(false) || before === null);
    let changed = false;
    this.groups.forEach((group, index) => {
      const sameLight = same[index] && !risen.has(index);
      changed = this.updateGroup(group, index, places[index], turns[index], sameLight) || changed;
    });
    this._changed = false;
    return changed;
  }

  // Finds the light at the light probes of all groups, and returns the groups for which it changed.
  gatherLight(places, turns, lampsChanged) {
    const { _light: light, _keys: key, _divided: divided, _divided: { ofGroup } } = this;
    const mode = this._transfer === 'shadowed' ? 'shadowed' : 'full';
    if (this._captures) {
      const risen = this._captures.update({
        places, turns, light, key, divided, lamps: this.lamps, mode, changed: this._changed || lampsChanged,
      });
      this.groups.forEach((_, g) => this.uniforms[g].lambentGridKept.value.forEach((_, i, kept) => {
        kept[i] = Number(this._captures.byGrids[g].has(this._bodiesAround[g][i]));
      }));
      return risen;
    }
    this._open = this.groups.map(({ json }, g) => {
      const { probes } = ofGroup[g], points = json.lightSamples.map((p) => new Vector3(...p).applyMatrix4(places[g]));
      return (probes.length > 0 ? points : [null]).map((point) => {
        const { rest, beside } = lampsAt(probes, point);
        return { light: both(light, rest), key: both(key, beside) };
      });
    });
    return new Set();
  }

  updateGroup(group, index, place, turn, sameLight) {
    const before = this._turns[index];
    group.grid?.place(place);
    const stays = before && turn.elements.every((e, i) => Math.abs(e - before.elements[i]) < 1e-5);
    if (stays && sameLight && !this._changed) return false;
    this._turns[index] = turn;
    this.uniforms[index].lambentGroupFromWorld.value.setFromMatrix4(turn);
    this.setLight(group, index, turn);
    return (this._unshaded[index] = true);
  }

  // Finds which lamps shine by cubes, and hands them to the pixels.
  divideLamps(places) {
    for (const lamp of this._shining) lamp.follow(this.lamps, places);
    const open = this._transfer === 'unshadowed';
    const seen = [Number(open), ...this._shining.flatMap(({ state }) => state)];
    if (this._shining.length > 0) seen.push(...places.flatMap(({ elements }) => elements));
    if (this._divided && equal(seen, this._lampsSeen)) return;
    this._lampsSeen = seen;
    const groups = this.groups.map(
      ({ json, volume }, index) => ({ json, place: places[index], isVolume: volume !== null }));
    const { cubes, ofGroup } = this._divided = divideLamps(this._shining, groups, open);
    const { lambentLampPlaces, lambentLampAims, lambentLampCones, lambentLampRadii } = this._lampUniforms;
    cubes.forEach(({ position, direction, range, coneScale, outerCosine, radius }, k) => {
      lambentLampPlaces.value[k].set(...position, range);
      lambentLampAims.value[k].set(...direction, coneScale);
      lambentLampCones.value[k] = outerCosine;
      lambentLampRadii.value[k] = radius;
    });
    ofGroup.forEach(({ powers }, g) => this.uniforms[g].lambentLampPowers.value.set(powers));
    for (const { ownLamp, draw, uniforms } of this.surfaces) {
      if (!ownLamp) continue;
      // No lamp lights its own surface.
      const powers = ofGroup[draw.group].powers.slice();
      cubes.forEach(({ lamp }, k) => lamp === ownLamp && powers.fill(0, 3 * k, 3 * k + 3));
      uniforms.lambentLampPowers.value.set(powers);
    }
  }

  /**
   * Shades the samples of groups on the GPU that need it, and draws shadow cubes. Surfaces call it before they are
   * drawn; all but the first of a picture find nothing to do. Returns false once the scene has been disposed of.
   */
  prepare(renderer) {
    if (this.disposed) return false;
    if (this._gpu !== renderer.properties) { // another renderer, or one whose context was lost and has come back
      this._gpu = renderer.properties;
      this._unshaded.fill(true);
      this._cubes?.forget();
    } else if (!this._changed && renderer.info.render.frame === this._frame) {
      return true;
    }
    if (this._suns?.light) renderer.shadowMap.enabled = true;
    this.shadeChanged(renderer);
    this._frame = renderer.info.render.frame;
    return true;
  }

  shadeChanged(renderer) {
    const writes = canWriteLists(renderer);
    if (!writes && this._transfer !== 'unshadowed') {
      console.warn(
        'lambent-three: this device cannot render to floats; light is shown without shadows, and volumes are not shown');
      this.transfer = 'unshadowed';
    }
    this.update();
    if (writes) this._cubes?.update(renderer, this._passes, this._divided.cubes);
    if (!this._unshaded.includes(true)) return;
    this._passes.during(renderer, () => this.groups.forEach((group, index) => {
      if (!this._unshaded[index]) return;
      group.makeTargets();
      const { lambentOpen, lambentSky } = this.uniforms[index];
      if (!lambentOpen.value) group.shade(renderer, this._passes);
      if (writes) group.volume?.shade(renderer, this._passes, lambentOpen.value ? lambentSky.value : null);
      else if (group.volume) group.volume.mesh.visible = false;
      for (const surface of this.surfaces) if (surface.group === group) surface.shade(renderer, this._passes);
    }));
    this._unshaded.fill(false);
  }

  /** Returns the grids around bodies that may change the light of a group. */
  gridsAround(index) {
    return this._bodiesAround[index].map((i) => this.groups[i].grid);
  }

  setLight(group, index, turn) {
    const rotation = new Rotation(turn);
    const inGroup = (light) => light && light.truncate(this._order).rotate(rotation).rgb;
    const { apart } = this._divided.ofGroup[index], incident = this._captures?.incident[index] ?? this._open[index];
    const full = this._transfer === 'full';
    const { lambentOpen, lambentSky, lambentKnown, lambentKeyed, lambentKey } = this.uniforms[index];
    const fill = (to, from) => to.fill(0).set(Float32Array.from(from.subarray(0, to.length)));
    // Where nothing is in the way, all samples take the mean of the light at the light probes.
    const mean = incident.map(({ light }) => light).reduce((a, b) => a.add(b)).multiplyScalar(1 / incident.length);
    fill(lambentSky.value, inGroup(mean));
    fill(lambentKnown.value, inGroup(this._light));
    const key = this._keys;
    fill(lambentKey.value, key ? inGroup(key) : new Float64Array(0));
    lambentKeyed.value = key !== null;
    lambentOpen.value = this._transfer === 'unshadowed';
    if (lambentOpen.value) return;
    // With light k that shines by shadow maps or cubes, and the rest r, transfer brings f r + (f - s) k; columns alike.
    const columns = new Float64Array(this.lamps[index].flat());
    const straight = columns.map((c, i) => c * apart[Math.floor(i / 3)]);
    const lamps = full ? { full: columns } : { shadowed: columns };
    const ofSurface = { ...lamps, shadowed: full ? straight.map((c) => -c) : columns.map((c, i) => c - straight[i]) };
    group.setLight(incident.map(({ light, key }) => {
      const shown = inGroup(light), all = inGroup(both(light, key));
      const surface = {
        full: full ? all : null, shadowed: full ? key && inGroup(key.multiplyScalar(-1)) : shown, sum: shown,
        lamps: ofSurface,
      };
      // Volumes, and what they change around them, have no shadow maps: all light comes by bands.
      const other = group.volume
        ? { full: full ? all : null, shadowed: full ? null : all, sum: all, lamps } : { ...surface, lamps };
      return { surface, other };
    }));
  }

  /** Returns the depth of a picture without what is blended; the viewport begins at `corner`. */
  depthOf(renderer, root, camera, corner) {
    return this._depth.draw(renderer, this._passes, root, camera, corner);
  }

  // What mirrors see of the sky follows from transfer without bounces, once all planes are there.
  findSeen() {
    for (const surface of this.surfaces) surface.findSeen();
    this._captures?.forgetTransfer();
    this._seenChanged = false;
  }

  // Returns the place of the table that a draw looks up, or null.
  tableIndex(draw) {
    const material = this.materialOf(draw), families = this.bundle.extension.brdfTables.map((table) => table.family);
    if (material === undefined) return null;
    return tableFor(this.bundle.json.materials[material], families, draw.outputs <= 9);
  }

  /** Returns the table that a draw looks up, or null. */
  tableOf(draw) {
    const index = this.tableIndex(draw), table = index === null ? null : this.tables[index];
    if (draw.outputs > 9 && table?.order ** 2 !== draw.outputs)
      throw new Error('a glossy surface has no table of its bands');
    return table;
  }

  /** Frees what the scene has on the GPU, and shades no more. */
  dispose() {
    this.disposed = true;
    for (const one of [...this.surfaces, ...this.groups, ...this.tables, this._cubes, this._depth, this._passes])
      one?.dispose();
    this.surfaces = [];
    this.groups = [];
  }
}
