// Text that is put into three's own shaders. Vertices take the light of their samples (passes.js) and hand it on; the
// pixel replaces the indirect light of three (ambient light, probes, environment) by what transfer brings.
import { PLACE_TEXT } from './gpu_textures.js';
import { gridsText } from './grid.js';
import { lampsBody, lampsText } from './local_text.js';
import { REFLECTION_TEXT } from './reflection_text.js';

// E/π at a normal from light of bands 0..2: Σ A_l/π y_j(n) l'_j, with the constants of docs/conventions.md.
const DIFFUSE_LIGHT = /* glsl */ `
vec3 lambentDiffuse(vec3 l[9], vec3 n) {
  return 0.282095 * l[0] + 0.325735 * (n.y * l[1] + n.z * l[2] + n.x * l[3]) +
         0.273137 * (n.x * n.y * l[4] + n.y * n.z * l[5] + n.x * n.z * l[7]) +
         0.078848 * (3.0 * n.z * n.z - 1.0) * l[6] + 0.136569 * (n.x * n.x - n.y * n.y) * l[8];
}`;

// E/π of an open surface: Σ A_l/π y_i(n) l_i in the bands that a clamped cosine has.
const UNSHADOWED = /* glsl */ `
vec3 lambentUnshadowed(vec3 n) {
  const float weights[8] = float[8](1.0, 2.0 / 3.0, 0.25, 0.0, -1.0 / 24.0, 0.0, 1.0 / 64.0, 0.0);
  vec3 sum = vec3(0.0);
  float c = 1.0, s = 0.0, sectoral = 0.28209479177387814;
  for (int m = 0; m < 7; ++m) {
    if (m > 0) {
      float next = n.x * c - n.y * s;
      s = n.x * s + n.y * c;
      c = next;
      sectoral *= m == 1 ? sqrt(3.0) : sqrt(float(2 * m + 1) / float(2 * m));
    }
    float p = sectoral, before = 0.0;
    for (int l = m; l < 7; ++l) {
      if (l > m) {
        float factor = sqrt(float(4 * l * l - 1) / float(l * l - m * m));
        int k = l - 1;
        float back = k == m ? 0.0 : factor * sqrt(float(k * k - m * m) / float(4 * k * k - 1));
        float next = factor * n.z * p - back * before;
        before = p;
        p = next;
      }
      int centre = l * (l + 1);
      sum += weights[l] * p * (m == 0 ? lambentSky[centre] : c * lambentSky[centre + m] + s * lambentSky[centre - m]);
    }
  }
  return sum;
}
`;

// Reads lists in textures, and the rows of vertices (rows_texture.js).
const VERTEX_LISTS = /* glsl */ `
uniform highp sampler2D lambentSamples;
uniform highp usampler2D lambentEntries;
uniform highp vec3 lambentSky[64];  // the light where nothing is in the way, group frame
uniform bool lambentOpen;           // nothing is in the way of any vertex
uniform mat3 lambentGroupFromNormal;
attribute uvec2 lambentRow;
${PLACE_TEXT}
vec4 lambentSample(int i) { return texelFetch(lambentSamples, lambentPlace(i), 0); }
uvec4 lambentEntry(int i) { return texelFetch(lambentEntries, lambentPlace(i), 0); }
`;

const components = 'xyzw';
const slot = (i) => `vLambent${i >> 2}.${components[i & 3]}`;
const declare = (count) =>
  Array.from({ length: Math.ceil(count / 4) }, (_, i) => `varying vec4 vLambent${i};`).join('\n');

/** Numbers that a vertex hands on: light of `bands` bands (1: E/π), of reflecting surfaces with what sees the sky. */
const lightNumbers = ({ kept, glossy }) => 3 * kept + (glossy ? 9 : 0);
const SEEN_NUMBERS = 25;
const varyingNumbers = (kind) => lightNumbers(kind) + (kind.layered ? SEEN_NUMBERS : 0);

// three's own varyings, with room for a few maps and shadows.
const OTHER_VARYINGS = 8;

/**
 * Completes what a surface is with `kept`, the outputs that vertices hand on. A device with few varyings gets fewer
 * bands of glossy light.
 */
export function fitToDevice(kind, renderer) {
  const gl = renderer.getContext(), most = gl.getParameter(gl.MAX_VARYING_VECTORS) - OTHER_VARYINGS;
  const fits = (kept) => Math.ceil(varyingNumbers({ ...kind, kept }) / 4) <= most;
  let kept = kind.outputs;
  if (kind.glossy) while (kept > 9 && !fits(kept)) kept = (Math.sqrt(kept) - 1) ** 2;
  return { ...kind, kept };
}

