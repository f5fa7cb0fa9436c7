// Text that is put into three's own shaders. It hands on what transfer gives at vertices, and replaces the indirect
// irradiance of three (ambient light, probes, diffuse environment) by E times the surface's own colour.

// E/π at a normal from light of bands 0..2: Σ A_l/π y_j(n) l'_j, with the constants of docs/conventions.md.
const DIFFUSE_LIGHT = /* glsl */ `
vec3 lambentDiffuse(vec3 l[9], vec3 n) {
  return 0.282095 * l[0] + 0.325735 * (n.y * l[1] + n.z * l[2] + n.x * l[3]) +
         0.273137 * (n.x * n.y * l[4] + n.y * n.z * l[5] + n.x * n.z * l[7]) +
         0.078848 * (3.0 * n.z * n.z - 1.0) * l[6] + 0.136569 * (n.x * n.x - n.y * n.y) * l[8];
}`;

const vectors = (word) => Array.from({ length: 7 }, (_, i) => `${word} vec4 lambentLight${i};`).join('\n');
const varyings = vectors('varying').replaceAll('lambentLight', 'vLambentLight');

export const VERTEX_DECLARATIONS = /* glsl */ `
#ifdef LAMBENT_MAPPED
${vectors('attribute')}
${varyings}
#else
attribute vec4 lambentLight;
varying vec4 vLambentLight;
#endif
#ifdef LAMBENT_TEXELS
attribute vec2 lambentUv;
varying vec2 vLambentUv;
#endif
#ifdef LAMBENT_NORMAL_WEIGHT
attribute float _normal_weight;
#endif
`;

export const VERTEX_BODY = /* glsl */ `
#ifdef LAMBENT_MAPPED
${Array.from({ length: 7 }, (_, i) => `vLambentLight${i} = lambentLight${i};`).join('\n')}
#else
vLambentLight = lambentLight;
#endif
#ifdef LAMBENT_TEXELS
vLambentUv = lambentUv;
#endif
#if defined(LAMBENT_NORMAL_WEIGHT) && !defined(FLAT_SHADED)
vNormal *= _normal_weight;
#endif
`;

export const FRAGMENT_DECLARATIONS = /* glsl */ `
#ifdef LAMBENT_MAPPED
${varyings}
uniform mat3 lambentGroupFromWorld;
${DIFFUSE_LIGHT}
#else
varying vec4 vLambentLight;
#endif
#ifdef LAMBENT_TEXELS
varying vec2 vLambentUv;
uniform sampler2D lambentTexels;
#endif
`;

const components = 'xyzw';
const component = (i) => `vLambentLight${i >> 2}.${components[i & 3]}`;
const unpacked = Array.from(
  { length: 9 },
  (_, j) => `vec3(${component(3 * j)}, ${component(3 * j + 1)}, ${component(3 * j + 2)})`,
).join(',\n    ');

// Goes behind three's own collection of indirect light. In mirrors the environment is seen as far as the sky is open
// at the vertex; elsewhere there is light like that around the surface.
export const FRAGMENT_LIGHT = /* glsl */ `
#ifdef LAMBENT_MAPPED
  vec3 lambentBands[9] = vec3[9](
    ${unpacked});
  vec3 lambentNormal = normalize(lambentGroupFromWorld * inverseTransformDirection(normal, viewMatrix));
  vec4 lambentReceived = vec4(lambentDiffuse(lambentBands, lambentNormal), vLambentLight6.w);
#elif defined(LAMBENT_TEXELS)
  vec4 lambentTexel = texture2D(lambentTexels, vLambentUv);
  vec4 lambentReceived = vec4(mix(vLambentLight.rgb, lambentTexel.rgb, lambentTexel.a), vLambentLight.a);
#else
  vec4 lambentReceived = vLambentLight;
#endif
  irradiance = vec3(0.0);
  iblIrradiance = PI * lambentReceived.rgb;
#ifdef RE_IndirectSpecular
  float lambentOpen = clamp(lambentReceived.a, 0.0, 1.0);
  #ifdef USE_ENVMAP
    radiance = mix(max(lambentReceived.rgb, vec3(0.0)), radiance, lambentOpen);
  #else
    radiance = max(lambentReceived.rgb, vec3(0.0));
  #endif
#endif
`;
