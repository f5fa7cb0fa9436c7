// Computes how much of a local light a point sees, from the light's shadow cube. The including shader defines how the cube is read: localDistance(light, face, texel) gives
// metres along the ray through a texel's centre, kNothing where it hits nothing. Points and directions are
// relative to the light's centre, world axes.
#include "shadowed_light.glsl"

const float kNothing = 1e30;
// A surface casts no shadow if it is nearer to the light than the receiver by less than the width of this
// many texels. This tolerates rounding, curved surfaces, and corners of rooms within a texel.
const float kBiasTexels = 1.5;
// Blockers beside the light's cone also tell how high blockers are; few points would miss those at the cone's
// rim.
const float kSearchWidth = 2.0, kFoundWidth = 3.0;  // in multiples of the disc's radius
const float kOneLayer = 0.01;  // share of the way: blockers at most this far apart count as one layer
// The search for what blocks a ray takes this many steps. At its end the ray meets a surface if the blocker is
// as near as the search is fine; where the ray only passes behind an edge, it is farther.
const int kSteps = 4;
const float kMet = 2.0;  // in widths of the interval that is left
const float kLeastSquared = 1e-12;  // square of a micrometre: keeps weights finite
const float kGoldenAngle = 2.39996323;

float localDistance(int light, int face, ivec2 texel);

struct ShadowReceiver {
  vec3 position;
  vec3 normal;      // of the triangle, not the shading normal
  vec3 horizon;     // interpolated, without a normal map; light above it counts, so that the triangles of a
                    // round body do not show where its dark side begins; there the body itself casts the
                    // shadow
  float distance;   // to the light
  float bias;       // as a share of a distance
};

ShadowReceiver shadowReceiver(vec3 position, vec3 normal, vec3 horizon, int size) {
  return ShadowReceiver(position, normal, horizon, length(position), kBiasTexels * 2.0 / float(size));
}

// Returns the face, +X, -X, +Y, -Y, +Z, -Z, each a camera that looks along its axis.
int shadowFace(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) return d.x < 0.0 ? 1 : 0;
  if (a.y >= a.z) return d.y < 0.0 ? 3 : 2;
  return d.z < 0.0 ? 5 : 4;
}
vec3 faceForward(int face) {
  float way = (face & 1) == 1 ? -1.0 : 1.0;
  return face < 2 ? vec3(way, 0.0, 0.0) : face < 4 ? vec3(0.0, way, 0.0) : vec3(0.0, 0.0, way);
}
vec3 faceUp(int face) { return face == 2 || face == 3 ? vec3(0.0, 0.0, 1.0) : vec3(0.0, 1.0, 0.0); }
vec3 faceRight(int face) { return cross(faceForward(face), faceUp(face)); }

// Returns where the direction meets the face, in texels from its lower left corner.
vec2 facePlace(int face, vec3 d, int size) {
  vec2 at = vec2(dot(faceRight(face), d), dot(faceUp(face), d)) / dot(faceForward(face), d);
  return (0.5 * at + 0.5) * float(size);
}
vec3 texelDirection(int face, vec2 place, int size) {
  vec2 at = 2.0 * place / float(size) - 1.0;
  return localUnit(faceForward(face) + at.x * faceRight(face) + at.y * faceUp(face));
}

// Describes the surface in the texel that a direction meets.
struct Blocker {
  vec3 direction;  // through the texel's centre
  float distance;
};
Blocker blockerAt(int light, vec3 direction, int size) {
  int face = shadowFace(direction);
  ivec2 texel = clamp(ivec2(floor(facePlace(face, direction, size))), ivec2(0), ivec2(size - 1));
  return Blocker(texelDirection(face, vec2(texel) + 0.5, size), localDistance(light, face, texel));
}

// Returns the distance from the light at which a ray meets the receiver's plane. A surface that the light
// grazes appears at that distance in its own texels.
float planeDistance(ShadowReceiver receiver, vec3 direction) {
  float plane = dot(receiver.normal, receiver.position), along = dot(receiver.normal, direction);
  return plane * along > 0.0 ? plane / along : kNothing;
}

// Returns the visibility of a light without an extent, interpolated between the four texels around the ray.
float pointVisible(int light, ShadowReceiver receiver, int size) {
  if (dot(receiver.horizon, receiver.position) >= 0.0) return 0.0;
  int face = shadowFace(receiver.position);
  vec2 place = facePlace(face, receiver.position, size) - 0.5;
  vec2 corner = floor(place), part = place - corner;
  float visible = 0.0;
  for (int i = 0; i < 4; ++i) {
    vec2 side = vec2(float(i & 1), float(i >> 1));
    vec2 share = side * part + (1.0 - side) * (1.0 - part);
    // Beyond an edge the direction selects the neighbouring face.
    Blocker blocker = blockerAt(light, texelDirection(face, corner + side + 0.5, size), size);
    // The limit is never farther than the receiver, so that walls beside it do not block.
    float limit = min(receiver.distance, planeDistance(receiver, blocker.direction));
    if (blocker.distance >= limit * (1.0 - receiver.bias)) visible += share.x * share.y;
  }
  return visible;
}

