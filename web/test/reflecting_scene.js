// Writes a glTF scene of what reflects: a gold ball, a brushed ball, a lacquered one and a rough dielectric one on a
// lacquered floor, before a matte wall. Usage: node reflecting_scene.js OUT.gltf
import { primitive, sheet, sphere, writeScene } from './gltf_writer.js';

const surface = (color, metallicFactor, roughnessFactor, extensions) => ({
  pbrMetallicRoughness: { baseColorFactor: [...color, 1], metallicFactor, roughnessFactor }, extensions,
});
const materials = [
  surface([0.6, 0.6, 0.55], 0, 1),
  surface([1, 0.77, 0.34], 1, 0.3),
  surface([0.62, 0.61, 0.59], 1, 0.4, { KHR_materials_anisotropy: { anisotropyStrength: 0.8, anisotropyRotation: 0.5 } }),
  surface([0.1, 0.2, 0.6], 0, 0.2),
  surface([0.7, 0.2, 0.1], 0, 0.9, { KHR_materials_specular: { specularFactor: 0.8 }, KHR_materials_ior: { ior: 1.6 } }),
  surface([0.35, 0.25, 0.2], 0, 0.25),
];
const balls = [[-0.75, 1], [-0.25, 2], [0.25, 3], [0.75, 4]].map(([x, material]) =>
  primitive([sphere([x, 0.24, 0.25], 0.22, 16)], material));
writeScene(process.argv[2], [
  primitive([sheet([0, 0.5, -0.6], [1.2, 0, 0], [0, 0.5, 0], 8)], 0), ...balls,
  primitive([sheet([0, 0, 0], [0, 0, 0.6], [1.2, 0, 0], 20)], 5),
], materials, { extensionsUsed: ['KHR_materials_anisotropy', 'KHR_materials_specular', 'KHR_materials_ior'] });
