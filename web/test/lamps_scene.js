// Writes a glTF scene of a room with two lamps: a point that stands still, and a spot in a shade that moves. In it are
// lacquer, gold, and a ball that moves. Usage: node lamps_scene.js OUT.gltf
import { accessor, box, material, primitive, room, sphere, writeScene } from './gltf_writer.js';

const lamp = (light) => ({ extensions: { KHR_lights_punctual: { light } } });
const meshes = [
  primitive(room(), 0),
  primitive(box([-0.5, 0.2, -0.4], 0.2), 1),
  primitive([sphere([0.45, 0.22, -0.45], 0.22, 12)], 2),
  primitive([sphere([0, 0, 0], 0.12, 10)], 3),
  primitive(box([0, 0, 0.1], 0.05), 0),
];
const ball = [0.1, 0.12, 0.1], down = [-Math.SQRT1_2, 0, 0, Math.SQRT1_2];
const input = accessor(Float32Array.of(0, 2), 'SCALAR');
const moves = [[3, ball, [0.1, 0.4, 0.3]], [4, [0.3, 0.9, 0.2], [-0.2, 0.95, 0]]];
writeScene(process.argv[2], meshes, [
  material([0.7, 0.7, 0.65], 0, 1), material([0.5, 0.1, 0.08], 0, 0.35), material([1, 0.78, 0.34], 1, 0.35),
  material([0.3, 0.5, 0.7], 0, 1),
], {
  placed: [{}, {}, {}, { translation: ball }, { translation: moves[1][1], rotation: down, ...lamp(0) }],
  nodes: [{ translation: [-0.4, 0.8, 0.6], ...lamp(1) }],
  animations: [{
    samplers: moves.map(([, from, to]) => ({ input, output: accessor(Float32Array.of(...from, ...to), 'VEC3') })),
    channels: moves.map(([node], sampler) => ({ sampler, target: { node, path: 'translation' } })),
  }],
  extensionsUsed: ['KHR_lights_punctual'],
  extensions: { KHR_lights_punctual: { lights: [
    { type: 'spot', intensity: 2, color: [1, 0.8, 0.5], spot: { innerConeAngle: 0.4, outerConeAngle: 0.9 } },
    { type: 'point', intensity: 0.6, color: [0.6, 0.8, 1], range: 4 },
  ] } },
});
