// Renders a bundle to linear floats and holds them against a picture of lambent-demo.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { HDRLoader } from 'three/addons/loaders/HDRLoader.js';
import * as lambent from 'lambent-three';
import { drawCubesFinely } from './fine_cubes.js';
import { paintSky, toward } from './painted_sky.js';

const DEGREE = Math.PI / 180;
const renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
renderer.toneMapping = THREE.NeutralToneMapping; // of what is shown for the eye; linear pictures have none
renderer.toneMappingExposure = 0.25;
document.body.append(renderer.domElement);

function loader(options) {
  const draco = new DRACOLoader().setDecoderPath('/web/node_modules/three/examples/jsm/libs/draco/gltf/');
  return new GLTFLoader().setDRACOLoader(draco).register((parser) => new lambent.LambentPlugin(parser, options));
}

// Makes a light from words of lambent-demo: constant:R,G,B, sun:AZ,EL,ANGLE,R,G,B or an environment map. What
// bodies hide of a sun has its outline, so it has all bands that there are.
async function lightOf(word) {
  const [kind, rest] = word.split(':');
  const n = rest?.split(',').map(Number);
  if (kind === 'constant') return lambent.LightVector.constant(n[0], n[1], n[2]);
  if (kind === 'sun')
    return lambent.LightVector.disc(
      toward(n[0], n[1]), n[2] * DEGREE, { r: n[3], g: n[4] ?? n[3], b: n[5] ?? n[3] }, lambent.MAX_ORDER);
  const texture = await new HDRLoader().setDataType(THREE.FloatType).loadAsync(word);
  return lambent.LightVector.fromEquirect(texture);
}

// Paints the lights of lightOf as an environment for three's mirrors.
async function environmentOf(words) {
  const map = words.find((word) => !/^(constant|sun):/.test(word));
  if (map) return new HDRLoader().setDataType(THREE.FloatType).loadAsync(map);
  const { data, width, height } = paintSky(words), texture = new THREE.DataTexture(
    data, width, height, THREE.RGBAFormat, THREE.FloatType);
  Object.assign(texture, { magFilter: THREE.LinearFilter, minFilter: THREE.LinearFilter, needsUpdate: true });
  return texture;
}

// The file's own camera by its name or index, or an orbit.
function cameraOf(gltf, words, aspect) {
  if (words.startsWith('orbit:')) return orbitCamera(gltf.userData.lambent.bundle, words, aspect);
  const camera = gltf.cameras.find((one, i) => String(i) === words || one.name === words);
  if (!camera) throw new Error(`there is no camera ${words}`);
  camera.aspect = aspect;
  camera.updateProjectionMatrix();
  return camera;
}

function orbitCamera(bundle, words, aspect) {
  const [azimuth, elevation, distance, fov] = words.split(':')[1].split(',').map(Number);
  const box = new THREE.Box3(), corner = new THREE.Vector3();
  for (const group of bundle.groups) {
    const frame = new THREE.Matrix4().compose(
      new THREE.Vector3(...group.restTranslation), new THREE.Quaternion(...group.restRotation), new THREE.Vector3(1, 1, 1));
    for (let i = 0; i < 8; ++i) {
      const pick = (axis) => (i & (1 << axis) ? group.boundsMax : group.boundsMin)[axis];
      box.expandByPoint(corner.set(pick(0), pick(1), pick(2)).applyMatrix4(frame));
    }
  }
  const centre = box.getCenter(new THREE.Vector3()), radius = 0.5 * box.getSize(new THREE.Vector3()).length();
  const camera = new THREE.PerspectiveCamera(fov, aspect, radius * 0.01, radius * 20);
  camera.position.copy(centre).addScaledVector(toward(azimuth, elevation), distance * radius);
  camera.up.copy(toward(azimuth, elevation + 90));
  camera.lookAt(centre);
  return camera;
}

// Textures are read as one ray through the middle of the pixel sees them, as in linear pictures of lambent-demo.
function finestTexels(root) {
  root.traverse((object) => {
    for (const value of Object.values(object.material ?? {}))
      if (value?.isTexture) {
        value.minFilter = THREE.LinearFilter;
        value.generateMipmaps = false;
        value.needsUpdate = true;
      }
  });
}

function readFloats(scene, camera, width, height) {
  const target = new THREE.WebGLRenderTarget(width, height, { type: THREE.FloatType });
  renderer.setRenderTarget(target);
  renderer.setClearColor(0x000000, 0);
  renderer.clear();
  renderer.render(scene, camera);
  const pixels = new Float32Array(4 * width * height);
  renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
  renderer.setRenderTarget(null);
  target.dispose();
  return pixels;
}

