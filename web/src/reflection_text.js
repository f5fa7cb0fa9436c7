// What shaders of reflecting surfaces share: the kernel of a table of b(v) (runtime/surface/glossy_kernel.glsl
// explains it), bands of light along a direction, and what a mirror sees of the sky.
import { LOBE_LEVELS } from './lobe.js';
import { SEEN_AXES } from './seen_sky.js';

const vec3 = (v) => `vec3(${v.map((x) => x.toFixed(9)).join(', ')})`;

// The light's bands along a direction, by the polynomials of the basis.
const bandsText = (type, name, bands) => /* glsl */ `
void ${name}(vec3 d, ${type} light[${bands * bands}], out ${type} bands[${bands}]) {
  float x = d.x, y = d.y, z = d.z, z2 = z * z, c2 = x * x - y * y, s2 = 2.0 * x * y;
  float c3 = x * c2 - y * s2, s3 = x * s2 + y * c2, c4 = x * c3 - y * s3, s4 = x * s3 + y * c3;
  bands[0] = 0.282094792 * light[0];
  bands[1] = 0.488602512 * (y * light[1] + z * light[2] + x * light[3]);
  bands[2] = 0.546274215 * (s2 * light[4] + c2 * light[8]) + 1.09254843 * z * (y * light[5] + x * light[7]) +
             (0.946174696 * z2 - 0.315391565) * light[6];
  bands[3] = 0.59004359 * (s3 * light[9] + c3 * light[15]) + 1.44530572 * z * (s2 * light[10] + c2 * light[14]) +
             (2.285229 * z2 - 0.457045799) * (y * light[11] + x * light[13]) +
             z * (1.86588166 * z2 - 1.119529) * light[12];
  ${bands > 4 ? `bands[4] = 0.625835735 * (s4 * light[16] + c4 * light[24]) +
             1.77013077 * z * (s3 * light[17] + c3 * light[23]) +
             (3.31161144 * z2 - 0.473087348) * (s2 * light[18] + c2 * light[22]) +
             z * (4.6833258 * z2 - 2.00713963) * (y * light[19] + x * light[21]) +
             ((3.70249414 * z2 - 3.17356641) * z2 + 0.317356641) * light[20];` : ''}
  ${bands > 5 ? `float c5 = x * c4 - y * s4, s5 = x * s4 + y * c4;
  bands[5] = 0.656382057 * (s5 * light[25] + c5 * light[35]) + 2.07566231 * z * (s4 * light[26] + c4 * light[34]) +
             (4.40314469 * z2 - 0.489238299) * (s3 * light[27] + c3 * light[33]) +
             z * (7.19030518 * z2 - 2.39676839) * (s2 * light[28] + c2 * light[32]) +
             ((9.51187968 * z2 - 6.34125312) * z2 + 0.452946651) * (y * light[29] + x * light[31]) +
             z * ((7.36787031 * z2 - 8.18652257) * z2 + 1.75425484) * light[30];` : ''}
}`;

// A direction's frame: the normal, and the view leaning along x.
const FRAME = /* glsl */ `
uniform highp sampler2DArray lambentBrdf;
uniform ivec2 lambentBrdfNodes; // of roughness and strength
uniform highp sampler2D lambentLobes;

// A unit vector at right angles to n [Duff et al. 2017].
vec3 lambentAcross(vec3 n) {
  float facing = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (facing + n.z);
  return vec3(1.0 + facing * n.x * n.x * a, facing * n.x * n.y * a, -facing * n.x);
}
vec3 lambentLeaning(vec3 normal, vec3 direction, vec3 otherwise) {
  vec3 across = direction - dot(normal, direction) * normal;
  float squared = dot(across, across);
  return squared > 1e-8 ? across * inversesqrt(squared) : otherwise;
}
float lambentAngleAxis(float cosine) { return sqrt(max(1.0 - sqrt(max(1.0 - clamp(cosine, 1e-3, 1.0), 0.0)), 0.0)); }
// A texel between nodes; the place runs across and down, from 0 to 1.
vec4 lambentBrdfTexel(vec2 place, int layer) {
  vec2 size = vec2(textureSize(lambentBrdf, 0).xy);
  return textureLod(lambentBrdf, vec3((place * (size - 1.0) + 0.5) / size, float(layer)), 0.0);
}
vec3 lambentBase(vec3 color, float metallic, vec3 rho) {
  return (1.0 - metallic) * max(1.0 - max(rho.r, max(rho.g, rho.b)), 0.0) * color;
}
`;