const defines = ({ texels, normalWeight }) =>
  (texels ? '#define LAMBENT_TEXELS\n' : '') + (normalWeight ? '#define LAMBENT_NORMAL_WEIGHT\n' : '');

export const vertexDeclarations = (kind) => /* glsl */ `
${defines(kind)}${VERTEX_LISTS}${kind.outputs === 1 ? UNSHADOWED : ''}
${kind.layered ? `uniform highp sampler2D lambentSeen;
vec4 lambentSeenAt(int i) { return texelFetch(lambentSeen, lambentPlace(i), 0); }` : ''}
${declare(varyingNumbers(kind))}
#ifdef LAMBENT_TEXELS
attribute vec2 lambentUv;
varying vec2 vLambentUv;
#endif
#ifdef LAMBENT_NORMAL_WEIGHT
attribute float _normal_weight;
#endif
`;

// Sets l[o] for each output.
function vertexLight({ outputs, kept }) {
  const openLight = outputs === 1
    ? 'l[0] = vec4(lambentUnshadowed(normalize(lambentGroupFromNormal * normal)), 1.0);'
    : `for (int o = 0; o < ${kept}; ++o) l[o] = vec4(lambentSky[o], o == 0 ? 3.5449077 : 0.0);`;
  return /* glsl */ `
  vec4 l[${kept}];
  if (lambentOpen || lambentRow.y == 0u) {
    ${openLight}
  } else if (lambentRow.y == 1u) {
    for (int o = 0; o < ${kept}; ++o) l[o] = lambentSample(int(lambentRow.x) + o);
  } else {
    for (int o = 0; o < ${kept}; ++o) l[o] = vec4(0.0);
    for (uint e = 0u; e < lambentRow.y; ++e) {
      uvec4 one = lambentEntry(int(lambentRow.x + e));
      float weight = uintBitsToFloat(one.y);
      for (int o = 0; o < ${kept}; ++o) l[o] += weight * lambentSample(int(one.x) + o);
    }
  }`;
}

export function vertexBody(kind) {
  const { kept, glossy, layered } = kind, set = [];
  for (let o = 0; o < kept; ++o) for (let c = 0; c < 3; ++c) set.push(`${slot(3 * o + c)} = l[${o}].${'rgb'[c]};`);
  if (glossy) for (let o = 0; o < 9; ++o) set.push(`${slot(3 * kept + o)} = l[${o}].w;`);
  if (layered) {
    const first = lightNumbers(kind);
    for (let i = 0; i < 7; ++i) set.push(`vec4 seen${i} = lambentSeenAt(7 * gl_VertexID + ${i});`);
    for (let k = 0; k < SEEN_NUMBERS; ++k) set.push(`${slot(first + k)} = seen${k >> 2}.${components[k & 3]};`);
  }
  return /* glsl */ `
{${vertexLight(kind)}
  ${set.join('\n  ')}
}
#ifdef LAMBENT_TEXELS
vLambentUv = lambentUv;
#endif
#if defined(LAMBENT_NORMAL_WEIGHT) && !defined(FLAT_SHADED)
vNormal *= _normal_weight;
#endif
`;
}

export const fragmentDeclarations = (kind) => /* glsl */ `
${defines(kind)}${declare(varyingNumbers(kind))}
uniform mat3 lambentGroupFromWorld;
uniform bool lambentOpen;
vec3 lambentToGroup(vec3 view) { return normalize(lambentGroupFromWorld * (vec4(view, 0.0) * viewMatrix).xyz); }
vec3 lambentToView(vec3 group) { return normalize((viewMatrix * vec4(group * lambentGroupFromWorld, 0.0)).xyz); }
${kind.outputs === 9 || kind.grids.length > 0 ? DIFFUSE_LIGHT : ''}
${kind.grids.length > 0 ? gridsText(kind.grids) : ''}
${kind.table ? REFLECTION_TEXT(kind) : ''}
${kind.lamps ? lampsText(hasLobe(kind), kind.spheres) : ''}
#ifdef LAMBENT_TEXELS
varying vec2 vLambentUv;
uniform sampler2D lambentTexels;
#endif
`;