// Averages squares of pixels, so that two rasterizers, which differ by a pixel at edges, give pictures that may be
// compared. What we show no surface at counts as black in both.
function averaged(pixels, mask, width, height, factor) {
  const out = new Float32Array((4 * width * height) / factor ** 2), across = width / factor;
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const from = 4 * (y * width + x), to = 4 * (Math.floor(y / factor) * across + Math.floor(x / factor));
      if (mask[from + 3] === 0) continue;
      for (let c = 0; c < 3; ++c) out[to + c] += pixels[from + c] / factor ** 2;
      out[to + 3] += 1 / factor ** 2;
    }
  return out;
}

// Returns relative RMS over all pixels that show a surface, the same without pixels beside edges, where luminance
// steps by more than 10 %, and the median of the relative difference.
function compare(ours, theirs, width, height) {
  const sums = { all: [0, 0], inside: [0, 0] }, relative = [];
  const luminance = (pixels, p) => pixels[4 * p] + pixels[4 * p + 1] + pixels[4 * p + 2];
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const p = y * width + x;
      if (ours[4 * p + 3] === 0) continue;
      let edge = false;
      for (let k = 0; k < 9; ++k) {
        const nx = x + (k % 3) - 1, ny = y + Math.floor(k / 3) - 1;
        if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
        for (const pixels of [ours, theirs]) {
          const a = luminance(pixels, p), b = luminance(pixels, ny * width + nx);
          if (Math.abs(a - b) > 0.1 * Math.max(a, b)) edge = true;
        }
      }
      for (let c = 0; c < 3; ++c) {
        const difference = (ours[4 * p + c] - theirs[4 * p + c]) ** 2, square = theirs[4 * p + c] ** 2;
        for (const sum of edge ? [sums.all] : [sums.all, sums.inside]) {
          sum[0] += difference;
          sum[1] += square;
        }
        relative.push(Math.sqrt(difference / square));
      }
    }
  const rms = ([difference, square]) => Math.sqrt(difference / square);
  relative.sort((a, b) => a - b);
  return { all: rms(sums.all), inside: rms(sums.inside), median: relative[relative.length >> 1] };
}

// Shows ten times the difference below the picture, for the eye.
function showDifference(ours, theirs, width, height) {
  const canvas = document.querySelector('canvas.difference') ?? document.createElement('canvas');
  Object.assign(canvas, { width, height, className: 'difference' });
  document.body.append(canvas);
  const context = canvas.getContext('2d'), image = context.createImageData(width, height);
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x)
      for (let c = 0; c < 4; ++c) {
        const from = 4 * ((height - 1 - y) * width + x) + c;
        image.data[4 * (y * width + x) + c] = c === 3 ? 255 : 2550 * Math.abs(ours[from] - theirs[from]) * ours[from - c + 3];
      }
  context.putImageData(image, 0, 0);
}

async function render(options) {
  const { bundle, lights, camera: words, size, transfer = 'full', picture,
    time, environment, sky, fineCubes, factor = 1 } = options;
  const [width, height] = size, endFineCubes = fineCubes ? drawCubesFinely() : () => {};
  const gltf = await loader().loadAsync(bundle), scene = new THREE.Scene(), baked = gltf.userData.lambent;
  if (!baked) throw new Error('the bundle was shown as plain glTF');
  scene.add(gltf.scene);
  baked.light = (await Promise.all(lights.map(lightOf))).reduce((a, b) => a.add(b));
  baked.transfer = transfer;
  if (environment) {
    scene.environment = await environmentOf(lights);
    scene.environment.mapping = THREE.EquirectangularReflectionMapping;
  }
  finestTexels(gltf.scene);
  if (time !== undefined) {
    const mixer = new THREE.AnimationMixer(gltf.scene);
    for (const clip of gltf.animations) mixer.clipAction(clip).play();
    mixer.setTime(time);
  }
  scene.updateMatrixWorld();
  const camera = cameraOf(gltf, words, width / height);
  const pixels = readFloats(scene, camera, factor * width, factor * height), mask = pixels.slice();
  if (sky) { // shines through volumes
    scene.background = await environmentOf(lights);
    scene.background.mapping = THREE.EquirectangularReflectionMapping;
    pixels.set(readFloats(scene, camera, factor * width, factor * height));
  }
  renderer.setSize(width, height);
  renderer.render(scene, camera); // for the eye
  const result = {};
  if (picture) {
    const theirs = await new EXRLoader().setDataType(THREE.FloatType).loadAsync(picture);
    const average = (picture) => averaged(picture, mask, factor * width, factor * height, factor);
    const [a, b] = [average(pixels), average(theirs.image.data)];
    Object.assign(result, compare(a, b, width, height));
    showDifference(a, b, width, height);
  }
  const before = { ...renderer.info.memory };
  endFineCubes();
  scene.remove(gltf.scene);
  scene.environment?.dispose();
  scene.background?.dispose();
  baked.dispose();
  gltf.scene.traverse((object) => {
    for (const value of Object.values(object.material ?? {})) if (value?.isTexture) value.dispose();
  });
  result.memory = { before, after: { ...renderer.info.memory } };
  return result;
}

