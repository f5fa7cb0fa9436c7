// Looks up reflection probes. A probe's distances tell where a mirrored ray meets what the probe saw, so the picture has
// parallax wherever the surface is: the ray is followed over the probe's sphere of directions, along which its own
// distance is known in closed form, until it goes behind what the probe sees.
#include "reflection_probes_shared.h"
#include "specular_environment.glsl"

layout(std140, binding = kBindProbes) uniform ProbeBlock { ProbeValues probes; };
#ifdef LAMBENT_LAYERED
layout(binding = kUnitProbesLayered) uniform samplerCubeArray probe_images;
#else
layout(binding = kUnitProbesGlossy) uniform samplerCubeArray probe_images;
#endif

const float kProbeStep = 0.05;          // radians over the probe's sphere
const int kMostProbeSteps = 40, kProbeHalvings = 5;
const float kProbeSame = 0.03;          // distances are equal if they differ by less than this share
const float kProbeOneSurface = 0.7;     // least ratio of 1 / distance on both sides of a hit on one surface
const float kProbeRim = 0.15;           // an edge is where the ray is if their distances differ by less than this share
const float kUnseenTrust = 0.35;        // of a ray that passed through what the probe does not see
const float kEdgeTrust = 0.2;           // of a ray that went behind an edge and was not seen again
const float kProbeEnough = 0.9;
const int kMostAsked = 3;               // probes that a ray asks
const int kProbeLobes = 8;              // parts of a wide lobe
const float kSharpAlpha = 0.03;         // lobes that are narrower are not divided

// Describes a ray as a probe sees it: from the direction `from` it goes to the direction `towards` at infinity, both
// unit vectors, over an angle. `side` is the unit vector across `from` in the plane of both.
struct ProbeRay {
  vec3 from, side;
  float start, angle;  // distance of its start from the probe; radians
};

ProbeRay probeRay(vec3 start, vec3 direction) {
  ProbeRay ray;
  ray.start = max(length(start), 1e-6);
  ray.from = start / ray.start;
  vec3 across = direction - dot(direction, ray.from) * ray.from;
  float sine = length(across);
  ray.side = sine > 1e-4 ? across / sine : perpendicular(ray.from);
  ray.angle = clamp(atan(sine, dot(direction, ray.from)), 1e-3, 3.1405);
  return ray;
}
vec3 probeDirection(ProbeRay ray, float turned) { return cos(turned) * ray.from + sin(turned) * ray.side; }
// Returns 1 / distance from the probe, by the law of sines.
float probeInverse(ProbeRay ray, float turned) { return sin(ray.angle - turned) / (ray.start * sin(ray.angle)); }
float probeSees(uint probe, vec3 direction) {
  return textureLod(probe_images, vec4(direction, probes.counts.x + float(probe)), 0.0).r;
}

// Says where a probe saw what a ray meets.
struct ProbeHit {
  float turned;  // over the probe's sphere
  float trust;   // 0..1
};

// Returns where a ray left the room through a hole whose rims the probe sees at two places of the arc, with 1 / distance:
// the hole is taken to be flat.
float throughHole(ProbeRay ray, vec2 rim, vec2 other) {
  vec2 low = rim, high = other;
  for (int k = 0; k < kProbeHalvings; ++k) {
    vec2 middle = 0.5 * (low + high);
    if (probeInverse(ray, middle.x) > middle.y) low = middle;
    else high = middle;
  }
  return high.x;
}

