// Light of lamps by their shadow cubes, per pixel: the text of runtime/shadows/shadowed_light.glsl and
// local_shadow.glsl for lights without an extent, and with sphere_text.js for spheres. World axes, metres.
import { CUBE_SIZE } from './shadow_cubes.js';
import { MOST_CUBES } from './local_lights.js';
import { SPHERE_LOBE_TEXT, SPHERE_TEXT } from './sphere_text.js';

const POINT_TEXT = /* glsl */ `
uniform highp sampler2D lambentCubes;
uniform vec4 lambentLampPlaces[${MOST_CUBES}]; // and the range; 0: unlimited
uniform vec4 lambentLampAims[${MOST_CUBES}];   // where a spot shines, and the scale of its cone; 0: a point
uniform float lambentLampCones[${MOST_CUBES}]; // cosine of the cone's edge
uniform vec3 lambentLampPowers[${MOST_CUBES}]; // candela, of spheres radiance, on this group

vec3 lambentUnit(vec3 v) { return v * inversesqrt(max(dot(v, v), 1e-36)); }
vec3 lambentFaceForward(int face) {
  float way = (face & 1) == 1 ? -1.0 : 1.0;
  return face < 2 ? vec3(way, 0.0, 0.0) : face < 4 ? vec3(0.0, way, 0.0) : vec3(0.0, 0.0, way);
}
vec3 lambentFaceUp(int face) { return face == 2 || face == 3 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0); }
int lambentFace(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) return d.x < 0.0 ? 1 : 0;
  if (a.y >= a.z) return d.y < 0.0 ? 3 : 2;
  return d.z < 0.0 ? 5 : 4;
}
vec2 lambentFacePlace(int face, vec3 d) {
  vec3 forward = lambentFaceForward(face), up = lambentFaceUp(face);
  vec2 at = vec2(dot(cross(forward, up), d), dot(up, d)) / dot(forward, d);
  return (0.5 * at + 0.5) * ${CUBE_SIZE}.0;
}
vec3 lambentTexelDirection(int face, vec2 place) {
  vec3 forward = lambentFaceForward(face), up = lambentFaceUp(face);
  vec2 at = 2.0 * place / ${CUBE_SIZE}.0 - 1.0;
  return lambentUnit(forward + at.x * cross(forward, up) + at.y * up);
}

// What stands nearer to the receiver than this share of the way, the width of texels, casts no shadow on it.
const float lambentBias = 1.5 * 2.0 / ${CUBE_SIZE}.0;

// Returns how far from the lamp the surface in a direction's texel is, 1e30 if there is none, and the ray of the texel.
float lambentBlocker(int lamp, vec3 towards, out vec3 ray) {
  int face = lambentFace(towards);
  ivec2 texel = clamp(ivec2(floor(lambentFacePlace(face, towards))), ivec2(0), ivec2(${CUBE_SIZE - 1}));
  ray = lambentTexelDirection(face, vec2(texel) + 0.5);
  float metres = texelFetch(lambentCubes, ivec2(face, lamp) * ${CUBE_SIZE} + texel, 0).r;
  return metres == 0.0 ? 1e30 : metres;
}

// Returns how far from the lamp a ray meets the plane of the receiver. A surface that light grazes appears at that
// distance in its own texels.
float lambentPlaneDistance(vec3 place, vec3 plane, vec3 ray) {
  float height = dot(plane, place), along = dot(plane, ray);
  return height * along > 0.0 ? height / along : 1e30;
}

// How much of a lamp a place sees, interpolated between the four texels around the ray. Each is compared with the plane
// of the receiver on its own ray, so a floor that light grazes does not shadow itself.
float lambentLampVisible(int lamp, vec3 place, vec3 plane, vec3 horizon) {
  if (dot(horizon, place) >= 0.0) return 0.0;
  int face = lambentFace(place);
  vec2 at = lambentFacePlace(face, place) - 0.5, corner = floor(at), part = at - corner;
  float metres = length(place), visible = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 side = vec2(float(i & 1), float(i >> 1)), share = side * part + (1.0 - side) * (1.0 - part);
    vec3 ray; // beyond an edge it lies in another face
    float blocker = lambentBlocker(lamp, lambentTexelDirection(face, corner + side + 0.5), ray);
    float limit = min(metres, lambentPlaneDistance(place, plane, ray));
    if (blocker >= limit * (1.0 - lambentBias)) visible += share.x * share.y;
  }
  return visible;
}

// KHR_lights_punctual's share of a lamp's power that falls straight on, over pi.
float lambentLampShare(int lamp, vec3 toLight) {
  vec4 aim = lambentLampAims[lamp];
  float squared = dot(toLight, toLight), range = lambentLampPlaces[lamp].w, share = 1.0 / max(squared, 1e-4);
  if (range > 0.0) share *= clamp(1.0 - pow2(squared / (range * range)), 0.0, 1.0);
  if (aim.w > 0.0)
    share *= pow2(clamp((-dot(aim.xyz, lambentUnit(toLight)) - lambentLampCones[lamp]) * aim.w, 0.0, 1.0));
  return share / 3.14159265;
}

// Returns E/π of a lamp. "plane" is the normal of the triangle, "horizon" that of the vertices, "normal" the pixel's.
vec3 lambentLamp(int lamp, vec3 toLight, vec3 plane, vec3 horizon, vec3 normal) {
  vec3 light = max(dot(normal, lambentUnit(toLight)), 0.0) * lambentLampShare(lamp, toLight) * lambentLampPowers[lamp];
  return light == vec3(0.0) ? light : lambentLampVisible(lamp, -toLight, plane, horizon) * light;
}
`;