// Sets all lamps of a bundle to half their strength, where they shine alone. Returns their number, and how far the picture
// is from half of what it was.
async function lampsHalved({ bundle, camera: words, size: [width, height] }) {
  const gltf = await loader().loadAsync(bundle), scene = new THREE.Scene(), baked = gltf.userData.lambent;
  scene.add(gltf.scene);
  baked.light = lambent.LightVector.constant(0, 0, 0);
  scene.updateMatrixWorld();
  const camera = cameraOf(gltf, words, width / height), all = readFloats(scene, camera, width, height);
  let lamps = 0;
  baked.groups.forEach(({ json }, group) => json.lights.forEach(({ color: [r, g, b] }, index) => {
    baked.setLamp(group, index, new THREE.Color(r / 2, g / 2, b / 2));
    ++lamps;
  }));
  const half = readFloats(scene, camera, width, height).map((c, i) => (i % 4 === 3 ? c : 2 * c));
  baked.dispose();
  return { lamps, ...compare(half, all, width, height) };
}

// Returns the light that the GPU finds at the samples of one number of outputs, RGBA each, group by group.
async function samples(bundle, rgb, outputs) {
  const gltf = await loader().loadAsync(bundle), baked = gltf.userData.lambent, scene = new THREE.Scene();
  scene.add(gltf.scene);
  baked.light = new lambent.LightVector(Math.sqrt(rgb.length / 3), Float64Array.from(rgb));
  scene.updateMatrixWorld();
  baked.prepare(renderer);
  const all = baked.groups.map((group) => {
    const run = group.runs.get(outputs), { width, height } = run.target;
    const pixels = new Float32Array(4 * width * height), entryOf = group.entriesOf(run);
    renderer.readRenderTargetPixels(run.target, 0, 0, width, height, pixels);
    return Array.from({ length: 4 * run.count }, (_, i) => pixels[4 * entryOf(run.first + (i >> 2)) + (i & 3)]);
  });
  baked.dispose();
  return all;
}

// Projects an environment map twice: its pixels, and a scene with it as its background.
async function projections(map) {
  const texture = await new HDRLoader().setDataType(THREE.FloatType).loadAsync(map), scene = new THREE.Scene();
  texture.mapping = THREE.EquirectangularReflectionMapping;
  scene.background = texture;
  const pixels = lambent.LightVector.fromEquirect(texture), drawn = lambent.LightVector.fromScene(renderer, scene, null, 5, 128);
  texture.dispose();
  let error = 0, sum = 0;
  pixels.rgb.forEach((value, i) => {
    error += (value - drawn.rgb[i]) ** 2;
    sum += value * value;
  });
  return Math.sqrt(error / sum);
}

// Loads a bundle by ranges and tells what came when.
async function progressive(bundle, camera, size) {
  const draco = new DRACOLoader().setDecoderPath('/web/node_modules/three/examples/jsm/libs/draco/gltf/');
  const steps = [], gltf = await lambent.loadProgressively(
    new GLTFLoader().setDRACOLoader(draco), bundle, { onPlane: (done, all) => steps.push([done, all]) });
  const baked = gltf.userData.lambent, scene = new THREE.Scene();
  scene.add(gltf.scene);
  const view = cameraOf(gltf, camera, size[0] / size[1]);
  const shot = () => {
    scene.updateMatrixWorld();
    baked.update();
    return readFloats(scene, view, ...size);
  };
  const early = shot();
  await gltf.userData.planesLoaded;
  const late = shot(), whole = await loader().loadAsync(bundle);
  scene.clear().add(whole.scene);
  whole.userData.lambent.update();
  scene.updateMatrixWorld();
  const reference = readFloats(scene, view, ...size);
  baked.dispose();
  whole.userData.lambent.dispose();
  return { steps, early: compare(early, reference, ...size).all, late: compare(late, reference, ...size).all };
}

// Loads a bundle twice that says it is of a newer format. Returns whether it was shown as plain glTF.
async function newerFormat(bundle) {
  const bytes = new Uint8Array(await (await fetch(bundle)).arrayBuffer());
  const length = new DataView(bytes.buffer).getUint32(12, true), json = bytes.subarray(20, 20 + length);
  const text = new TextDecoder().decode(json), at = text.search(/"version":\d[,}]/) + '"version":'.length;
  json[at] = '9'.charCodeAt(0);
  let plain = 0;
  for (let i = 0; i < 2; ++i) {
    const gltf = await loader().parseAsync(bytes.slice().buffer, '');
    gltf.scene.traverse((object) => (plain += object.isMesh && !gltf.userData.lambent ? 1 : 0));
  }
  return plain;
}

