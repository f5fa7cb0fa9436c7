// Writes a glTF scene of a room that two bulbs of one material light. In it are lacquer, gold, brushed steel, and a ball
// that moves. Usage: node bulbs_scene.js OUT.gltf
import { accessor, box, material, primitive, room, sphere, writeScene } from './gltf_writer.js';

const meshes = [
  primitive(room(), 0),
  primitive(box([-0.5, 0.2, -0.4], 0.2), 1),
  primitive([sphere([0.45, 0.22, -0.45], 0.22, 12)], 2),
  primitive([sphere([-0.3, 0.16, 0.4], 0.16, 12)], 3),
  primitive([sphere([-0.75, 0.5, 0.2], 0.12, 12), sphere([0.2, 0.8, 0.2], 0.08, 12)], 4),
  primitive([sphere([0, 0, 0], 0.12, 10)], 5),
];
const ball = [0.1, 0.12, 0.1], input = accessor(Float32Array.of(0, 2), 'SCALAR');
const output = accessor(Float32Array.of(...ball, 0.3, 0.4, 0.3), 'VEC3');
writeScene(process.argv[2], meshes, [
  material([0.7, 0.7, 0.65], 0, 1), material([0.5, 0.1, 0.08], 0, 0.2), material([1, 0.78, 0.34], 1, 0.35),
  material([0.6, 0.6, 0.6], 1, 0.3, { extensions: { KHR_materials_anisotropy: { anisotropyStrength: 0.7 } } }),
  material([0.1, 0.1, 0.1], 0, 1, {
    emissiveFactor: [1, 0.7, 0.4], extensions: { KHR_materials_emissive_strength: { emissiveStrength: 8 } },
  }),
  material([0.3, 0.5, 0.7], 0, 1),
], {
  placed: [{}, {}, {}, {}, {}, { translation: ball }],
  animations: [{
    samplers: [{ input, output }], channels: [{ sampler: 0, target: { node: 5, path: 'translation' } }],
  }],
  extensionsUsed: ['KHR_materials_anisotropy', 'KHR_materials_emissive_strength'],
});