// π times the GGX lobe towards the eye of light from a direction (runtime/surface/ggx_lobes.glsl), group frame. A light
// whose radius is seen under an angle of "spread" widens it.
const LOBE_TEXT = /* glsl */ `
struct LambentMirror { vec3 normal, eye, tangent; float roughness, strength; vec3 f0; float f90; };
vec3 lambentLobe(vec3 light, LambentMirror mirror, float spread) {
  vec3 normal = mirror.normal, eye = mirror.eye, tangent = mirror.tangent;
  float narrow = max(pow2(mirror.roughness), 1e-3), wide = mix(narrow, 1.0, pow2(mirror.strength));
  vec2 widths = sqrt(min(vec2(wide * wide, narrow * narrow) + 0.25 * spread * spread, 1.0));
  vec3 alpha = vec3(widths, 1.0), h = normalize(eye + light), across = cross(normal, tangent);
  float nv = max(dot(normal, eye), 1e-3), nl = max(dot(normal, light), 1e-3);
  vec3 slopes = vec3(dot(tangent, h), dot(across, h), clamp(dot(normal, h), 0.0, 1.0)) / alpha;
  float root = dot(slopes, slopes);
  float viewWidth = length(alpha * vec3(dot(tangent, eye), dot(across, eye), nv));
  float lightWidth = length(alpha * vec3(dot(tangent, light), dot(across, light), nl));
  float distribution = 1.0 / (alpha.x * alpha.y * root * root), shadowing = 0.5 / (nl * viewWidth + nv * lightWidth);
  float edge = 1.0 - clamp(dot(eye, h), 0.0, 1.0);
  return distribution * shadowing * (mirror.f0 + (mirror.f90 - mirror.f0) * pow2(edge * edge) * edge);
}
`;

/** Declarations of a surface on which lamps shine; where it has a `lobe`, it mirrors them. */
export const lampsText = (lobe, spheres) =>
  POINT_TEXT + (spheres ? SPHERE_TEXT : '') + (lobe ? LOBE_TEXT : '') + (lobe && spheres ? SPHERE_LOBE_TEXT : '');

/**
 * Sets lambentLocal, the E/π of all lamps at the pixel, and where the surface has a `lobe` lambentHighlights, what it
 * mirrors of them.
 */
export const lampsBody = (lobe, spheres) => /* glsl */ `
  vec3 lambentLocal = vec3(0.0), lambentHighlights = vec3(0.0);
  {
    vec3 world = (vec4(-vViewPosition - viewMatrix[3].xyz, 0.0) * viewMatrix).xyz;
    vec3 plane = lambentUnit(cross(dFdx(world), dFdy(world)));
    vec3 horizon = (vec4(nonPerturbedNormal, 0.0) * viewMatrix).xyz, own = (vec4(normal, 0.0) * viewMatrix).xyz;
    ${lobe ? `LambentMirror mirror = LambentMirror(lambentNormal, lambentEye, lambentTangent, lambentRoughness,
      lambentStrength, lambentF0, lambentF90);` : ''}
    for (int k = 0; k < ${MOST_CUBES}; ++k) {
      vec3 toLight = lambentLampPlaces[k].xyz - world, light;
      ${spheres ? `bool wide = lambentLampRadii[k] > 0.0;
      if (wide) light = lambentSphere(k, toLight, plane, horizon, own);
      else` : ''} light = lambentLamp(k, toLight, plane, horizon, own);
      lambentLocal += light;
      ${lobe ? `vec3 direction = normalize(lambentGroupFromWorld * toLight);
      ${spheres ? `if (wide) {
        float spread = atan(lambentLampRadii[k], length(toLight));
        lambentHighlights += light * lambentSphereLobe(direction, mirror, spread);
      } else` : ''} lambentHighlights += light * lambentLobe(direction, mirror, 0.0);` : ''}
    }
  }`;
