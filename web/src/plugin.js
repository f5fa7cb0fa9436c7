// The plugin of three's GLTFLoader. Register it, load a bundle, and find a LambentScene in gltf.userData.lambent.
import { Matrix4, Mesh } from 'three';
import { Bundle, EXTENSION } from './bundle.js';
import { Lamp } from './local_lights.js';
import { LambentScene } from './scene.js';
import { SceneSuns } from './suns.js';

const warned = new Set();

function warnOnce(message) {
  if (warned.has(message)) return;
  warned.add(message);
  console.warn(`lambent-three: ${message}; the scene is shown as plain glTF`);
}

export class LambentPlugin {
  /** With `planes: false` the weight planes are left to the caller, as loadProgressively does. */
  constructor(parser, { planes = true } = {}) {
    this.name = EXTENSION;
    this.parser = parser;
    this.loadsPlanes = planes;
  }

  async afterRoot(gltf) {
    const { parser } = this;
    if (!parser.json.extensions?.[EXTENSION]) return;
    try {
      const viewBytes = async (index) => new Uint8Array(await parser.getDependency('bufferView', index));
      const bundle = new Bundle(parser.json, viewBytes);
      const scene = await LambentScene.create(bundle, gltf.scene);
      if (this.loadsPlanes) await scene.loadPlanes();
      attach(scene, gltf, parser);
      gltf.userData.lambent = scene;
    } catch (error) {
      warnOnce(error.message);
    }
  }
}

// Finds three's objects for nodes and primitives and gives every draw a mesh of its own.
function attach(scene, gltf, parser) {
  gltf.scene.updateWorldMatrix(true, true);
  const nodes = [], meshes = new Map();
  gltf.scene.traverse((object) => {
    const place = parser.associations.get(object);
    if (place?.nodes !== undefined) nodes[place.nodes] = object;
    if (!object.isMesh || place?.meshes === undefined) return;
    let owner = object;
    while (owner && parser.associations.get(owner)?.nodes === undefined) owner = owner.parent;
    if (!owner) return;
    meshes.set(`${parser.associations.get(owner).nodes}/${place.primitives ?? 0}`, object);
    const primitive = parser.json.meshes[place.meshes].primitives[place.primitives ?? 0];
    if (primitive.material === undefined) object.userData.lambentDefaultMaterial = true;
  });
  scene.nodes = nodes;
  scene.restInverses = nodes.map((node) => node.matrixWorld.clone().invert());

  const lamps = lampsOf(scene, gltf.scene, parser);
  const groupFromWorld = scene.groups.map((_, g) => scene.worldFromGroup(g).invert());
  const parts = scene.surfaces.filter((surface) => {
    const { draw } = surface, mesh = meshes.get(`${draw.node}/${draw.primitive}`);
    if (!mesh || mesh.material.isMeshBasicMaterial) return false;
    if (mesh.geometry.getAttribute('position').count !== surface.vertexCount)
      throw new Error(`mesh ${draw.node} was decoded to another number of vertices than transfer was baked for`);
    const groupFromMesh = new Matrix4().multiplyMatrices(groupFromWorld[draw.group], mesh.matrixWorld);
    const spheres = scene.hasSpheres(draw.group);
    surface.attach(mesh, groupFromMesh, scene.uniforms[draw.group], {
      table: scene.tableOf(draw), grids: scene.gridsAround(draw.group), lamps: lamps.length > 0 || spheres, spheres,
      ownLamp: scene.sphereLampOf(draw),
    });
    surface.mesh = mesh;
    return true;
  });
  scene.surfaces = parts;
  const replaced = new Set();
  for (const surface of parts) {
    const { mesh } = surface;
    if (!replaced.has(mesh)) {
      replaced.add(mesh);
      mesh.geometry = surface.geometry;
      mesh.material = surface.material;
      continue;
    }
    const side = new Mesh(surface.geometry, surface.material); // the back of a double-sided material
    side.name = `${mesh.name}_back`;
    mesh.add(side);
    surface.mesh = side;
  }
  for (const { mesh } of parts) mesh.onBeforeRender = (renderer) => scene.prepare(renderer);
  scene.setLamps(lamps, [...meshes.values()]);
  scene.setSuns(new SceneSuns(sunsOf(scene, gltf.scene, parser), gltf.scene));
  scene.groups.forEach(({ json, volume }, index) => {
    if (!volume) return;
    const parent = nodes[json.node] ?? gltf.scene, groupFromBox = volume.makeMesh(scene, index);
    volume.mesh.matrix.copy(parent.matrixWorld).invert().multiply(scene.worldFromGroup(index)).multiply(groupFromBox);
    parent.add(volume.mesh);
  });
}

// Returns the node of one of three's lights, and its column if it is a lamp of a group.
function placeOf(light, scene, parser) {
  let owner = light, column = null;
  while (owner && parser.associations.get(owner)?.nodes === undefined) owner = owner.parent;
  const node = parser.associations.get(owner)?.nodes;
  scene.groups.forEach(({ json }, group) => json.lights.forEach((lamp, index) => {
    if (lamp.kind === 'node' && lamp.node === node) column = { group, index };
  }));
  return { node, column };
}

// Takes over three's lights for lamps, in the order of their nodes.
function lampsOf(scene, root, parser) {
  const found = [];
  root.traverse((light) => {
    if (!light.isPointLight && !light.isSpotLight) return;
    const { node, column } = placeOf(light, scene, parser);
    found.push([node, new Lamp(light, column)]);
  });
  return found.sort(([a], [b]) => a - b).map(([, lamp]) => lamp);
}

// Returns three's directional lights. Bundles of version 0.10 have columns for them, which stay dark.
function sunsOf(scene, root, parser) {
  const suns = [];
  root.traverse((light) => {
    if (!light.isDirectionalLight) return;
    const { column } = placeOf(light, scene, parser);
    if (column) scene.lamps[column.group][column.index] = [0, 0, 0];
    suns.push(light);
  });
  return suns;
}
