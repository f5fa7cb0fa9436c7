// Writes a glTF scene of a ball that moves and a box that turns before a wall: three rigid groups. Usage:
// node moving_scene.js OUT.gltf
import { accessor, box, primitive, sheet, sphere, writeScene } from './gltf_writer.js';

const matte = (color) => (
  { pbrMetallicRoughness: { baseColorFactor: [...color, 1], metallicFactor: 0, roughnessFactor: 1 } });
const meshes = [
  primitive([sheet([0, 0, 0], [0, 0, 1], [1, 0, 0], 16), sheet([0, 0.5, -1], [1, 0, 0], [0, 0.5, 0], 16)], 0),
  primitive([sphere([0, 0, 0], 0.25, 12)], 1),
  primitive(box([0, 0, 0], 0.2), 2),
];
const ball = [-0.3, 0.3, 0.1], turned = [0, Math.sin(0.6), 0, Math.cos(0.6)];
const input = accessor(Float32Array.of(0, 2), 'SCALAR');
const samplers = [
  { input, output: accessor(Float32Array.of(...ball, -0.15, 0.45, -0.3), 'VEC3') },
  { input, output: accessor(Float32Array.of(0, 0, 0, 1, ...turned), 'VEC4') },
];
const channels = ['translation', 'rotation'].map((path, i) => ({ sampler: i, target: { node: i + 1, path } }));
writeScene(process.argv[2], meshes, [matte([0.7, 0.7, 0.65]), matte([0.8, 0.2, 0.1]), matte([0.2, 0.4, 0.7])], {
  placed: [{}, { translation: ball }, { translation: [0.35, 0.25, -0.1] }],
  animations: [{ samplers, channels }],
});
