// Directional lights of the glTF, which shine as suns do: three's shadow maps bring their direct light, and transfer what
// they bounce.
import { Box3, Color, Sphere, Vector3 } from 'three';
import { fitShadow, takeShadows } from './key_lights.js';
import { LightVector } from './light_vector.js';

const RADIUS = 1e-3; // radians; the light is parallel, and bands know no such small discs
const SIZE = 2048;

export class SceneSuns {
  constructor(lights, root) {
    Object.assign(this, { lights, root, light: null, seen: [] });
    if (lights.length === 0) return;
    this.sphere = new Box3().setFromObject(root).getBoundingSphere(new Sphere());
    takeShadows(root);
    for (const light of lights) {
      light.castShadow = true;
      light.shadow.mapSize.set(SIZE, SIZE);
    }
  }

  /** Takes where the lights shine and how brightly; world matrices must be up to date. Returns whether that changed. */
  follow() {
    const shining = this.lights.filter(({ visible }) => visible);
    const seen = shining.flatMap(({ color, intensity, matrixWorld, target }) =>
      [...color, intensity, ...matrixWorld.elements, ...target.matrixWorld.elements]);
    if (seen.length === this.seen.length && seen.every((value, i) => value === this.seen[i])) return false;
    this.seen = seen;
    this.light = shining.map((light) => {
      fitShadow(light, this.sphere);
      const [from, to] = [light, light.target].map((end) => new Vector3().setFromMatrixPosition(end.matrixWorld));
      const radiance = new Color(light.color).multiplyScalar(light.intensity / (Math.PI * Math.sin(RADIUS) ** 2));
      return LightVector.disc(from.sub(to), RADIUS, radiance);
    }).reduce((sum, one) => (sum ? sum.add(one) : one), null);
    return true;
  }
}
