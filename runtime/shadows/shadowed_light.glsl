// Computes unoccluded local lights: E/pi for unit power at a point, exact or with bounded error.
// World axes; `to_light` runs from the point to
// the light's centre, metres.
#include "local_shared.h"

const float kLocalPi = 3.14159265;
const float kLeastDistance = 0.01;      // lower limit on the distance of lights without an extent: keeps
                                        // values finite
const float kLocalNoLength = 1e-36;      // a smaller squared length counts as zero
const float kFarSphere = 64.0;          // in radii: beyond this, the sphere is a flat disc in the sky
const float kFarDisc = 20.0;
const int kDiscCorners = 24;
// The corners' radius gives the regular polygon the unit disc's area: 12 rho^2 sin(15 degrees) = pi.
const float kDiscCorner = 1.005744;
const float kCornerCos = 0.96592583, kCornerSin = 0.25881905;

vec3 localUnit(vec3 v) { return v * inversesqrt(max(dot(v, v), kLocalNoLength)); }

// Returns two unit vectors that are right-handed with unit n [Duff et al., Building an orthonormal basis,
// revisited, 2017].
void localBasis(vec3 n, out vec3 s, out vec3 t) {
  float facing = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (facing + n.z), b = n.x * n.y * a;
  s = vec3(1.0 + facing * n.x * n.x * a, facing * b, -facing * n.x);
  t = vec3(b, facing + n.y * n.y * a, -n.y);
}

// Returns the attenuation of KHR_lights_punctual: by distance and range, and between the cones.
float punctualShare(ShadowedLightRecord light, vec3 to_light) {
  float squared = dot(to_light, to_light);
  float least = max(squared, kLeastDistance * kLeastDistance);
  float share = 1.0 / least;
  if (light.range > 0.0) {
    float ratio = squared / (light.range * light.range);
    share *= clamp(1.0 - ratio * ratio, 0.0, 1.0);
  }
  if (light.kind == kLocalSpot) {
    float along = -dot(light.direction, localUnit(to_light));
    float inside = clamp((along - light.cos_outer) * light.cone_scale, 0.0, 1.0);
    share *= inside * inside;
  }
  return share;
}

// Returns E/(pi L) of a sphere whose centre is h radii away at an angle of this cosine to the normal, also if
// the horizon cuts it [Snyder, Area light sources for real-time graphics, 1996]. Inside the sphere the result
// is 1.
float sphereShare(float cosine, float h) {
  if (h <= 1.0) return 1.0;
  float h2 = h * h, above = cosine * h;  // heights in radii
  if (above >= 1.0) return cosine / h2;
  if (above <= -1.0) return 0.0;
  if (h > kFarSphere) {
    // This is the form for a flat disc cut by a line, accurate to 1/h^2; the exact form would cancel.
    float rest = sqrt(max(1.0 - above * above, 0.0));
    return max(above * acos(-above) + above * above * rest + 2.0 / 3.0 * rest * rest * rest, 0.0) / (kLocalPi * h2 * h);
  }
  float k = sqrt(max(1.0 - above * above, 0.0)), w = sqrt(h2 - 1.0);
  float sine = sqrt(max(1.0 - cosine * cosine, kLocalNoLength));
  float turned = acos(clamp(-cosine * w / sine, -1.0, 1.0));
  return max((cosine * turned - k * w) / h2 + atan(k, w), 0.0) / kLocalPi;
}

// Returns the angle under which the point sees an edge, along the normal of the plane through both.
vec3 edgeTerm(vec3 a, vec3 b) {
  vec3 u = localUnit(a), v = localUnit(b), turn = cross(u, v);
  float sine = length(turn), angle = atan(sine, dot(u, v));
  return sine > 1e-7 ? turn * (angle / sine) : turn;
}

// Returns E/(pi L) of a disc that shines to one side, as a polygon of its area: Lambert's formula, clipped at
// the horizon.
float discShare(vec3 normal, vec3 to_light, vec3 direction, float radius) {
  float facing = -dot(direction, to_light);
  if (facing <= 0.0) return 0.0;
  float squared = dot(to_light, to_light);
  if (squared > kFarDisc * kFarDisc * radius * radius)
    return max(dot(normal, to_light), 0.0) * facing / squared * (radius * radius / squared);
  vec3 s, t;
  localBasis(direction, s, t);
  s *= kDiscCorner * radius;
  t *= kDiscCorner * radius;
  vec2 at = vec2(1.0, 0.0);
  vec3 corner = to_light + s, sum = vec3(0.0), leaving = vec3(0.0), entering = vec3(0.0);
  float height = dot(normal, corner);
  bool cut = false;
  for (int i = 0; i < kDiscCorners; ++i) {
    at = vec2(at.x * kCornerCos - at.y * kCornerSin, at.x * kCornerSin + at.y * kCornerCos);
    vec3 next = to_light + at.x * s + at.y * t;
    float next_height = dot(normal, next);
    if (height > 0.0 && next_height > 0.0) {
      sum += edgeTerm(corner, next);
    } else if (height > 0.0 || next_height > 0.0) {
      cut = true;
      vec3 on_horizon = corner + height / (height - next_height) * (next - corner);
      if (height > 0.0) {
        leaving = on_horizon;
        sum += edgeTerm(corner, on_horizon);
      } else {
        entering = on_horizon;
        sum += edgeTerm(on_horizon, next);
      }
    }
    corner = next;
    height = next_height;
  }
  if (cut) sum += edgeTerm(leaving, entering);
  return clamp(-dot(normal, sum) / (2.0 * kLocalPi), 0.0, 1.0);
}

float localShare(ShadowedLightRecord light, vec3 normal, vec3 to_light) {
  if (light.kind == kLocalDisc) return discShare(normal, to_light, light.direction, light.radius);
  float cosine = dot(normal, localUnit(to_light));
  if (light.kind == kLocalSphere) return sphereShare(cosine, length(to_light) / light.radius);
  return max(cosine, 0.0) * punctualShare(light, to_light) / kLocalPi;
}
