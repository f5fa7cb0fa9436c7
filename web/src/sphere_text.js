// Light of spheres by their shadow cubes, per pixel, with penumbrae: the text of runtime/shadows/shadowed_light.glsl and
// local_shadow.glsl for them, which explain it. It goes behind POINT_TEXT of local_text.js.
import { MOST_CUBES } from './local_lights.js';

const POINTS = 16; // sample points on a sphere's disc
const GOLDEN_ANGLE = 2.39996323;

// The i-th point on a line [van der Corput 1935].
function linePoint(i) {
  let sum = 0;
  for (let share = 0.5; i > 0; i >>= 1, share /= 2) sum += share * (i & 1);
  return sum;
}

// A constant of a number for each sample point.
const list = (name, at) => `const float ${name}[${POINTS}] = float[${POINTS}](${
  Array.from({ length: POINTS }, (_, i) => at(i).toFixed(8)).join(', ')});`;

export const SPHERE_TEXT = /* glsl */ `
uniform float lambentLampRadii[${MOST_CUBES}]; // 0: a light without an extent

// E/(π L) of a sphere whose centre is h radii away at an angle of this cosine to the normal [Snyder 1996].
float lambentSphereShare(float cosine, float h) {
  if (h <= 1.0) return 1.0;
  float h2 = h * h, above = cosine * h;
  if (above >= 1.0) return cosine / h2;
  if (above <= -1.0) return 0.0;
  if (h > 64.0) { // a flat disc cut by a line
    float rest = sqrt(max(1.0 - above * above, 0.0)), disc = above * acos(-above) + above * above * rest;
    return max(disc + 2.0 / 3.0 * rest * rest * rest, 0.0) / (3.14159265 * h2 * h);
  }
  float k = sqrt(max(1.0 - above * above, 0.0)), w = sqrt(h2 - 1.0), sine = sqrt(max(1.0 - cosine * cosine, 1e-36));
  float turned = acos(clamp(-cosine * w / sine, -1.0, 1.0));
  return max((cosine * turned - k * w) / h2 + atan(k, w), 0.0) / 3.14159265;
}

// A pixel as a sphere sees it, whose disc looks like the sphere from there. Places are relative to the centre.
struct LambentReceiver {
  int lamp;
  vec3 place, plane, horizon;
  float metres;
  vec3 towards, s, t; // from the centre to the place, and along the disc
  float radius;       // of the disc in which the tangent cone meets the plane through the centre
};
LambentReceiver lambentReceiver(int lamp, vec3 place, vec3 plane, vec3 horizon) {
  vec3 n = lambentUnit(place);
  float metres = length(place), facing = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (facing + n.z), b = n.x * n.y * a;
  vec3 s = vec3(1.0 + facing * n.x * n.x * a, facing * b, -facing * n.x), t = vec3(b, facing + n.y * n.y * a, -n.y);
  float radius = lambentLampRadii[lamp], sine = min(radius / metres, 0.99);
  return LambentReceiver(lamp, place, plane, horizon, metres, n, s, t, radius * inversesqrt(1.0 - sine * sine));
}
vec3 lambentAlong(LambentReceiver at, vec2 place) { return place.x * at.s + place.y * at.t; }

// Returns how far up from the disc (0) to the pixel (1) what stands in this direction is, or a negative number if it is
// not between the pixel and a disc three times as wide.
float lambentBlockerHeight(LambentReceiver at, vec3 direction) {
  vec3 ray;
  float metres = lambentBlocker(at.lamp, direction, ray);
  if (metres >= lambentPlaneDistance(at.place, at.plane, ray) * (1.0 - lambentBias)) return -1.0;
  vec3 place = metres * ray;
  float height = dot(at.towards, place) / at.metres;
  if (height <= 0.0 || height >= 1.0 - lambentBias) return -1.0;
  // The line from the pixel through the blocker is extended to the disc's plane, which magnifies a texel's width.
  float scale = 1.0 / (1.0 - height), reach = 3.0 * at.radius + lambentBias * metres * scale;
  vec3 seen = at.place + scale * (place - at.place);
  return dot(seen, seen) <= reach * reach ? height : -1.0;
}

// Points on the unit disc [Vogel 1979].
${list('lambentDiscRadii', (i) => Math.sqrt((i + 0.5) / POINTS))}
${list('lambentDiscAngles', (i) => GOLDEN_ANGLE * i)}
${list('lambentLinePoints', linePoint)}
vec2 lambentDiscPoint(int i, float turns) {
  float angle = lambentDiscAngles[i] + 2.0 * 3.14159265 * turns;
  return lambentDiscRadii[i] * vec2(cos(angle), sin(angle));
}

// Returns the heights of one or two layers of blockers, which have the first three moments of those that were found; 1
// where nothing blocks.
vec2 lambentBlockerLayers(LambentReceiver at, float turns) {
  float found = 0.0;
  vec3 powers = vec3(0.0);
  for (int i = 0; i < ${POINTS}; ++i) {
    float down = i == 0 ? 0.0 : fract(lambentLinePoints[i] + turns), up = 1.0 - down * sqrt(down);
    vec2 place = 2.0 * at.radius * lambentDiscPoint(i, turns);
    float height = lambentBlockerHeight(at, (1.0 - up) * lambentAlong(at, place) + up * at.place);
    if (height < 0.0) continue;
    found += 1.0;
    powers += vec3(height, height * height, height * height * height);
  }
  if (found == 0.0) return vec2(1.0);
  vec3 moments = powers / found;
  float mean = moments.x, variance = moments.y - mean * mean;
  if (variance < 1e-4) return vec2(mean);
  float deviation = sqrt(variance), third = moments.z - 3.0 * mean * moments.y + 2.0 * mean * mean * mean;
  float halfSkew = 0.5 * third / (variance * deviation), root = sqrt(1.0 + halfSkew * halfSkew);
  return clamp(mean + deviation * (halfSkew + vec2(-root, root)), 0.0, 1.0);
}

// Tells whether the ray from the pixel to a point of the disc is blocked near this height. The search narrows the
// interval in which the ray passes behind something.
bool lambentBlockedNear(float up, LambentReceiver at, vec2 discPlace) {
  float before = 0.0, behind = 1.0, apart = 1.0;
  bool enclosed = false;
  for (int i = 0; i < 4; ++i) {
    // Even sharp shadows fade over a texel.
    float least = lambentBias * 0.5 * at.metres * up / max(1.0 - up, 1e-3);
    vec3 onDisc = lambentAlong(at, max(at.radius, least) * discPlace);
    float height = lambentBlockerHeight(at, (1.0 - up) * onDisc + up * at.place);
    bool found = height >= 0.0;
    if (!found && !enclosed) return false;
    if (found) {
      apart = abs(height - up);
      if (apart < 0.01) return true;
    }
    if (found && height < up) {
      behind = up;
      enclosed = true;
    } else {
      before = up;
    }
    up = height > before && height < behind ? height : 0.5 * (before + behind);
  }
  return enclosed && apart < 2.0 * (behind - before);
}

// How much of a sphere's light arrives: the mean over points on its disc, each weighted with the light that it gives at
// the normal.
float lambentSphereVisible(int lamp, vec3 place, vec3 plane, vec3 horizon, vec3 normal, float turns) {
  LambentReceiver at = lambentReceiver(lamp, place, plane, horizon);
  vec2 layers = lambentBlockerLayers(at, turns);
  int count = layers.x >= 1.0 ? 0 : layers.x < layers.y ? 2 : 1;
  vec2 slope = vec2(dot(horizon, at.s), dot(horizon, at.t));
  if (count == 0 && -dot(horizon, place) > at.radius * length(slope)) return 1.0;
  float visible = 0.0, all = 0.0;
  for (int i = 0; i < ${POINTS}; ++i) {
    vec2 point = lambentDiscPoint(i, turns);
    vec3 ray = lambentAlong(at, at.radius * point) - place;
    float squared = max(dot(ray, ray), 1e-12), weight = max(dot(normal, ray), 0.0) / (squared * squared);
    all += weight;
    if (weight <= 0.0 || dot(horizon, ray) <= 0.0) continue;
    bool blocked = count > 0 && lambentBlockedNear(layers.x, at, point);
    if (!blocked && count > 1) blocked = lambentBlockedNear(layers.y, at, point);
    if (!blocked) visible += weight;
  }
  return all > 0.0 ? visible / all : 1.0;
}

// E/π of a sphere; see lambentLamp.
vec3 lambentSphere(int lamp, vec3 toLight, vec3 plane, vec3 horizon, vec3 normal) {
  float metres = length(toLight), radius = lambentLampRadii[lamp];
  float share = lambentSphereShare(dot(normal, lambentUnit(toLight)), metres / radius);
  vec3 light = share * lambentLampPowers[lamp];
  if (light == vec3(0.0) || metres <= radius) return light;
  // Interleaved gradient noise [Jimenez 2014] turns the points from pixel to pixel.
  float turns = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  return lambentSphereVisible(lamp, -toLight, plane, horizon, normal, turns) * light;
}
`;

