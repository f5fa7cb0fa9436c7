// The grid around a body in which it changes the light of others (docs/format.md, "neighborhood"): the change of the
// light at its points in bands 0..2, as a picture that receivers look up at their pixels.
import { Matrix3, Matrix4, Vector3 } from 'three';
import { pictureTarget } from './gpu_textures.js';

export const GRID_OUTPUTS = 9;
const uniform = (value) => ({ value });

export class Grid {
  /** A grid that is `whole` has the change of all light, also of that which shines by shadow maps. */
  constructor(json, run, whole) {
    const [x, y, z] = json.size;
    this.run = run;
    this.whole = whole;
    this.size = new Vector3(x, y, z);
    // Slices of z lie one above the other, and the outputs side by side.
    this.target = pictureTarget(GRID_OUTPUTS * x, y * z);
    const low = new Vector3(...json.boundsMin), cell = new Vector3(...json.boundsMax).sub(low);
    cell.divide(new Vector3(x - 1, y - 1, z - 1).max(new Vector3(1, 1, 1)));
    this.pointFromGroup = new Matrix4().makeTranslation(low.x, low.y, low.z)
      .multiply(new Matrix4().makeScale(cell.x, cell.y, cell.z)).invert();
    this.uniforms = {
      picture: uniform(this.target.texture), size: uniform(this.size), pointFromWorld: uniform(new Matrix4()),
      groupFromWorld: uniform(new Matrix3()),
    };
  }

  /** Takes where the body stands. */
  place(worldFromGroup) {
    const groupFromWorld = worldFromGroup.clone().invert();
    this.uniforms.pointFromWorld.value.multiplyMatrices(this.pointFromGroup, groupFromWorld);
    this.uniforms.groupFromWorld.value.setFromMatrix4(groupFromWorld);
  }

  /** Draws the picture from the light at the points. */
  draw(renderer, passes) {
    const { size, run } = this;
    passes.grid(renderer, this.target, { samples: run.target.texture, size, outputs: run.outputs });
  }

  dispose() {
    this.target.dispose();
  }
}

const one = (g) => /* glsl */ `
uniform highp sampler2D lambentGrid${g}Picture;
uniform vec3 lambentGrid${g}Size;
uniform mat4 lambentGrid${g}PointFromWorld;
uniform mat3 lambentGrid${g}GroupFromWorld;
vec3 lambentGrid${g}(vec3 world, vec3 normal) {
  vec3 last = lambentGrid${g}Size - 1.0, place = (lambentGrid${g}PointFromWorld * vec4(world, 1.0)).xyz;
  vec3 t = clamp(min(place, last - place) / min(vec3(1.0), 0.5 * last), 0.0, 1.0), rise = t * t * (3.0 - 2.0 * t);
  float share = rise.x * rise.y * rise.z;
  if (share <= 0.0) return vec3(0.0);
  place = clamp(place, vec3(0.0), last);
  float slice = floor(place.z), part = place.z - slice, next = min(slice + 1.0, last.z);
  vec2 pixels = vec2(textureSize(lambentGrid${g}Picture, 0));
  vec3 l[9];
  for (int o = 0; o < 9; ++o) {
    vec2 at = vec2(float(o) * lambentGrid${g}Size.x, 0.0) + place.xy + 0.5;
    vec3 low = textureLod(lambentGrid${g}Picture, (at + vec2(0.0, slice * lambentGrid${g}Size.y)) / pixels, 0.0).rgb;
    vec3 high = textureLod(lambentGrid${g}Picture, (at + vec2(0.0, next * lambentGrid${g}Size.y)) / pixels, 0.0).rgb;
    l[o] = mix(low, high, part);
  }
  return share * lambentDiffuse(l, normalize(lambentGrid${g}GroupFromWorld * normal));
}
`;

/**
 * Declarations for grids, of which `wholes` says whether they are whole. lambentChanged adds the change to E/π, and
 * takes no more light than there is. Beside light by shadow maps, the change by whole grids is set apart.
 */
export const gridsText = (wholes) => /* glsl */ `
uniform bool lambentKeyed;    // there is light by shadow maps
uniform vec3 lambentKey[9];   // bands of it, group frame
uniform bool lambentGridKept[${wholes.length}]; // captures do not bring the light of the body
${wholes.map((_, g) => one(g)).join('')}
vec3 lambentChanged(vec3 light, vec3 view, vec3 normal, out vec3 whole) {
  vec3 world = (vec4(view - viewMatrix[3].xyz, 0.0) * viewMatrix).xyz, n = (vec4(normal, 0.0) * viewMatrix).xyz;
  vec3 change = vec3(0.0);
  whole = vec3(0.0);
  ${wholes.map((whole, g) => `if (lambentGridKept[${g}])
    ${whole ? 'whole' : 'change'} += lambentGrid${g}(world, n);`).join('\n  ')}
  if (!lambentKeyed) change += whole;
  return max(light + change, min(light, vec3(0.0)));
}
// The share of light that whole grids leave of all that arrives, of which "rest" is without light by shadow maps.
vec3 lambentLeft(vec3 rest, vec3 whole, vec3 normal) {
  return lambentKeyed ? max(1.0 + whole / max(rest + lambentDiffuse(lambentKey, normal), vec3(1e-6)), 0.0) : vec3(1.0);
}
`;

/** Uniforms of a receiver for the grids of other bodies. */
export function gridUniforms(grids) {
  const all = {};
  grids.forEach(({ uniforms }, g) => {
    for (const [name, value] of Object.entries(uniforms))
      all[`lambentGrid${g}${name[0].toUpperCase()}${name.slice(1)}`] = value;
  });
  return all;
}
