// Emissive materials that shine as up to four spheres (docs/format.md). On its own group such a lamp shines by a shadow
// cube for each sphere, in place of the direct part of its column; other groups see it as a part of the body.
import { Vector3 } from 'three';

const BODY = 1.01; // the lamp's body may be larger by this factor

export class SphereLamp {
  /** It is column `index` of `group`, with `spheres` as the bundle has them. */
  constructor(column, spheres) {
    this.column = column;
    this.isNode = false;
    this.shapes = spheres.map(({ center, radius, bodyRadius }) => ({
      lamp: this, center: new Vector3(...center), position: new Vector3(), direction: new Vector3(0, 0, -1),
      range: 0, outerCosine: -1, coneScale: 0, radius, hole: BODY * Math.max(radius, bodyRadius),
    }));
    this.area = spheres.reduce((sum, { radius }) => sum + Math.PI * radius * radius, 0);
  }

  /** Takes where its group is, of the `places` of all, and how it shines; `lamps` are the strengths of columns. */
  follow(lamps, places) {
    const { group, index } = this.column;
    this.power = lamps[group][index];
    for (const { center, position } of this.shapes) position.copy(center).applyMatrix4(places[group]);
  }

  /** What follow() found, as numbers. */
  get state() {
    return [...this.power, ...this.shapes.flatMap(({ position }) => position.toArray())];
  }

  isColumnOf(group) {
    return this.column.group === group;
  }
}

/** Returns the lamps of all groups that shine as spheres. */
export function findSphereLamps(groups) {
  return groups.flatMap(({ lights }, group) => lights.flatMap(({ kind, spheres }, index) =>
    (kind === 'material' && spheres?.length > 0 ? [new SphereLamp({ group, index }, spheres)] : [])));
}
