// Tells whether two boxes placed anywhere overlap, by separating axes of parallelepipeds (Gottschalk, Lin and Manocha
// 1996).
import { Vector3 } from 'three';

function place(low, high, matrix) {
  const corner = (i) => new Vector3(...[0, 1, 2].map((k) => (i & (1 << k) ? high : low)[k])).applyMatrix4(matrix);
  const corners = Array.from({ length: 8 }, (_, i) => corner(i));
  return { corners, edges: [1, 2, 4].map((i) => corners[i].clone().sub(corners[0])) };
}

function apart(a, b, axis) {
  const along = ({ corners }) => corners.map((corner) => corner.dot(axis));
  const atA = along(a), atB = along(b);
  return Math.max(...atA) < Math.min(...atB) || Math.max(...atB) < Math.min(...atA);
}

/** Returns whether boxes from `low` to `high` in their own frames have a point in common. */
export function boxesMeet(lowA, highA, worldFromA, lowB, highB, worldFromB) {
  const a = place(lowA, highA, worldFromA), b = place(lowB, highB, worldFromB);
  const across = (u, v) => new Vector3().crossVectors(u, v), axes = [];
  for (let i = 0; i < 3; ++i) {
    axes.push(across(a.edges[i], a.edges[(i + 1) % 3]), across(b.edges[i], b.edges[(i + 1) % 3]));
    for (const edge of b.edges) axes.push(across(a.edges[i], edge));
  }
  return !axes.some((axis) => apart(a, b, axis));
}