// Shows a bundle under an environment map whose suns shine by shadow maps, or else by bands alone.
async function sunny({ bundle, map, camera, size, keys, picture }) {
  const texture = await new HDRLoader().setDataType(THREE.FloatType).loadAsync(map), scene = new THREE.Scene();
  const gltf = await loader().loadAsync(bundle), baked = gltf.userData.lambent;
  scene.add(gltf.scene);
  texture.mapping = THREE.EquirectangularReflectionMapping;
  const { rest, key, suns, environment } = lambent.splitKeyLights(texture);
  scene.environment = keys ? environment : texture;
  baked.light = keys ? rest : rest.add(key);
  let lights = null;
  if (keys) {
    baked.keyLight = key;
    lights = new lambent.KeyLights(suns).fit(new THREE.Box3().setFromObject(gltf.scene), gltf.scene);
    scene.add(lights);
    renderer.shadowMap.enabled = true;
  }
  finestTexels(gltf.scene);
  scene.updateMatrixWorld();
  baked.update();
  const view = cameraOf(gltf, camera, size[0] / size[1]), pixels = readFloats(scene, view, ...size);
  renderer.setSize(...size);
  renderer.render(scene, view);
  const theirs = await new EXRLoader().setDataType(THREE.FloatType).loadAsync(picture);
  showDifference(pixels, theirs.image.data, ...size);
  for (const one of [lights, environment, texture, baked]) one?.dispose();
  return { suns: suns.length, ...compare(pixels, theirs.image.data, ...size) };
}

// Shows a bundle by a narrow camera far away and by an orthographic one, and returns how these differ.
async function fromAfar({ bundle, lights, size }) {
  const gltf = await loader().loadAsync(bundle), scene = new THREE.Scene(), baked = gltf.userData.lambent;
  scene.add(gltf.scene);
  baked.light = (await Promise.all(lights.map(lightOf))).reduce((a, b) => a.add(b));
  const half = 1, far = 500, aspect = size[0] / size[1], angle = 2 * Math.atan(half / far) / DEGREE;
  const cameras = [
    new THREE.PerspectiveCamera(angle, aspect, far - 4, far + 4),
    new THREE.OrthographicCamera(-half * aspect, half * aspect, half, -half, far - 4, far + 4),
  ];
  scene.updateMatrixWorld();
  const [near, straight] = cameras.map((camera) => {
    camera.position.copy(toward(30, 30)).multiplyScalar(far);
    camera.lookAt(0, 0, 0);
    return readFloats(scene, camera, ...size);
  });
  baked.dispose();
  return compare(straight, near, ...size);
}

// Loses the context of WebGL and gets it back. Returns how the pictures before and after differ, and what memory is
// left.
async function loseContext({ bundle, lights, camera: words, size, time }) {
  const gltf = await loader().loadAsync(bundle), scene = new THREE.Scene(), baked = gltf.userData.lambent;
  scene.add(gltf.scene);
  baked.light = (await Promise.all(lights.map(lightOf))).reduce((a, b) => a.add(b));
  const mixer = new THREE.AnimationMixer(gltf.scene);
  for (const clip of gltf.animations) mixer.clipAction(clip).play();
  mixer.setTime(time);
  scene.updateMatrixWorld();
  const camera = cameraOf(gltf, words, size[0] / size[1]), canvas = renderer.domElement;
  const before = readFloats(scene, camera, ...size), loss = renderer.getContext().getExtension('WEBGL_lose_context');
  const happens = (event) => new Promise((resolve) => canvas.addEventListener(event, resolve, { once: true }));
  const lost = happens('webglcontextlost'), restored = happens('webglcontextrestored');
  loss.loseContext();
  await lost;
  renderer.render(scene, camera); // shows nothing, and does no harm
  await new Promise((resolve) => setTimeout(resolve));
  loss.restoreContext();
  await restored;
  const after = readFloats(scene, camera, ...size), lit = after.some((value, i) => i % 4 < 3 && value > 0);
  const error = renderer.getContext().getError();
  scene.remove(gltf.scene);
  baked.dispose();
  gltf.scene.traverse((object) => {
    for (const value of Object.values(object.material ?? {})) if (value?.isTexture) value.dispose();
  });
  return { lit, error, memory: { ...renderer.info.memory }, ...compare(after, before, ...size) };
}

window.lambentTest = {
  fromAfar, lampsHalved, loseContext, render, samples, projections, progressive, sunny, newerFormat, ready: true,
};
