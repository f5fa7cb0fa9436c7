// Shows one scene in three ways for beside.js: as a bundle, with light baked into its vertices, and under three's
// LightProbe.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { HDRLoader } from 'three/addons/loaders/HDRLoader.js';
import { EXRExporter } from 'three/addons/exporters/EXRExporter.js';
import { KeyLights, LambentPlugin, LightVector, splitKeyLights } from 'lambent-three';

const DEGREE = Math.PI / 180;
const renderer = new THREE.WebGLRenderer();
renderer.toneMapping = THREE.NoToneMapping;
renderer.shadowMap.enabled = true;
const draco = new DRACOLoader().setDecoderPath('/web/node_modules/three/examples/jsm/libs/draco/gltf/').preload();
const loader = () => new GLTFLoader().setDRACOLoader(draco).register((parser) => new LambentPlugin(parser));

// Light as words of lambent reference: constant:R,G,B and sun:AZ,EL,ANGLE,R,G,B, or one environment map, whose suns are
// apart.
async function lightOf(words) {
  let rest = LightVector.constant(0, 0, 0), split = null;
  for (const word of words) {
    const n = word.split(':')[1]?.split(',').map(Number);
    if (word.startsWith('constant:')) rest = rest.add(LightVector.constant(...n));
    else if (word.startsWith('sun:')) {
      const toward = new THREE.Vector3().setFromSphericalCoords(1, (90 - n[1]) * DEGREE, n[0] * DEGREE);
      rest = rest.add(LightVector.disc(toward, n[2] * DEGREE, { r: n[3], g: n[4], b: n[5] }));
    } else split = splitKeyLights(await new HDRLoader().setDataType(THREE.FloatType).loadAsync(word));
  }
  return split ? { all: split.rest.add(split.key), ...split } : { all: rest, rest, key: null, suns: [] };
}

// Textures as one ray through the middle of a pixel sees them, as in linear pictures of the reference.
function finestTexels(root) {
  root.traverse((object) => {
    for (const value of Object.values(object.material ?? {}))
      if (value?.isTexture)
        Object.assign(value, { minFilter: THREE.LinearFilter, generateMipmaps: false, needsUpdate: true });
  });
}

const WAYS = {
  bundle({ gltf, light, scene }) {
    const baked = gltf.userData.lambent;
    let suns = null;
    if (light.suns.length > 0) {
      suns = new KeyLights(light.suns).fit(new THREE.Box3().setFromObject(gltf.scene), gltf.scene);
      scene.add(suns);
    }
    return (turn) => {
      baked.light = light.rest.rotateY(turn);
      baked.keyLight = light.key && light.key.rotateY(turn);
      if (suns) suns.rotation.y = turn;
      scene.updateMatrixWorld();
      baked.update();
    };
  },
  // COLOR_0 holds E/pi over the largest value, which the scene's extras tell.
  vertices({ gltf }) {
    const materials = new Set();
    gltf.scene.traverse((object) => object.isMesh && materials.add(object.material));
    for (const material of materials) material.color.multiplyScalar(gltf.scene.userData.largest);
    return () => {};
  },
  probe({ light, scene }) {
    const probe = new THREE.LightProbe();
    scene.add(probe);
    return (turn) => {
      // The basis of three is the same: real, without the Condon-Shortley sign, polar axis +Z.
      const { rgb } = light.all.rotateY(turn);
      probe.sh.coefficients.forEach((color, i) => color.fromArray(rgb, 3 * i));
    };
  },
};

let shown = null;

const finish = () => renderer.getContext().readPixels(0, 0, 1, 1, 6408, 5121, new Uint8Array(4));

// Loads a scene and draws it once. Returns milliseconds from the request to the lit picture.
async function show({ way, url, words, size }) {
  const light = await lightOf(words), scene = new THREE.Scene();
  renderer.setSize(...size);
  const start = performance.now(), gltf = await loader().loadAsync(url);
  scene.add(gltf.scene);
  scene.updateMatrixWorld();
  const camera = gltf.cameras.find((each) => each.name === 'main');
  camera.aspect = size[0] / size[1];
  camera.updateProjectionMatrix();
  const turnTo = WAYS[way]({ gltf, light, scene });
  turnTo(0);
  renderer.render(scene, camera);
  finish();
  const first_ms = performance.now() - start;
  shown = { scene, camera, turnTo, size };
  return { first_ms };
}

// Returns the linear picture as an EXR file in base64. Without `degrees` the light stays where it was.
async function picture(degrees) {
  const { scene, camera, turnTo, size } = shown;
  finestTexels(scene);
  if (degrees !== undefined) turnTo(degrees * DEGREE);
  const target = new THREE.WebGLRenderTarget(...size, { type: THREE.FloatType });
  renderer.setRenderTarget(target);
  renderer.setClearColor(0x000000, 0);
  renderer.clear();
  renderer.render(scene, camera);
  renderer.setRenderTarget(null);
  const exr = await new EXRExporter().parse(renderer, target, { type: THREE.FloatType });
  target.dispose();
  let text = '';
  for (const byte of exr) text += String.fromCharCode(byte);
  return btoa(text);
}

// Returns the median of milliseconds for a frame while the light turns, and while it stands still.
function frames(count) {
  const { scene, camera, turnTo } = shown;
  const median = (change) => {
    const times = Array.from({ length: count }, (_, i) => {
      const start = performance.now();
      change((2 * Math.PI * i) / count);
      renderer.render(scene, camera);
      finish();
      return performance.now() - start;
    });
    return times.sort((a, b) => a - b)[count >> 1];
  };
  return { turning_ms: median(turnTo), still_ms: median(() => {}) };
}

window.beside = { show, picture, frames };
