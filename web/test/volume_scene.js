// Writes a glTF scene of a smoke that scatters forwards, with a box that stands in it, over a floor. Usage:
// node volume_scene.js OUT.gltf, which writes OUT.nrrd too
import { writeFileSync } from 'node:fs';
import { basename } from 'node:path';
import { box, primitive, sheet, writeScene } from './gltf_writer.js';

const size = [40, 24, 36], density = new Float32Array(size[0] * size[1] * size[2]);
for (let k = 0, at = 0; k < size[2]; ++k)
  for (let j = 0; j < size[1]; ++j)
    for (let i = 0; i < size[0]; ++i, ++at) {
      const [x, y, z] = [i, j, k].map((n, axis) => (2 * (n + 0.5)) / size[axis] - 1);
      density[at] = Math.max(0, 1 - Math.hypot(x, y, z) + 0.15 * Math.sin(9 * x) * Math.cos(7 * y + 5 * z));
    }
const out = process.argv[2], file = out.replace(/\.gltf$/, '.nrrd');
writeFileSync(file, Buffer.concat([
  Buffer.from(`NRRD0004\ntype: float\ndimension: 3\nsizes: ${size.join(' ')}\nencoding: raw\nendian: little\n\n`),
  Buffer.from(density.buffer),
]));
const matte = (color) => (
  { pbrMetallicRoughness: { baseColorFactor: [...color, 1], metallicFactor: 0, roughnessFactor: 1 } });
writeScene(out, [
  primitive([sheet([0, 0, 0], [0, 0, 1.2], [1.2, 0, 0], 24)], 0), primitive(box([0.35, 0.3, 0.1], 0.3), 1),
], [matte([0.6, 0.6, 0.55]), matte([0.7, 0.3, 0.2])], {
  nodes: [{
    translation: [0, 0.6, 0],
    extras: { lambent: { volume: {
      file: basename(file), density_scale: 12, albedo: [0.95, 0.9, 0.85], g: 0.4, size: [1.6, 0.9, 1.4],
    } } },
  }],
});