// Describes a flat disc that looks like the light as seen from the receiver.
struct LightDisc {
  vec3 normal;  // unit; the receiver is on its positive side
  float height; // height of the receiver above the disc's plane
  float radius;
  vec3 s, t;    // unit vectors along the disc
};
LightDisc lightDisc(ShadowedLightRecord light, ShadowReceiver receiver) {
  LightDisc disc;
  bool sphere = light.kind == kLocalSphere;
  disc.normal = sphere ? localUnit(receiver.position) : light.direction;
  disc.height = dot(disc.normal, receiver.position);
  float sine = min(light.radius / receiver.distance, 0.99);
  // The tangent cone of the sphere meets the plane through its centre in a larger circle.
  disc.radius = sphere ? light.radius * inversesqrt(1.0 - sine * sine) : light.radius;
  localBasis(disc.normal, disc.s, disc.t);
  return disc;
}

// Returns the i-th of `count` points on the unit disc [Vogel 1979], rotated by `turns` full turns.
vec2 discPoint(int i, int count, float turns) {
  float angle = kGoldenAngle * float(i) + 2.0 * kLocalPi * turns;
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// Returns the i-th point on a line [van der Corput 1935], which is even with respect to discPoint's radius
// and uncorrelated with its angle.
float linePoint(int i) { return float(bitfieldReverse(uint(i))) * 2.3283064e-10; }

// Returns how far up from the disc (0) to the receiver (1) a blocker is, or a negative number if it is not
// between the receiver and a disc of this radius.
float blockerHeight(ShadowReceiver receiver, LightDisc disc, float radius, Blocker blocker) {
  if (blocker.distance >= planeDistance(receiver, blocker.direction) * (1.0 - receiver.bias)) return -1.0;
  vec3 place = blocker.distance * blocker.direction;
  float height = dot(disc.normal, place) / disc.height;
  if (height <= 0.0 || height >= 1.0 - receiver.bias) return -1.0;
  // The line from the receiver through the blocker is extended to the disc's plane, which magnifies a texel's
  // width.
  float scale = 1.0 / (1.0 - height);
  vec3 seen = receiver.position + scale * (place - receiver.position);
  float doubt = receiver.bias * blocker.distance * scale;
  return dot(seen, seen) <= (radius + doubt) * (radius + doubt) ? height : -1.0;
}

// Holds the one or two heights that represent the blockers, found with rays all over the cone and beside it.
// Two heights are those of the two-point distribution with the same first three moments, which is exact for
// two flat blockers.
struct BlockerLayers {
  float low, high;  // equal if there is one; 1: nothing blocks
};
BlockerLayers blockerLayers(int index, ShadowReceiver receiver, LightDisc disc, int size, int count, float turns) {
  float found = 0.0;
  vec3 powers = vec3(0.0);  // sums of powers of height
  for (int i = 0; i < count; ++i) {
    vec2 at = kSearchWidth * disc.radius * discPoint(i, count, turns);
    // One point lies on the receiver's own ray; the others are denser towards the receiver, where penumbras
    // are narrow.
    float down = i == 0 ? 0.0 : fract(linePoint(i) + turns), up = 1.0 - down * sqrt(down);
    vec3 place = (1.0 - up) * (at.x * disc.s + at.y * disc.t) + up * receiver.position;
    float height = blockerHeight(receiver, disc, kFoundWidth * disc.radius, blockerAt(index, place, size));
    if (height < 0.0) continue;
    found += 1.0;
    powers += vec3(height, height * height, height * height * height);
  }
  if (found == 0.0) return BlockerLayers(1.0, 1.0);
  vec3 moments = powers / found;
  float variance = moments.y - moments.x * moments.x;
  if (variance < kOneLayer * kOneLayer) return BlockerLayers(moments.x, moments.x);
  float deviation = sqrt(variance);
  float third = moments.z - 3.0 * moments.x * moments.y + 2.0 * moments.x * moments.x * moments.x;
  float half_skew = 0.5 * third / (variance * deviation), root = sqrt(1.0 + half_skew * half_skew);
  return BlockerLayers(clamp(moments.x + deviation * (half_skew - root), 0.0, 1.0),
                       clamp(moments.x + deviation * (half_skew + root), 0.0, 1.0));
}

// Returns blockerHeight of what stands where the ray from the receiver to a point of the disc passes this
// height.
float heightOnRay(float up, int index, ShadowReceiver receiver, LightDisc disc, vec2 unit_place, int size) {
  // Even sharp shadows fade over a texel.
  float least = receiver.bias * 0.5 * receiver.distance * up / max(1.0 - up, 1e-3);
  vec2 at = max(disc.radius, least) * unit_place;
  vec3 place = (1.0 - up) * (at.x * disc.s + at.y * disc.t) + up * receiver.position;
  // The blocker may lie beside the light's cone, because the ray meets it at another height than this.
  return blockerHeight(receiver, disc, kFoundWidth * disc.radius, blockerAt(index, place, size));
}

// Returns whether that ray is blocked. The search starts at this height and goes on at the height of what it
// found. The light's end of the ray is before all blockers. Once a point of the ray is behind one, the ray meets
// that surface in between, or passed its edge: the interval narrows, so that steep surfaces are found, too.
bool blockedNear(float up, int index, ShadowReceiver receiver, LightDisc disc, vec2 unit_place, int size) {
  float before = 0.0, behind = 1.0, apart = 1.0;
  bool enclosed = false;
  for (int i = 0; i < kSteps; ++i) {
    float height = heightOnRay(up, index, receiver, disc, unit_place, size);
    bool found = height >= 0.0;
    if (!found && !enclosed) return false;
    if (found) {
      apart = abs(height - up);
      if (apart < kOneLayer) return true;
    }
    if (found && height < up) {
      behind = up;
      enclosed = true;
    } else {
      before = up;
    }
    up = height > before && height < behind ? height : 0.5 * (before + behind);
  }
  return enclosed && apart < kMet * (behind - before);
}

// Returns the visibility of a light with an extent: the mean over points on its disc, each weighted with the
// light that it gives at the shading normal. Each point's ray is looked up where it passes the layers of
// blockers; this follows Fernando, Percentage-closer soft shadows, 2005, which has one layer. `turns` differs
// from pixel to pixel.
float discVisible(int index, ShadowedLightRecord light, ShadowReceiver receiver, vec3 shading_normal, int size, int count,
                  float turns) {
  LightDisc disc = lightDisc(light, receiver);
  if (disc.height <= 0.0) return 0.0;
  BlockerLayers layers = blockerLayers(index, receiver, disc, size, count, turns);
  int layer_count = layers.low >= 1.0 ? 0 : layers.low < layers.high ? 2 : 1;
  // No points are needed if nothing was found and all of the disc is above the surface.
  vec2 slope = vec2(dot(receiver.horizon, disc.s), dot(receiver.horizon, disc.t));
  bool above = -dot(receiver.horizon, receiver.position) > disc.radius * length(slope);
  int points = layer_count == 0 && above ? 0 : count;
  float visible = 0.0, all = 0.0;
  for (int i = 0; i < points; ++i) {
    vec2 unit_place = discPoint(i, count, turns), at = disc.radius * unit_place;
    vec3 ray = at.x * disc.s + at.y * disc.t - receiver.position;
    float squared = max(dot(ray, ray), kLeastSquared);
    float weight = max(dot(shading_normal, ray), 0.0) / (squared * squared);
    all += weight;
    if (weight <= 0.0 || dot(receiver.horizon, ray) <= 0.0) continue;
    bool blocked = false;
    for (int k = 0; k < layer_count && !blocked; ++k)
      blocked = blockedNear(k == 0 ? layers.low : layers.high, index, receiver, disc, unit_place, size);
    if (!blocked) visible += weight;
  }
  return all > 0.0 ? visible / all : 1.0;
}

// Returns E/pi of one light at a point, with shadows.
vec3 localRadiance(int index, ShadowedLightRecord light, vec3 position, vec3 normal, vec3 horizon, vec3 shading_normal, int size,
                  int count, float turns) {
  vec3 to_light = light.position - position;
  float share = localShare(light, shading_normal, to_light);
  if (share <= 0.0) return vec3(0.0);
  ShadowReceiver receiver = shadowReceiver(-to_light, normal, horizon, size);
  bool flat_light = light.kind == kLocalPoint || light.kind == kLocalSpot;
  if (light.kind == kLocalSphere && receiver.distance <= light.radius) return share * light.power;
  float visible = flat_light ? pointVisible(index, receiver, size)
                             : discVisible(index, light, receiver, shading_normal, size, count, turns);
  return visible * share * light.power;
}

// Returns interleaved gradient noise [Jimenez, Next generation post processing in Call of Duty: Advanced
// Warfare, 2014].
float pixelTurns(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }
