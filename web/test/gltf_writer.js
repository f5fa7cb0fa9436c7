// Writes glTF scenes for tests.
import { writeFileSync } from 'node:fs';

const buffers = [], views = [], accessors = [];

export function view(bytes) {
  const length = buffers.reduce((sum, b) => sum + b.length, 0);
  buffers.push(Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]));
  return views.push({ buffer: 0, byteOffset: length, byteLength: bytes.length }) - 1;
}

export function accessor(array, type) {
  const width = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 }[type], entry = {
    bufferView: view(Buffer.from(array.buffer)), type, count: array.length / width,
    componentType: array instanceof Uint32Array ? 5125 : 5126,
  };
  if (type === 'VEC3' || type === 'SCALAR') {
    const axes = Array.from({ length: width }, (_, k) => [...array].filter((_, i) => i % width === k));
    entry.min = axes.map((axis) => Math.min(...axis));
    entry.max = axes.map((axis) => Math.max(...axis));
  }
  return accessors.push(entry) - 1;
}

// A sheet of n x n cells about a centre, spanned by u and v; its normal is u cross v.
export function sheet(centre, u, v, n) {
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

// A floor and two walls behind it.
export const room = () => [
  sheet([0, 0, 0], [0, 0, 1], [1, 0, 0], 24), sheet([0, 0.5, -1], [1, 0, 0], [0, 0.5, 0], 20),
  sheet([-1, 0.5, 0], [0, 0, -1], [0, 0.5, 0], 20),
];

export const material = (color, metallicFactor, roughnessFactor, rest = {}) => (
  { pbrMetallicRoughness: { baseColorFactor: [...color, 1], metallicFactor, roughnessFactor }, ...rest });

export function primitive(parts, material) {
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

export const box = (c, r) => [
  sheet([c[0], c[1] + r, c[2]], [0, 0, r], [r, 0, 0], 6), sheet([c[0] + r, c[1], c[2]], [0, r, 0], [0, 0, r], 6),
  sheet([c[0] - r, c[1], c[2]], [0, 0, r], [0, r, 0], 6), sheet([c[0], c[1], c[2] + r], [r, 0, 0], [0, r, 0], 6),
  sheet([c[0], c[1], c[2] - r], [0, r, 0], [r, 0, 0], 6), sheet([c[0], c[1] - r, c[2]], [r, 0, 0], [0, 0, r], 6),
];

/** A sphere as a part. */
export function sphere(centre, radius, n) {
  const positions = [], normals = [], uvs = [], indices = [];
  for (let j = 0; j <= n; ++j)
    for (let i = 0; i <= 2 * n; ++i) {
      const theta = (Math.PI * j) / n, phi = (Math.PI * i) / n;
      const normal = [Math.sin(theta) * Math.sin(phi), Math.cos(theta), Math.sin(theta) * Math.cos(phi)];
      positions.push(...normal.map((x, k) => centre[k] + radius * x));
      normals.push(...normal);
      uvs.push(i / (2 * n), j / n);
      if (i === 2 * n || j === n) continue;
      const a = j * (2 * n + 1) + i, b = a + 2 * n + 1;
      if (j > 0) indices.push(a, b, a + 1);
      if (j < n - 1) indices.push(a + 1, b, b + 1);
    }
  return { positions, normals, uvs, indices };
}

/** Writes a scene whose nodes are one mesh of one primitive each, with the properties of `placed`, and other `nodes`. */
export function writeScene(path, meshes, materials, { placed = [], nodes = [], ...rest } = {}) {
  const all = [...meshes.map((_, mesh) => ({ mesh, ...placed[mesh] })), ...nodes], bytes = Buffer.concat(buffers);
  writeFileSync(path, JSON.stringify({
    asset: { version: '2.0' }, scene: 0, scenes: [{ nodes: all.map((_, i) => i) }], nodes: all,
    meshes: meshes.map((one) => ({ primitives: [one] })), materials, ...rest, bufferViews: views, accessors,
    buffers: [{ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString('base64')}` }],
  }));
}