ProbeHit followRay(uint probe, ProbeRay ray) {
  int steps = clamp(int(ceil(ray.angle / kProbeStep)), 2, kMostProbeSteps);
  float rim = 1.5 * 1.5708 / float(textureSize(probe_images, 0).x);  // beside an edge, which filtering blurs
  vec2 solid = vec2(0.0, probeSees(probe, ray.from));  // place on the arc and 1 / distance of what was seen last
  bool hidden = false;
  float trust = 1.0, before = 0.0;
  ProbeHit edge = ProbeHit(ray.angle, 0.0);
  for (int i = 1; i <= steps; ++i) {
    float turned = ray.angle * float(i) / float(steps);
    float seen = probeSees(probe, probeDirection(ray, turned));
    bool behind = seen * (1.0 - 0.25 * kProbeSame) > probeInverse(ray, turned);
    if (!behind) {
      hidden = false;
      before = turned;
      if (seen > 0.0) solid = vec2(turned, seen);
      continue;
    }
    if (hidden) continue;
    float low = before, high = turned;
    for (int k = 0; k < kProbeHalvings; ++k) {
      float middle = 0.5 * (low + high);
      if (probeSees(probe, probeDirection(ray, middle)) * (1.0 - 0.25 * kProbeSame) > probeInverse(ray, middle)) high = middle;
      else low = middle;
    }
    float near_side = probeSees(probe, probeDirection(ray, max(high - rim, 0.0)));
    float far_side = probeSees(probe, probeDirection(ray, high + rim));
    if (near_side > kProbeOneSurface * far_side) return ProbeHit(high, trust);
    if (probeInverse(ray, min(high + rim, ray.angle)) > (1.0 - kProbeRim) * far_side) {
      // The rim of something is as far away as the ray. Beside the sky it is the rim of a hole.
      if (near_side > 0.1 * far_side) return ProbeHit(high, trust);
      return ProbeHit(throughHole(ray, solid, vec2(high + rim, far_side)), trust);
    }
    // The ray passes behind something nearer.
    if (edge.trust == 0.0) edge = ProbeHit(high, kEdgeTrust * trust);
    trust = min(trust, kUnseenTrust);
    hidden = true;
  }
  // A ray that the probe has seen all the way leaves for the sky. One that it lost may have met anything.
  return hidden || trust < 1.0 ? edge : ProbeHit(ray.angle, 1.0);
}

// Lists the probes that a place asks, the nearest first: of those that see this side of its surface.
struct ProbeOrder {
  uint probe[kMostAsked];
  int count;
};

ProbeOrder probesFor(vec3 place_ws, vec3 normal_ws) {
  ProbeOrder order;
  order.count = 0;
  uint taken = 0u;
  for (int n = 0; n < kMostAsked; ++n) {
    float least = 1e30;
    order.probe[n] = 0u;
    for (uint i = 0u; i < uint(probes.counts.x); ++i) {
      if (probes.places[i].w == 0.0 || (taken >> i & 1u) != 0u) continue;
      vec3 from = place_ws - probes.places[i].xyz;
      float apart = length(from);
      bool hidden = dot(from, normal_ws) > 0.0 || probeSees(i, from) * apart > 1.0 + 2.0 * kProbeSame;
      if (hidden || apart >= least) continue;
      least = apart;
      order.probe[n] = i;
    }
    if (least == 1e30) break;
    taken |= 1u << order.probe[n];
    ++order.count;
  }
  return order;
}

// Returns what a lobe about a direction shows at a place, times how much that may be trusted, which is in w.
vec4 probeLobe(ProbeOrder order, vec3 place_ws, vec3 direction_ws, float roughness) {
  vec3 sum = vec3(0.0), sky = reflectedSky(direction_ws, roughness);
  float left = 1.0, alpha = roughness * roughness;
  for (int n = 0; n < order.count && left > 1.0 - kProbeEnough; ++n) {
    uint probe = order.probe[n];
    ProbeRay ray = probeRay(place_ws - probes.places[probe].xyz, direction_ws);
    ProbeHit hit = followRay(probe, ray);
    if (hit.trust <= 0.0) continue;
    // What the lobe covers at the hit looks from the probe as wide as its way from the mirror is longer than its way
    // from the probe, by the law of sines.
    float wider = hit.turned < ray.angle ? sin(hit.turned) / max(sin(ray.angle), 1e-3) : 1.0;
    vec4 seen = textureLod(probe_images, vec4(probeDirection(ray, hit.turned), float(probe)), levelOf(sqrt(min(alpha * wider, 1.0))));
    sum += left * hit.trust * (seen.rgb + (1.0 - clamp(seen.a, 0.0, 1.0)) * sky);
    left *= 1.0 - hit.trust;
  }
  return vec4(sum, 1.0 - left);
}

