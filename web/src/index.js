export { LambentPlugin } from './plugin.js';
export { LambentScene } from './scene.js';
export { LightVector, MAX_ORDER } from './light_vector.js';
export { KeyLights, splitKeyLights } from './key_lights.js';
export { loadProgressively } from './progressive.js';