const vec3At = (o) => `vec3(${slot(3 * o)}, ${slot(3 * o + 1)}, ${slot(3 * o + 2)})`;
const listOf = (count, text) => Array.from({ length: count }, (_, i) => text(i)).join(',\n    ');

// Tables of measured BRDFs have no lobe for the highlights of lamps.
const hasLobe = ({ table }) => table?.lobes === 2;
const lamps = (kind) => (kind.lamps ? lampsBody(hasLobe(kind), kind.spheres) : 'vec3 lambentLocal = vec3(0.0);');

// E/π at the pixel, with what bodies nearby change.
const received = (kind) => `${transferred(kind)}
  ${kind.grids.length > 0 ? `vec3 lambentWhole = vec3(0.0);
  if (!lambentOpen) lambentReceived = lambentChanged(lambentReceived, -vViewPosition, normal, lambentWhole);` : ''}`;

// What volumes leave of all light, also of three's suns.
const shaded = ({ grids }) => (grids.includes(true) ? `
  vec3 lambentShade = lambentLeft(lambentReceived + lambentLocal, lambentWhole, lambentToGroup(normal));
  lambentReceived *= lambentShade;
  lambentLocal *= lambentShade;
  reflectedLight.directDiffuse *= lambentShade;` : '');

function transferred({ outputs }) {
  if (outputs === 9) return /* glsl */ `
  vec3 lambentBands[9] = vec3[9](
    ${listOf(9, vec3At)});
  vec3 lambentReceived = lambentDiffuse(lambentBands, lambentToGroup(normal));`;
  return /* glsl */ `
  vec3 lambentReceived = ${vec3At(0)};
  #ifdef LAMBENT_TEXELS
    vec4 lambentTexel = texture2D(lambentTexels, vLambentUv);
    lambentReceived = mix(lambentReceived, lambentTexel.rgb, lambentOpen ? 0.0 : lambentTexel.a);
  #endif`;
}

// Brushed metal reflects a fan of round lobes about the view mirrored in normals that lean along the tangent, by equal
// shares of GGX's slopes (docs/design/glossy.md, "Prefiltered environment").
const FAN = /* glsl */ `
    float lambentNarrow = pow2(lambentRoughness), lambentWide = mix(lambentNarrow, 1.0, pow2(lambentStrength));
    float lambentFan = sqrt(max(pow2(lambentWide) - pow2(lambentNarrow), 0.0));
    if (lambentFan >= 0.05) {
      float roughness = sqrt(sqrt(pow2(lambentNarrow) + pow2(lambentFan / 12.0))), weights = 0.0;
      vec3 sum = vec3(0.0);
      for (int i = 0; i < 12; ++i) {
        float u = (2.0 * float(i) + 1.0) / 12.0 - 1.0;
        vec3 leaning = normalize(lambentNormal + lambentFan * u * inversesqrt(1.0 - u * u) * lambentTangent);
        vec3 mirrored = reflect(-lambentEye, leaning), view = lambentToView(mirrored);
        float weight = max(dot(leaning, lambentEye), 0.0) * step(0.0, dot(mirrored, lambentNormal));
        sum += weight * (getIBLRadiance(view, view, roughness) - lambentKnownAlong(mirrored, roughness));
        weights += weight;
      }
      lambentMore = weights > 0.0 ? sum / weights : vec3(0.0);
    }`;

