// The live pictures of the site. Each figure of class "live" shows a baked scene with a slider for one thing, and one
// that turns the light. A picture loads when it is scrolled to, and is drawn when something changed; at rest it costs
// nothing.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { DRACOLoader } from 'three/addons/loaders/DRACOLoader.js';
import { HDRLoader } from 'three/addons/loaders/HDRLoader.js';
import { KeyLights, LambentPlugin, LightVector, splitKeyLights } from 'lambent-three';

const ORDER = 8, DEGREE = Math.PI / 180;
const draco = new DRACOLoader().setDecoderPath('node_modules/three/examples/jsm/libs/draco/gltf/');

// A sky, and a sun that keeps its irradiance whatever its radius is. All angles are in degrees.
function skyAndSun(radius, azimuth) {
  const radiance = 2.4 / (Math.PI * Math.sin(radius * DEGREE) ** 2), elevation = 40;
  const toward = new THREE.Vector3().setFromSphericalCoords(1, (90 - elevation) * DEGREE, azimuth * DEGREE);
  const color = { r: radiance, g: 0.9 * radiance, b: 0.75 * radiance };
  return LightVector.constant(0.22, 0.27, 0.36, ORDER).add(LightVector.disc(toward, radius * DEGREE, color, ORDER));
}

// What a slider does. `sides` are drawn left and right of it; with one side it has a meaning of its own.
const split = { label: 'Compare', min: 0, max: 100, step: 1, value: 50, text: () => '' };
const PICTURES = {
  order: {
    bundle: 'hello', exposure: 1,
    slider: { label: 'Bands', min: 1, max: 8, step: 1, value: 3, text: (n) => `${n}, ${n * n} numbers a color` },
    sides: [{
      set: (baked, turn, bands) => Object.assign(baked, { light: skyAndSun(12, -130).rotateY(turn), order: bands }),
    }],
  },
  size: {
    bundle: 'hello', exposure: 1,
    slider: { label: 'Radius', min: 4, max: 90, step: 1, value: 20, text: (n) => `${n}°` },
    sides: [{ set: (baked, turn, radius) => (baked.light = skyAndSun(radius, -130).rotateY(turn)) }],
  },
  shadows: {
    bundle: 'gallery', exposure: 1, slider: split,
    sides: ['unshadowed', 'shadowed'].map((transfer) => ({
      name: transfer,
      set: (baked, turn) => Object.assign(baked, { light: skyAndSun(20, 50).rotateY(turn), transfer }),
    })),
  },
  bounces: {
    bundle: 'gallery', exposure: 1, slider: split,
    sides: [['direct light', 'shadowed'], ['all bounces', 'full']].map(([name, transfer]) => ({
      name, set: (baked, turn) => Object.assign(baked, { light: skyAndSun(20, 50).rotateY(turn), transfer }),
    })),
  },
  keys: {
    bundle: 'hello', exposure: 0.4, slider: split, map: 'light/sky.hdr', turn: 150,
    sides: [
      { name: 'eight bands', set: (baked, turn, value, sun) => {
        Object.assign(baked, { light: sun.rest.add(sun.key).rotateY(turn), keyLight: null });
        sun.lights.visible = false;
      } },
      { name: 'key light', set: (baked, turn, value, sun) => {
        Object.assign(baked, { light: sun.rest.rotateY(turn), keyLight: sun.key.rotateY(turn) });
        sun.lights.rotation.y = turn;
        sun.lights.visible = true;
      } },
    ],
  },
};

function make(tag, properties, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

class LivePicture {
  constructor(figure) {
    this.figure = figure;
    this.kind = PICTURES[figure.dataset.live];
    this.frame = figure.querySelector('.frame');
    const { slider, sides } = this.kind;
    const { min, max, step, value } = slider;
    this.slider = make('input', { type: 'range', min, max, step, defaultValue: value });
    this.turn = make('input', { type: 'range', min: -180, max: 180, defaultValue: this.kind.turn ?? 0 });
    this.said = make('output');
    figure.append(
      make('label', {}, make('span', { textContent: slider.label }), this.slider, this.said),
      make('label', {}, make('span', { textContent: 'Turn the light' }), this.turn));
    if (sides.length > 1) {
      this.line = make('i', { className: 'line' });
      this.frame.append(this.line, ...sides.map((side, i) =>
        make('span', { className: i === 0 ? 'left' : 'right', textContent: side.name })));
    }
    this.say();
    for (const input of [this.slider, this.turn]) input.addEventListener('input', () => this.change());
  }

  say() {
    this.said.value = this.kind.slider.text(this.slider.valueAsNumber);
    this.line?.style.setProperty('left', `${this.slider.value}%`);
  }

  change() {
    this.say();
    if (!this.renderer || this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  async load() {
    const canvas = make('canvas', {});
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.toneMappingExposure = this.kind.exposure;
    this.renderer.shadowMap.enabled = Boolean(this.kind.map);
    this.renderer.setScissorTest(true);
    const loader = new GLTFLoader().setDRACOLoader(draco).register((parser) => new LambentPlugin(parser));
    const gltf = await loader.loadAsync(`bundles/${this.kind.bundle}.lmb.glb`);
    this.baked = gltf.userData.lambent;
    this.scene = new THREE.Scene().add(gltf.scene);
    this.scene.updateMatrixWorld();
    this.camera = gltf.cameras.find((camera) => camera.name === 'main');
    if (this.kind.map) {
      const map = await new HDRLoader().setDataType(THREE.FloatType).loadAsync(this.kind.map);
      this.sun = splitKeyLights(map, { order: ORDER });
      this.sun.lights = new KeyLights(this.sun.suns).fit(new THREE.Box3().setFromObject(gltf.scene), gltf.scene);
      this.scene.add(this.sun.lights);
      map.dispose();
    }
    this.frame.prepend(canvas);
    new ResizeObserver(() => this.change()).observe(canvas);
    this.draw();
    this.figure.classList.add('shown');
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement, { sides } = this.kind;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    const at = sides.length > 1 ? Math.round((width * this.slider.valueAsNumber) / 100) : width;
    sides.forEach((side, i) => {
      const [first, last] = i === 0 ? [0, at] : [at, width];
      if (first === last) return;
      side.set(this.baked, this.turn.valueAsNumber * DEGREE, this.slider.valueAsNumber, this.sun);
      this.scene.updateMatrixWorld();
      this.baked.update();
      this.renderer.setScissor(first, 0, last - first, height);
      this.renderer.render(this.scene, this.camera);
    });
  }
}

const pictures = new Map();
const seen = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    const picture = pictures.get(target);
    if (!isIntersecting || picture.loaded) continue;
    picture.loaded = picture.load().catch((error) => {
      // The still picture stays.
      target.append(make('p', { className: 'failed', textContent: `This picture is not live here: ${error.message}` }));
    });
  }
}, { rootMargin: '300px' });
for (const figure of document.querySelectorAll('figure.live')) {
  pictures.set(figure, new LivePicture(figure));
  seen.observe(figure);
}
window.lambentLive = { loaded: (figure) => pictures.get(figure).loaded };
