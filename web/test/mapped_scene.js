// Writes a glTF scene that the samples lack: a floor with a normal map, a box that shines, a double-sided sheet and a
// lamp. Usage: node mapped_scene.js OUT.gltf
import { box, primitive, sheet, view, writeScene } from './gltf_writer.js';
import { crc32, deflateSync } from './png_bytes.js';

// A PNG of normals of waves, 64 x 64.
function normalMap() {
  const size = 64, rows = Buffer.alloc(size * (1 + 3 * size));
  for (let y = 0; y < size; ++y)
    for (let x = 0; x < size; ++x) {
      const n = [0.5 * Math.cos((x * Math.PI) / 8), 0.4 * Math.cos((y * Math.PI) / 16), 1], length = Math.hypot(...n);
      n.forEach((c, k) => (rows[y * (1 + 3 * size) + 1 + 3 * x + k] = Math.round(127.5 * (1 + c / length))));
    }
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]), out = Buffer.alloc(body.length + 8);
    out.writeUInt32BE(data.length, 0);
    body.copy(out, 4);
    out.writeUInt32BE(crc32(body), body.length + 4);
    return out;
  };
  const header = Buffer.alloc(13);
  header.writeUInt32BE(size, 0);
  header.writeUInt32BE(size, 4);
  header.set([8, 2, 0, 0, 0], 8);
  const signature = Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]);
  return Buffer.concat([
    signature, chunk('IHDR', header), chunk('IDAT', deflateSync(rows)), chunk('IEND', Buffer.alloc(0))]);
}

const matte = (color, rest = {}) => ({
  pbrMetallicRoughness: { baseColorFactor: [...color, 1], metallicFactor: 0, roughnessFactor: 1 }, ...rest,
});
const meshes = [
  primitive([sheet([0, 0, 0], [0, 0, 1.5], [1.5, 0, 0], 24)], 0),
  primitive(box([0.3, 0.35, -0.2], 0.3), 1),
  primitive([sheet([-0.6, 0.5, -0.4], [0.3, 0.2, 0.3], [0, 0.4, 0], 12)], 2),
];
const materials = [
  matte([0.7, 0.7, 0.65], { normalTexture: { index: 0, scale: 0.8 } }),
  matte([0.2, 0.5, 0.7], { emissiveFactor: [0.3, 0.1, 0.05] }),
  matte([0.8, 0.3, 0.2], { doubleSided: true }),
];
writeScene(process.argv[2], meshes, materials, {
  nodes: [{
    name: 'lamp', translation: [-0.9, 0.9, 0.6], extensions: { KHR_lights_punctual: { light: 0 } },
  }],
  extensionsUsed: ['KHR_lights_punctual'],
  extensions: { KHR_lights_punctual: { lights: [{ type: 'point', intensity: 3, color: [1, 0.7, 0.4] }] } },
  textures: [{ source: 0 }],
  images: [{ bufferView: view(normalMap()), mimeType: 'image/png' }],
});