// Returns a normal of GGX's microfacets as the eye sees them, in a frame whose z is the surface's normal, from two
// numbers in 0..1 [Heitz, Sampling the GGX distribution of visible normals, 2018].
vec3 visibleNormal(vec3 to_eye, float alpha, vec2 at) {
  vec3 stretched = normalize(vec3(alpha * to_eye.xy, to_eye.z));
  float squared = dot(stretched.xy, stretched.xy);
  vec3 s = squared > 0.0 ? vec3(-stretched.y, stretched.x, 0.0) * inversesqrt(squared) : vec3(1.0, 0.0, 0.0), t = cross(stretched, s);
  float r = sqrt(at.x), phi = 6.28318531 * at.y, x = r * cos(phi), y = r * sin(phi), half_way = 0.5 * (1.0 + stretched.z);
  y = mix(sqrt(max(1.0 - x * x, 0.0)), y, half_way);
  vec3 n = x * s + y * t + sqrt(max(1.0 - x * x - y * y, 0.0)) * stretched;
  return normalize(vec3(alpha * n.xy, max(n.z, 1e-4)));
}

// Returns what the mirror of this pixel shows at a place, times how much that may be trusted, which is in w. The normal
// is that of the surface, on its visible side. A wide lobe is divided among narrower ones, each with a hit of its own,
// because beside what the middle meets lies something else.
vec4 probeMirror(vec3 place_ws, vec3 normal, mat3 group_from_world) {
  float alpha = pixel_lobes.roughness * pixel_lobes.roughness;
  ProbeOrder order = probesFor(place_ws, normal * group_from_world);
  if (alpha < kSharpAlpha)
    return probeLobe(order, place_ws, reflect(-pixel_to_eye, pixel_normal) * group_from_world, pixel_lobes.roughness);
  vec3 tangent = perpendicular(pixel_normal);
  mat3 frame = mat3(tangent, cross(pixel_normal, tangent), pixel_normal);
  vec3 to_eye = pixel_to_eye * frame;
  to_eye.z = max(to_eye.z, 1e-3);
  float roughness = sqrt(alpha * inversesqrt(float(kProbeLobes)));
  vec4 sum = vec4(0.0);
  float count = 0.0;
  for (int i = 0; i < kProbeLobes; ++i) {
    vec2 at = vec2((float(i) + 0.5) / float(kProbeLobes), fract(float(i) * 0.61803399));
    vec3 mirrored = reflect(-to_eye, visibleNormal(to_eye, alpha, at));
    if (mirrored.z <= 0.0) continue;
    sum += probeLobe(order, place_ws, (frame * mirrored) * group_from_world, roughness);
    count += 1.0;
  }
  return sum / max(count, 1.0);
}

#ifdef LAMBENT_LAYERED
// Shows the room in the mirror of a layered surface, where a reflection probe knows what the mirrored ray meets, in place
// of the sky where it is seen and a mean elsewhere. Highlights of key lights stay what they are: probes see what key
// lights shine on, but not key lights.
void addLayeredProbes(Mirror mirror, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights) {
  if (probes.counts.y == 0.0) return;
  vec3 place_ws = (draws[draw_of].world_from_mesh * vec4(mirror.position_mesh, 1.0)).xyz;
  vec4 room = probeMirror(place_ws, mirror.smooth_normal, mat3(draws[draw_of].glossy.group_from_world));
  mirrored = room.rgb + (1.0 - room.a) * mirrored;
}
#else
// Shows the room in a sharp metal, where a reflection probe knows what the mirrored ray meets, in place of the few bands
// of transferred light and of what they leave out of the sky. Rough metals keep their bands, which know the room better.
void addGlossyProbes(Reflected reflected, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights) {
  const float kSharp = 0.35, kRough = 0.6;  // roughness
  float share = 1.0 - smoothstep(kSharp, kRough, pixel_lobes.roughness);
  if (probes.counts.y == 0.0 || share == 0.0 || pixel_lobes.anisotropy != 0.0) return;
  vec3 place_ws = (draws[draw_of].world_from_mesh * vec4(position_mesh, 1.0)).xyz;
  vec3 normal = draws[draw_of].facing * unit(normal_group.xyz);
  vec4 room = probeMirror(place_ws, normal, mat3(draws[draw_of].glossy.group_from_world));
  Fresnel fresnel = pixel_lobes.fresnel;
  vec3 rho = fresnel.f0 * reflected.albedo.x + fresnel.f90 * reflected.albedo.y;
  mirrored = mix(mirrored, rho * room.rgb + (1.0 - room.a) * mirrored, share);
}
#endif
