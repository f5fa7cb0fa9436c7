// Tells which bodies stand between a light probe and a lamp, by a ray to the lamp through their capture proxies.
import { Matrix4, Ray, Vector3 } from 'three';

/** Tells whether the body, a level of its proxy in its place, hides `lamp` from `point`. */
export function hidesLamp({ proxy, centre, radius }, level, place, point, lamp) {
  const inBody = new Matrix4().copy(place).invert(), from = point.clone().applyMatrix4(inBody);
  const way = lamp.clone().applyMatrix4(inBody).sub(from), length = way.length();
  if (!(length > 0)) return false;
  const ray = new Ray(from, way.divideScalar(length)), along = centre.clone().sub(from).dot(ray.direction);
  const nearest = ray.at(Math.min(Math.max(along, 0), length), new Vector3());
  if (nearest.distanceTo(centre) > radius) return false;
  const { first, count } = proxy.levels[level], [a, b, c, hit] = Array.from({ length: 4 }, () => new Vector3());
  const { positions, triangles } = proxy;
  for (let t = first; t < first + count; ++t) {
    const { corners } = triangles[t];
    [a, b, c].forEach((corner, k) => corner.fromArray(positions, 3 * corners[k]));
    if (ray.intersectTriangle(a, b, c, false, hit) && hit.distanceTo(from) < length * (1 - 1e-3)) return true;
  }
  return false;
}