// π times the lobe towards the eye of light from a sphere (runtime/surface/ggx_lobes.glsl), whose radius is seen under an
// angle of "spread".
export const SPHERE_LOBE_TEXT = /* glsl */ `
vec3 lambentSphereLobe(vec3 light, LambentMirror mirror, float spread) {
  float alpha = pow2(mirror.roughness);
  if (spread < 0.5 * alpha) return lambentLobe(light, mirror, spread);
  if (mirror.strength == 0.0 && spread > 6.0 * alpha) {
    // Almost a mirror shows the sphere itself. "inside" is the share of the lobe on the sphere's side of its edge.
    float angle = acos(clamp(dot(reflect(-mirror.eye, mirror.normal), light), -1.0, 1.0));
    float beyond = (spread - angle) / max(2.0 * alpha, 2e-3);
    float inside = 0.5 + 0.5 * beyond * inversesqrt(1.0 + beyond * beyond);
    float edge = 1.0 - clamp(dot(mirror.normal, mirror.eye), 0.0, 1.0);
    vec3 fresnel = mirror.f0 + (mirror.f90 - mirror.f0) * pow2(edge * edge) * edge;
    float share = lambentSphereShare(dot(mirror.normal, light), 1.0 / sin(spread));
    return mix(inside * fresnel / max(share, 1e-6), lambentLobe(light, mirror, 0.0), smoothstep(1.2, 2.0, angle / spread));
  }
  // Otherwise it is the mean over points on the sphere's disc, weighted by cosine.
  vec3 s = lambentAcross(light), t = cross(light, s), sum = vec3(0.0);
  float width = tan(min(spread, 1.4)), weights = 0.0;
  for (int i = 0; i < 24; ++i) {
    float angle = ${GOLDEN_ANGLE} * float(i), place = width * sqrt((float(i) + 0.5) / 24.0);
    vec3 towards = normalize(light + place * (cos(angle) * s + sin(angle) * t));
    float weight = max(dot(mirror.normal, towards), 0.0);
    if (weight > 0.0) sum += weight * lambentLobe(towards, mirror, spread * inversesqrt(24.0));
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : vec3(0.0);
}
`;
