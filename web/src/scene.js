// What a bundle adds to three's scene: groups with transfer, the light that they stand in, and the surfaces that show
// it. Light is set once and turned into the frame of each group; shading happens when light, transfer or a group's
// rotation changed.
import { Matrix3, Matrix4, Quaternion, Vector3 } from 'three';
import { Group } from './group.js';
import { Surface } from './surface.js';
import { LightVector } from './light_vector.js';

const TRANSFERS = ['full', 'shadowed', 'unshadowed'];

export class LambentScene {
  /** Loads what surfaces need before their planes come. `root` is the glTF scene in three. */
  static async create(bundle, root) {
    const scene = new LambentScene(bundle, root);
    await Promise.all(scene.groups.map((group) => group.load(bundle)));
    const wanted = bundle.draws.filter((draw) => scene.groups[draw.group].samples.has(draw.outputs));
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
    this._transfer = 'full';
    this._order = 8;
    this._changed = true;
    this._turns = this.groups.map(() => null);
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
   * Light of suns that shine directly by shadow maps (KeyLights). Transfer brings only what they bounce.
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

  /** Sets the light of a lamp that was baked into a group: colour times strength. */
  setLamp(group, index, color) {
    this.lamps[group][index] = [color.r, color.g, color.b];
    this._changed = true;
  }

  /** Adds a weight plane that has arrived; planes of a transfer come in order. */
  addPlane({ transfer, index }, codes) {
    transfer.planes[index] = codes;
    this._changed = this._openChanged = true;
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

  /** Shades what changed. Call it before rendering; world matrices must be up to date. Returns whether it shaded. */
  update() {
    if (this._openChanged) this.findOpenShares();
    let shaded = false;
    this.groups.forEach((group, index) => {
      const turn = new Matrix4().extractRotation(this.worldFromGroup(index)).invert();
      const before = this._turns[index];
      if (!this._changed && before && turn.elements.every((e, i) => Math.abs(e - before.elements[i]) < 1e-5)) return;
      this._turns[index] = turn;
      this.groupFromWorld[index].setFromMatrix4(turn);
      this.shadeGroup(group, index, turn);
      shaded = true;
    });
    this._changed = false;
    return shaded;
  }

  shadeGroup(group, index, turn) {
    const inGroup = (light) => light && light.truncate(this._order).rotate(turn).rgb;
    const light = this._light.truncate(this._order);
    const all = this._key ? light.add(this._key) : light;
    const unshadowed = this._transfer === 'unshadowed', full = this._transfer === 'full';
    const rest = inGroup(light);
    if (!unshadowed) {
      // With key lights k and the rest r the light is f r + (f - s) k: their direct part comes by shadow maps.
      const lamps = new Float64Array(this.lamps[index].flat());
      group.shade({
        full: full ? inGroup(all) : null,
        shadowed: full ? this._key && inGroup(this._key.multiplyScalar(-1)) : rest,
        sum: rest,
        lamps: full ? { full: lamps } : { shadowed: lamps },
      });
    }
    for (const surface of this.surfaces)
      if (surface.group === group) surface.shade(rest, unshadowed);
  }

  // Shades once with light of radiance 1 from everywhere, without bounces, to learn what is open.
  findOpenShares() {
    const white = LightVector.constant(1, 1, 1, 1).rgb;
    for (const group of this.groups) {
      group.shade({ full: null, shadowed: white, sum: white, lamps: {} });
      for (const surface of this.surfaces) if (surface.group === group) surface.keepOpenShare();
    }
    this._openChanged = false;
  }

  /** Frees what surfaces have on the GPU, and shades no more. */
  dispose() {
    this.disposed = true;
    for (const surface of this.surfaces) surface.dispose();
    this.surfaces = [];
    this.groups = [];
  }
}

/** Matrices of the groups that materials read as uniforms. */
export const newGroupMatrices = (groups) => groups.map(() => new Matrix3());
