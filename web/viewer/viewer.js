// Shows a bundle under an environment map. Addresses may be given as ?bundle=URL&light=URL.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { HDRLoader } from 'three/addons/loaders/HDRLoader.js';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { KeyLights, LambentPlugin, LightVector, loadProgressively, splitKeyLights } from 'lambent-three';

const element = (id) => document.getElementById(id);
const renderer = new THREE.WebGLRenderer({ canvas: element('view'), antialias: true });
renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
renderer.toneMapping = THREE.NeutralToneMapping;
renderer.shadowMap.enabled = true;
const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(40, 1, 0.01, 1000);
const controls = new OrbitControls(camera, renderer.domElement);
const draco = new DRACOLoader().setDecoderPath('../node_modules/three/examples/jsm/libs/draco/gltf/');
const loader = new GLTFLoader().setDRACOLoader(draco).register((parser) => new LambentPlugin(parser));

let shown = null; // the glTF and what belongs to it
let light = { all: LightVector.constant(0.5, 0.55, 0.65), texture: null, split: null };
let keys = null, progress = '';

function show(gltf) {
  if (shown) {
    scene.remove(shown.scene);
    shown.userData.lambent?.dispose();
    shown.scene.traverse((object) => object.geometry?.dispose());
  }
  shown = gltf;
  scene.add(gltf.scene);
  scene.updateMatrixWorld();
  const sphere = new THREE.Box3().setFromObject(gltf.scene).getBoundingSphere(new THREE.Sphere());
  const narrow = Math.min(1, innerWidth / innerHeight); // a phone held upright needs more distance
  camera.near = sphere.radius * 0.01;
  camera.far = sphere.radius * 30;
  camera.position.copy(sphere.center).addScaledVector(new THREE.Vector3(0.4, 0.45, 0.8), (2.6 * sphere.radius) / narrow);
  controls.target.copy(sphere.center);
  gltf.mixer = new THREE.AnimationMixer(gltf.scene);
  for (const clip of gltf.animations) gltf.mixer.clipAction(clip).play();
  element('hint').hidden = true;
  applyLight();
}

async function showMap(texture) {
  light.texture?.dispose();
  light.split?.environment.dispose();
  texture.mapping = THREE.EquirectangularReflectionMapping;
  scene.background = texture;
  const order = 8;
  light = { texture, all: LightVector.fromEquirect(texture, order), split: splitKeyLights(texture, { order }) };
  // The exposure begins where white that is open to all of this light is half as bright as the screen can be.
  const [r, g, b] = light.all.rgb.slice(0, 3).map((value) => value / Math.sqrt(4 * Math.PI));
  const mean = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  if (mean > 0) element('exposure').valueAsNumber = Math.log2(0.5 / mean);
  applyLight();
}

// Hands light and settings on to the baked scene.
function applyLight() {
  const turn = THREE.MathUtils.degToRad(element('turn').valueAsNumber), baked = shown?.userData.lambent;
  scene.backgroundRotation.y = scene.environmentRotation.y = turn;
  renderer.toneMappingExposure = 2 ** element('exposure').valueAsNumber;
  scene.environment = light.texture;
  if (!baked) return;
  const byMaps = element('suns').checked && light.split?.suns.length > 0 && transfer() !== 'unshadowed';
  if (keys && (!byMaps || keys.userData.for !== shown || keys.userData.map !== light.texture)) {
    scene.remove(keys);
    keys.dispose();
    keys = null;
  }
  if (byMaps && !keys) {
    keys = new KeyLights(light.split.suns).fit(new THREE.Box3().setFromObject(shown.scene), shown.scene);
    keys.userData = { for: shown, map: light.texture };
    scene.add(keys);
  }
  if (keys) keys.rotation.y = turn;
  if (byMaps) scene.environment = light.split.environment; // suns have highlights of their own
  baked.order = element('order').valueAsNumber;
  baked.transfer = transfer();
  baked.light = (byMaps ? light.split.rest : light.all).rotateY(turn);
  baked.keyLight = byMaps ? light.split.key.rotateY(turn) : null;
}

const transfer = () => new FormData(element('panel')).get('transfer');

async function openBundle(url) {
  const gltf = await loadProgressively(loader, url, {
    onPlane: (done, all) => (progress = done < all ? `plane ${done} of ${all}` : ''),
  });
  show(gltf);
  await gltf.userData.planesLoaded;
}

async function openMap(url, name) {
  const Loader = name.toLowerCase().endsWith('.exr') ? EXRLoader : HDRLoader;
  await showMap(await new Loader().setDataType(THREE.FloatType).loadAsync(url));
}

async function openFiles(files) {
  for (const file of files) {
    const url = URL.createObjectURL(file);
    try {
      if (/\.(hdr|exr)$/i.test(file.name)) await openMap(url, file.name);
      else show(await loader.loadAsync(url));
    } catch (error) {
      progress = `${file.name}: ${error.message}`;
    } finally {
      URL.revokeObjectURL(url);
    }
  }
}

element('panel').addEventListener('input', applyLight);
element('files').addEventListener('change', (event) => openFiles(event.target.files));
for (const name of ['dragover', 'dragleave', 'drop'])
  addEventListener(name, (event) => {
    event.preventDefault();
    document.body.classList.toggle('dragged', name === 'dragover');
    if (name === 'drop') openFiles(event.dataTransfer.files);
  });

const times = { frame: 0, light: 0 };
let last = performance.now();
renderer.setAnimationLoop((now) => {
  const seconds = Math.min(now - last, 100) / 1000;
  times.frame += 0.1 * (now - last - times.frame);
  last = now;
  const { clientWidth: width, clientHeight: height } = renderer.domElement;
  renderer.setSize(width, height, false);
  camera.aspect = width / height;
  // A panel along the bottom, as on a phone, leaves the upper part of the picture.
  const panel = element('panel'), covered = panel.offsetWidth > 0.9 * width ? panel.offsetHeight : 0;
  camera.setViewOffset(width, height, 0, covered / 2, width, height);
  controls.update();
  if (element('spin').checked) {
    element('turn').valueAsNumber = ((element('turn').valueAsNumber + 180 + 30 * seconds) % 360) - 180;
    applyLight();
  }
  shown?.mixer.update(seconds);
  scene.updateMatrixWorld();
  const baked = shown?.userData.lambent, start = performance.now();
  if (baked?.update()) times.light = performance.now() - start;
  renderer.render(scene, camera);
  const plain = shown && !baked ? 'plain glTF: no transfer\n' : '';
  element('status').value = `${plain}${times.frame.toFixed(1)} ms a frame, light ${times.light.toFixed(1)} ms\n${progress}`;
});

const query = new URLSearchParams(location.search);
const report = (error) => (progress = error.message);
const opened = [];
if (query.has('light')) opened.push(openMap(query.get('light'), query.get('light')).catch(report));
if (query.has('bundle')) opened.push(openBundle(query.get('bundle')).catch(report));
window.lambentViewer = { opened: Promise.all(opened) };
