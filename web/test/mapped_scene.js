// Writes a glTF scene that the samples lack: a floor with a normal map, a box that shines, a double-sided sheet and a
// lamp. Usage: node mapped_scene.js OUT.gltf
import { writeFileSync } from 'node:fs';
import { crc32, deflateSync } from './png_bytes.js';

const buffers = [], views = [], accessors = [];

function view(bytes) {
  const length = buffers.reduce((sum, b) => sum + b.length, 0);
  buffers.push(Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]));
  return views.push({ buffer: 0, byteOffset: length, byteLength: bytes.length }) - 1;
}

function accessor(array, type) {
  const width = { SCALAR: 1, VEC2: 2, VEC3: 3 }[type], entry = {
    bufferView: view(Buffer.from(array.buffer)), type, count: array.length / width,
    componentType: array instanceof Uint32Array ? 5125 : 5126,
  };
  if (type === 'VEC3') {
    const axis = (k) => [...array].filter((_, i) => i % 3 === k);
    entry.min = [0, 1, 2].map((k) => Math.min(...axis(k)));
    entry.max = [0, 1, 2].map((k) => Math.max(...axis(k)));
  }
  return accessors.push(entry) - 1;
}

// A sheet of n x n cells about a centre, spanned by u and v; its normal is u cross v.
function sheet(centre, u, v, n) {
  const positions = [], normals = [], uvs = [], indices = [];
  const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...cross);
  for (let j = 0; j <= n; ++j)
    for (let i = 0; i <= n; ++i) {
      const s = (2 * i) / n - 1, t = (2 * j) / n - 1;
      positions.push(...centre.map((c, k) => c + s * u[k] + t * v[k]));
      normals.push(...cross.map((c) => c / length));
      uvs.push(i / n, 1 - j / n);
      if (i < n && j < n) {
        const a = j * (n + 1) + i, b = a + n + 1;
        indices.push(a, a + 1, b + 1, a, b + 1, b);
      }
    }
  return { positions, normals, uvs, indices };
}

function primitive(parts, material) {
  const all = { positions: [], normals: [], uvs: [], indices: [] };
  for (const part of parts) {
    const first = all.positions.length / 3;
    all.indices.push(...part.indices.map((i) => i + first));
    for (const key of ['positions', 'normals', 'uvs']) all[key].push(...part[key]);
  }
  return {
    attributes: {
      POSITION: accessor(Float32Array.from(all.positions), 'VEC3'),
      NORMAL: accessor(Float32Array.from(all.normals), 'VEC3'),
      TEXCOORD_0: accessor(Float32Array.from(all.uvs), 'VEC2'),
    },
    indices: accessor(Uint32Array.from(all.indices), 'SCALAR'),
    material,
  };
}

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
const box = (c, r) => [
  sheet([c[0], c[1] + r, c[2]], [0, 0, r], [r, 0, 0], 6), sheet([c[0] + r, c[1], c[2]], [0, r, 0], [0, 0, r], 6),
  sheet([c[0] - r, c[1], c[2]], [0, 0, r], [0, r, 0], 6), sheet([c[0], c[1], c[2] + r], [r, 0, 0], [0, r, 0], 6),
  sheet([c[0], c[1], c[2] - r], [0, r, 0], [r, 0, 0], 6), sheet([c[0], c[1] - r, c[2]], [r, 0, 0], [0, 0, r], 6),
];
const scene = {
  asset: { version: '2.0' },
  scene: 0,
  scenes: [{ nodes: [0, 1, 2, 3] }],
  extensionsUsed: ['KHR_lights_punctual'],
  extensions: { KHR_lights_punctual: { lights: [{ type: 'point', intensity: 3, color: [1, 0.7, 0.4] }] } },
  nodes: [
    { mesh: 0, name: 'floor' }, { mesh: 1, name: 'box' }, { mesh: 2, name: 'sheet' },
    { name: 'lamp', translation: [-0.9, 0.9, 0.6], extensions: { KHR_lights_punctual: { light: 0 } } },
  ],
  meshes: [
    { primitives: [primitive([sheet([0, 0, 0], [0, 0, 1.5], [1.5, 0, 0], 24)], 0)] },
    { primitives: [primitive(box([0.3, 0.35, -0.2], 0.3), 1)] },
    { primitives: [primitive([sheet([-0.6, 0.5, -0.4], [0.3, 0.2, 0.3], [0, 0.4, 0], 12)], 2)] },
  ],
  materials: [
    matte([0.7, 0.7, 0.65], { normalTexture: { index: 0, scale: 0.8 } }),
    matte([0.2, 0.5, 0.7], { emissiveFactor: [0.3, 0.1, 0.05] }),
    matte([0.8, 0.3, 0.2], { doubleSided: true }),
  ],
  textures: [{ source: 0 }],
  images: [{ bufferView: view(normalMap()), mimeType: 'image/png' }],
  bufferViews: views,
  accessors,
};
const bytes = Buffer.concat(buffers);
scene.buffers = [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }];
writeFileSync(process.argv[2], JSON.stringify(scene));