// Matte surfaces have one albedo; those that reflect are shaded by the table of their BRDF.
function reflected(kind) {
  if (!kind.glossy && !kind.layered) return `${received(kind)}
  ${lamps(kind)}${shaded(kind)}
  irradiance = iblIrradiance = vec3(0.0);
  reflectedLight.indirectDiffuse += diffuseColor.rgb * (lambentReceived + lambentLocal);`;
  const mirror = /* glsl */ `
  vec3 lambentNormal = lambentToGroup(normal), lambentEye = lambentToGroup(geometryViewDir);
  vec3 lambentMirrored = reflect(-lambentEye, lambentNormal), lambentMirroredView = reflect(-geometryViewDir, normal);
  float lambentRoughness = clamp(roughnessFactor, 0.0, 1.0);
  vec3 lambentDielectric = vec3(0.04);
  float lambentSpecular = 1.0;
  #ifdef IOR
    lambentDielectric = vec3(pow2((ior - 1.0) / (ior + 1.0)));
    #ifdef USE_SPECULAR
      lambentSpecular = specularIntensity;
      lambentDielectric *= specularColor;
      #ifdef USE_SPECULAR_COLORMAP
        lambentDielectric *= texture2D(specularColorMap, vSpecularColorMapUv).rgb;
      #endif
      #ifdef USE_SPECULAR_INTENSITYMAP
        lambentSpecular *= texture2D(specularIntensityMap, vSpecularIntensityMapUv).a;
      #endif
    #endif
  #endif
  vec3 lambentF0 = mix(min(lambentDielectric, vec3(1.0)) * lambentSpecular, diffuseColor.rgb, metalnessFactor);
  float lambentF90 = mix(lambentSpecular, 1.0, metalnessFactor);
  vec3 lambentTangent = lambentAcross(lambentNormal);
  float lambentStrength = 0.0;
  #ifdef USE_ANISOTROPY
    lambentStrength = material.anisotropy;
    ${kind.framed ? `vec3 lambentAlong = material.anisotropyT - dot(material.anisotropyT, normal) * normal;
    if (dot(lambentAlong, lambentAlong) > 1e-12) lambentTangent = lambentToGroup(lambentAlong);`
    : `vec2 lambentDirection = normalize(anisotropyVector);
    lambentTangent = lambentDirection.x * lambentTangent + lambentDirection.y * cross(lambentNormal, lambentTangent);`}
  #endif
  irradiance = iblIrradiance = radiance = vec3(0.0);
  ${lamps(kind)}
  ${kind.lamps && hasLobe(kind) ? 'reflectedLight.indirectSpecular += lambentHighlights;' : ''}`;
  // Where there is an environment, mirrors show it; bands alone know the sky otherwise.
  const sky = /* glsl */ `
  vec3 lambentKnownSky = lambentKnownAlong(lambentMirrored, lambentRoughness);
  vec3 lambentMore = vec3(0.0); // what the bands leave out
  #ifdef USE_ENVMAP
    lambentMore = getIBLRadiance(lambentMirroredView, lambentMirroredView, lambentRoughness) - lambentKnownSky;
    ${kind.glossy && !kind.table.isotropic ? FAN : ''}
  #endif`;
  if (kind.layered) return `${received(kind)}${mirror}${shaded(kind)}${sky}
  float lambentSeenNumbers[25] = float[25](
    ${listOf(SEEN_NUMBERS, (k) => slot(lightNumbers(kind) + k))});
  vec2 lambentAlbedo = lambentAlbedoOf(dot(lambentNormal, lambentEye), lambentRoughness);
  vec3 lambentRho = lambentF0 * lambentAlbedo.x + lambentF90 * lambentAlbedo.y;
  // What hides the sky has the mean radiance of E/π without what the sky sends, over the share that is hidden.
  vec3 lambentSide = normalize(vec3(lambentSeenNumbers[3], lambentSeenNumbers[1], lambentSeenNumbers[2]));
  float lambentOpenShare = clamp(3.5449077 * lambentSeenNumbers[0], 0.0, 1.0);
  vec3 lambentFromSky = lambentOpenShare * lambentKnownAlong(lambentSide, 1.0);
  vec3 lambentHidden = max(lambentReceived - lambentFromSky, 0.1 * lambentReceived) / max(1.0 - lambentOpenShare, 0.05);
  float lambentShare = lambentSeenShare(
    lambentSeenNumbers, lambentMirrored, lambentToGroup(nonPerturbedNormal), lambentRoughness);
  reflectedLight.indirectSpecular +=
    lambentRho * mix(max(lambentHidden, vec3(0.0)), lambentKnownSky + lambentMore, lambentShare);
  reflectedLight.indirectDiffuse += lambentBase(diffuseColor.rgb, metalnessFactor, lambentRho) *
    (lambentReceived + lambentLocal);`;
  const bands = kind.kept, all = kind.table.order ** 2;
  return `${mirror}${sky}
  vec4 lambentLight[${all}] = vec4[${all}](
    ${listOf(all, (o) => (o < bands ? `vec4(${vec3At(o)}, ${o < 9 ? slot(3 * bands + o) : '0.0'})` : 'vec4(0.0)'))});
  lambentReflect(lambentNormal, lambentTangent, lambentEye, lambentRoughness, lambentStrength, lambentLight,
    diffuseColor.rgb, metalnessFactor, lambentF0, lambentF90, lambentMore, lambentLocal, reflectedLight.indirectDiffuse,
    reflectedLight.indirectSpecular);`;
}

/** Goes behind three's own collection of indirect light. */
export const fragmentLight = (kind) => `{${reflected(kind)}
}`;