// What a rough mirror shows of the bands of the sky.
const known = (bands) => /* glsl */ `
uniform highp vec3 lambentKnown[36]; // the light that the environment shows, group frame
${bandsText('vec3', 'lambentKnownBands', bands)}
vec3 lambentKnownAlong(vec3 d, float roughness) {
  vec3 light[${bands * bands}], bands[${bands}];
  for (int k = 0; k < ${bands * bands}; ++k) light[k] = lambentKnown[k];
  lambentKnownBands(d, light, bands);
  float level = ${(LOBE_LEVELS - 1).toFixed(1)} * pow(roughness, 2.0 / 3.0);
  int low = int(min(level, ${(LOBE_LEVELS - 2).toFixed(1)}));
  float part = level - float(low);
  vec4 first = mix(texelFetch(lambentLobes, ivec2(0, low), 0), texelFetch(lambentLobes, ivec2(0, low + 1), 0), part);
  vec4 second = mix(texelFetch(lambentLobes, ivec2(1, low), 0), texelFetch(lambentLobes, ivec2(1, low + 1), 0), part);
  vec3 sum = first.x * bands[0] + first.y * bands[1] + first.z * bands[2] + first.w * bands[3];
  ${bands > 4 ? 'sum += second.x * bands[4];' : ''}
  ${bands > 5 ? 'sum += second.y * bands[5];' : ''}
  return sum;
}`;

// Adds the lobes over the light: the table's weights of zonal functions about axes that turn with the view.
function kernel({ order, lobes, isotropic, axes, perNode }) {
  const measured = lobes === 3, firstWeight = (l) => (isotropic ? (l * (l + 1)) / 2 : l * l);
  const uses = (i, l) => i < (isotropic ? l + 1 : 2 * l + 1);
  const terms = axes.map((axis, i) => {
    const turned = axis.map((x, k) => `${x.toFixed(9)} * ${['tangent', 'bitangent', 'normal'][k]}`).join(' + ');
    const lines = [`lambentLightBands(${turned}, light, bands);`];
    for (let l = 0; l < order; ++l) {
      if (!uses(i, l)) continue;
      const p = firstWeight(l) + i, rgb = `weights[${p}].xyz`;
      if (measured) lines.push(`lobe += vec4(${rgb}, dot(${rgb}, vec3(1.0 / 3.0))) * bands[${l}];`);
      else {
        const [a, b] = p % 2 === 0 ? 'xy' : 'zw';
        lines.push(`f0Light += weights[${p >> 1}].${a} * bands[${l}];`, `f90Light += weights[${p >> 1}].${b} * bands[${l}];`);
      }
    }
    // The first axis is the normal, so the bands weighed by A_l/π give E/π.
    const fourth = order > 4 ? ' - bands[4] / 24.0' : '';
    if (i === 0) lines.push(`vec4 received = bands[0] + 2.0 / 3.0 * bands[1] + 0.25 * bands[2]${fourth};`);
    return lines.join('\n  ');
  });
  const lookUp = isotropic ? /* glsl */ `
  for (int t = 0; t < ${perNode}; ++t) weights[t] = lambentBrdfTexel(vec2(place, roughness), t);` : /* glsl */ `
  vec2 turned = vec2(dot(tangent, along), dot(tangent, cross(normal, along)));
  if (turned.x * turned.y < 0.0) bitangent = -bitangent;
  float azimuth = atan(abs(turned.y), abs(turned.x)) / 1.5707963;
  vec2 nodes = vec2(lambentBrdfNodes - 1), at = vec2(roughness, clamp(strength, 0.0, 1.0)) * nodes;
  vec2 low = min(floor(at), max(nodes - 1.0, 0.0)), part = at - low, high = min(low + 1.0, nodes);
  for (int t = 0; t < ${perNode}; ++t) weights[t] = vec4(0.0);
  for (int corner = 0; corner < 4; ++corner) {
    vec2 side = vec2(float(corner & 1), float(corner >> 1));
    vec2 share = mix(1.0 - part, part, side), node = mix(low, high, side);
    int layer = int(node.y * float(lambentBrdfNodes.x) + node.x + 0.5) * ${perNode};
    for (int t = 0; t < ${perNode}; ++t)
      weights[t] += share.x * share.y * lambentBrdfTexel(vec2(place, azimuth), layer + t);
  }`;
  const sums = measured ? /* glsl */ `
  vec3 rho = weights[0].xyz;
  vec3 mirrored = lobe.rgb + rho * local;` : /* glsl */ `
  vec3 rho = f0 * weights[0].x + f90 * weights[0].y;
  float mean = dot(f0, vec3(1.0 / 3.0));
  float open = mean * weights[0].x + f90 * weights[0].y, seen = mean * f0Light.w + f90 * f90Light.w;
  vec3 mirrored = f0 * f0Light.rgb + f90 * f90Light.rgb;
  diffuse += lambentBase(color, metallic, rho) * (received.rgb + local);
  mirrored += clamp(seen / max(open, 1e-6), 0.0, 1.0) * rho * more;`;
  return /* glsl */ `
${bandsText('vec4', 'lambentLightBands', order)}
// Adds what the surface reflects of the light that arrives. In each w, the visibility is treated as light is. "more" is
// what the bands leave out of the sky, and "local" E/π of lamps.
void lambentReflect(vec3 normal, vec3 along, vec3 eye, float roughness, float strength, vec4 light[${order * order}],
                    vec3 color, float metallic, vec3 f0, float f90, vec3 more, vec3 local, inout vec3 diffuse,
                    inout vec3 specular) {
  vec3 tangent = lambentLeaning(normal, eye, along), bitangent = cross(normal, tangent);
  float place = lambentAngleAxis(dot(normal, eye));
  vec4 weights[${perNode}], bands[${order}];${lookUp}
  ${measured ? 'vec4 lobe = vec4(0.0);' : 'vec4 f0Light = vec4(0.0), f90Light = vec4(0.0);'}
  ${terms.join('\n  ')}${sums}
  specular += mirrored;
}`;
}

// The layer of a smooth dielectric: its directional albedos, and the share of the sky that it sees about a direction.
const layer = ({ isotropic, perNode }) => /* glsl */ `
uniform highp sampler2DArray lambentSeenKernel;
vec2 lambentAlbedoOf(float cosine, float roughness) {
  float place = lambentAngleAxis(cosine);
  ${isotropic ? 'return lambentBrdfTexel(vec2(place, roughness), 0).xy;' : `
  float at = roughness * float(lambentBrdfNodes.x - 1); // without strength, the azimuth does not count
  int low = int(min(at, float(max(lambentBrdfNodes.x - 2, 0))));
  return mix(lambentBrdfTexel(vec2(place, 0.0), low * ${perNode}).xy,
             lambentBrdfTexel(vec2(place, 0.0), min(low + 1, lambentBrdfNodes.x - 1) * ${perNode}).xy,
             at - float(low));`}
}
void lambentSeenBands(vec3 d, float c[25], out float bands[5]) {
  float x = d.x, y = d.y, z = d.z, z2 = z * z, c2 = x * x - y * y, s2 = 2.0 * x * y;
  float c3 = x * c2 - y * s2, s3 = x * s2 + y * c2, c4 = x * c3 - y * s3, s4 = x * s3 + y * c3;
  bands[0] = 0.282094792 * c[0];
  bands[1] = 0.488602512 * (y * c[1] + z * c[2] + x * c[3]);
  bands[2] = 0.546274215 * (s2 * c[4] + c2 * c[8]) + 1.09254843 * z * (y * c[5] + x * c[7]) +
             (0.946174696 * z2 - 0.315391565) * c[6];
  bands[3] = 0.59004359 * (s3 * c[9] + c3 * c[15]) + 1.44530572 * z * (s2 * c[10] + c2 * c[14]) +
             (2.285229 * z2 - 0.457045799) * (y * c[11] + x * c[13]) + z * (1.86588166 * z2 - 1.119529) * c[12];
  bands[4] = 0.625835735 * (s4 * c[16] + c4 * c[24]) + 1.77013077 * z * (s3 * c[17] + c3 * c[23]) +
             (3.31161144 * z2 - 0.473087348) * (s2 * c[18] + c2 * c[22]) +
             z * (4.6833258 * z2 - 2.00713963) * (y * c[19] + x * c[21]) +
             ((3.70249414 * z2 - 3.17356641) * z2 + 0.317356641) * c[20];
}
float lambentSeenShare(float c[25], vec3 direction, vec3 normal, float roughness) {
  const vec3 axes[5] = vec3[5](${SEEN_AXES.map(vec3).join(', ')});
  vec3 tangent = lambentLeaning(normal, direction, lambentAcross(normal));
  mat3 frame = mat3(tangent, cross(normal, tangent), normal);
  vec2 size = vec2(textureSize(lambentSeenKernel, 0).xy);
  vec2 place = (vec2(lambentAngleAxis(dot(normal, direction)), roughness) * (size - 1.0) + 0.5) / size;
  float weights[16];
  for (int i = 0; i < 4; ++i) {
    vec4 four = textureLod(lambentSeenKernel, vec3(place, float(i)), 0.0);
    for (int j = 0; j < 4; ++j) weights[4 * i + j] = four[j];
  }
  float sum = 0.0;
  for (int i = 0; i < 5; ++i) {
    float bands[5];
    lambentSeenBands(frame * axes[i], c, bands);
    for (int l = i; l < 5; ++l) sum += weights[l * (l + 1) / 2 + i] * bands[l];
  }
  return clamp(sum, 0.0, 1.0);
}`;

/** Declarations of a surface with a table: the kernel of glossy ones, the layer of others. */
export const REFLECTION_TEXT = ({ glossy, table }) =>
  FRAME + known(glossy ? table.order : 6) + (glossy ? kernel(table) : layer(table));
