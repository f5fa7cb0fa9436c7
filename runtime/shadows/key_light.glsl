// Computes how much of a key light a point sees, from the light's shadow map. The including shader defines how the map is read: keyDepth(texel) and
// keyBlockers(texel, level). Points and directions are in view space, metres; places on a map are in texels
// of the texture that holds all maps.
#include "key_shared.h"
#include "shadowed_light.glsl"

// A surface casts no shadow if it is nearer to the light than the receiver's plane by less than the width of
// this many texels. This tolerates rounding, and faces that meet within a texel.
const float kKeyBiasTexels = 1.0;
// A surface that only the bias takes for none leaves a doubt if it is above this share of the bias. It is looked for so
// many texels to the side that a steep receiver faces.
const float kDoubtfulBias = 0.25, kTexelsAside = 1.5;
const float kLeastFacing = 0.02;   // least cosine at which the receiver's plane leans
const float kSharpTexels = 0.8;    // texels; a narrower penumbra is unresolved, and the texels' edge is used
const float kOneHeight = 0.1;      // heights count as one if they differ by less than this share
const int kLeastSearch = 20;       // points in the search for blockers; fewer would miss small ones
const int kKeySteps = 3;           // steps of the search along a ray
// A ray that found nothing is looked at again at so many points, from this to this share of the height.
const int kKeyBetween = 5;
const float kLowestBetween = 0.03, kHighestBetween = 0.6;
const float kKeySolid = 1.5;  // height of a body's top over that of a point within it
const int kKeyNarrowing = 3;
const int kRayBlocked = 0, kRayUnsure = 1, kRayFree = 2;

float keyDepth(ivec2 texel);                // 0..1
vec2 keyBlockers(ivec2 texel, int level);   // least and greatest depth, 0..1

struct KeyReceiver {
  vec2 place;
  float depth;  // depth below the map's top, metres
  vec2 slope;   // metres of depth per texel along the receiver's plane
  float bias;
  bool above;   // the whole disc is above the plane
};

KeyReceiver keyReceiver(KeyRecord key, vec3 position, vec3 normal) {
  KeyReceiver receiver;
  receiver.place = vec2(dot(key.right.xyz, position) + key.right.w, dot(key.up.xyz, position) + key.up.w);
  receiver.depth = key.towards.w - dot(key.towards.xyz, position);
  float facing = dot(normal, key.towards.xyz);
  vec2 along = vec2(dot(normal, key.right.xyz), dot(normal, key.up.xyz)) / (key.scale.xy * key.scale.xy);
  receiver.slope = along / max(facing, kLeastFacing);
  receiver.bias = kKeyBiasTexels / min(key.scale.x, key.scale.y) + 1e-6 * key.scale.z;
  receiver.above = facing >= key.radiance.w;
  return receiver;
}

// Returns the texel within bounds that is nearest to a place. Places may lie farther away than integers reach.
ivec2 nearestTexel(vec2 place, vec2 least, vec2 most) { return ivec2(clamp(floor(place), least, most)); }

// Returns the least and greatest depth, in metres, of all that lies within `reach` texels of a place, or
// slightly more.
vec2 blockerBounds(KeyRecord key, vec2 place, vec2 reach) {
  float widest = max(reach.x, reach.y) * 2.0 / float(kBlockerTexels);
  float tile = key.tile.z - key.tile.x + 1.0;
  int last = int(log2(tile / float(kBlockerTexels)) + 0.5);
  int level = clamp(int(ceil(log2(clamp(widest, 1.0, tile)))), 0, last);
  float texels = float(kBlockerTexels << level);
  vec2 least = floor(key.tile.xy / texels), most = floor(key.tile.zw / texels);
  ivec2 from = nearestTexel((place - reach) / texels, least, most);
  ivec2 to = nearestTexel((place + reach) / texels, vec2(from), most);
  vec2 bounds = keyBlockers(from, level);
  for (int i = 1; i < 4; ++i) {
    ivec2 texel = ivec2((i & 1) == 1 ? to.x : from.x, i >> 1 == 1 ? to.y : from.y);
    if (texel == from) continue;
    vec2 other = keyBlockers(texel, level);
    bounds = vec2(min(bounds.x, other.x), max(bounds.y, other.y));
  }
  return key.scale.z * bounds;
}

// Returns how high above the receiver, along the light, the surface at a place is; 0 if it does not block.
float blockerHeight(KeyRecord key, KeyReceiver receiver, vec2 place) {
  ivec2 texel = nearestTexel(place, key.tile.xy, key.tile.zw);
  float depth = key.scale.z * keyDepth(texel);
  float falls = dot(receiver.slope, vec2(texel) + 0.5 - receiver.place);
  // A surface lower than the receiver is no blocker, even where the receiver's plane falls steeply: it may be
  // the floor in front of a grazed wall, or an empty texel at the map's end.
  float limit = receiver.depth + min(falls, 0.0) - receiver.bias;
  return depth < limit ? receiver.depth - depth : 0.0;
}

// Returns the visible and the hidden share of a light without width, interpolated between the four texels around a
// place. A share that no texel has is exactly 0.
vec2 texelShares(KeyRecord key, KeyReceiver receiver, vec2 place) {
  vec2 corner = floor(place - 0.5), part = place - 0.5 - corner;
  vec2 shares = vec2(0.0);
  for (int i = 0; i < 4; ++i) {
    vec2 side = vec2(float(i & 1), float(i >> 1));
    vec2 share = side * part + (1.0 - side) * (1.0 - part);
    bool visible = blockerHeight(key, receiver, corner + side) == 0.0;
    shares[visible ? 0 : 1] += share.x * share.y;
  }
  return shares;
}

// Returns the i-th of `count` points on the unit disc [Vogel 1979].
vec2 keyPoint(int i, int count) {
  float angle = 2.39996323 * float(i);
  return sqrt((float(i) + 0.5) / float(count)) * vec2(cos(angle), sin(angle));
}

// Holds the one or two heights that represent the blockers in the cone from the receiver to the disc, as in
// local_shadow.glsl; 0 if nothing was found. This follows Fernando, Percentage-closer soft shadows, 2005,
// which uses one height.
struct KeyLayers {
  float low, high;
};

// Searches for blockers. `reach` is the greatest height at which they may stand.
KeyLayers keyLayers(KeyRecord key, KeyReceiver receiver, float reach, int count) {
  float found = 0.0;
  vec3 powers = vec3(0.0);  // sums of powers of height
  for (int i = 0; i < count; ++i) {
    // Points are denser towards the receiver's own ray, where low blockers are.
    vec2 at = keyPoint(i, count);
    at *= i == 0 ? 0.0 : length(at) * length(at);
    float height = blockerHeight(key, receiver, receiver.place + reach * key.scale.w * key.scale.xy * at);
    // A blocker counts if it is within the cone at its own height, or at most a texel's width beside it.
    if (height == 0.0 || reach * length(at) * key.scale.w > height * key.scale.w + receiver.bias) continue;
    float relative = height / reach;
    found += 1.0;
    powers += vec3(relative, relative * relative, relative * relative * relative);
  }
  if (found == 0.0) return KeyLayers(0.0, 0.0);
  vec3 moments = powers / found;
  float variance = moments.y - moments.x * moments.x;
  if (variance < kOneHeight * kOneHeight * moments.x * moments.x) return KeyLayers(reach * moments.x, reach * moments.x);
  float deviation = sqrt(variance);
  float third = moments.z - 3.0 * moments.x * moments.y + 2.0 * moments.x * moments.x * moments.x;
  float half_skew = 0.5 * third / (variance * deviation), root = sqrt(1.0 + half_skew * half_skew);
  float low = clamp(moments.x + deviation * (half_skew - root), 0.02 * moments.x, 1.0);
  float high = clamp(moments.x + deviation * (half_skew + root), low, 1.0);
  return KeyLayers(reach * low, reach * high);
}

// Returns what becomes of a ray whose point at this height is free. The map knows tops alone. A body is taken to reach
// down from its top by a third of the top's height above the receiver, so that parapets and walls which light grazes
// block rays that leave through their sides. A ray that comes from under a higher top leaves through an opening or
// through a wall that the light's middle sees edge-on; a map looks the same in both cases.
int rayFromBelow(KeyRecord key, KeyReceiver receiver, float height, vec2 per_metre) {
  int fate = kRayFree;
  for (int i = 0; i < kKeyBetween; ++i) {
    float below = height * (kLowestBetween + (kHighestBetween - kLowestBetween) * float(i) / float(kKeyBetween - 1));
    float found = blockerHeight(key, receiver, receiver.place + below * per_metre);
    if (found <= below) continue;
    if (found < kKeySolid * below) return kRayBlocked;
    fate = kRayUnsure;
  }
  return fate;
}

// Returns what becomes of the ray to a point of the disc. It looks where the ray passes this height, then where it
// passes the height of what it found there.
int rayFate(KeyRecord key, KeyReceiver receiver, float height, vec2 at) {
  vec2 per_metre = key.scale.w * key.scale.xy * at;
  for (int i = 0; i < kKeySteps; ++i) {
    float found = blockerHeight(key, receiver, receiver.place + height * per_metre);
    if (found == 0.0) return rayFromBelow(key, receiver, height, per_metre);
    if (abs(found - height) < kOneHeight * height) return kRayBlocked;
    height = found;
  }
  return kRayBlocked;
}

// Returns the share of visible light that the bias alone may have let through. A ceiling that a cornice touches is as
// near to it as faces of one lit surface are to each other. It is looked for on the side that the receiver faces, where
// the receiver's own surface is lower.
float doubtOfBias(KeyRecord key, KeyReceiver receiver, vec3 normal) {
  vec2 faced = vec2(dot(normal, key.right.xyz), dot(normal, key.up.xyz)) / key.scale.xy;
  KeyReceiver strict = receiver;
  strict.bias *= kDoubtfulBias;
  vec2 sure = texelShares(key, strict, receiver.place + kTexelsAside * faced);
  if (sure.y == 0.0) return 0.0;  // as nearly everywhere
  float visible = texelShares(key, receiver, receiver.place).x;
  return visible > sure.x ? 1.0 - sure.x / visible : 0.0;
}

// Returns keyVisible() without what the bias leaves doubtful.
vec2 visibleBeyondBias(KeyRecord key, KeyReceiver receiver, vec3 normal, vec3 shading_normal) {
  float reach = receiver.depth;
  int rays = int(key.rays);
  KeyLayers layers = KeyLayers(0.0, 0.0);
  bool open = false;
  // Blockers lie in a cone, and the highest surface in it limits how wide the cone must be.
  for (int i = 0; i < kKeyNarrowing; ++i) {
    vec2 bounds = blockerBounds(key, receiver.place, reach * key.scale.w * key.scale.xy + 1.0);
    float lean = dot(abs(receiver.slope), reach * key.scale.w * key.scale.xy + 1.0);
    if (bounds.x >= receiver.depth - receiver.bias) {
      open = true;
      break;
    }
    if (bounds.y < receiver.depth - lean - receiver.bias) return vec2(0.0);
    float lower = receiver.depth - bounds.x;
    if (lower > 0.9 * reach) break;
    reach = lower;
  }
  if (open && receiver.above) return vec2(1.0, 0.0);
  vec3 right = normalize(key.right.xyz), up = normalize(key.up.xyz);
  if (!open) {
    float widest = reach * key.scale.w * max(key.scale.x, key.scale.y);
    if (widest < kSharpTexels && receiver.above) return vec2(texelShares(key, receiver, receiver.place).x, 0.0);
    layers = keyLayers(key, receiver, reach, max(rays, kLeastSearch));
    if (layers.low == 0.0 && receiver.above) return vec2(1.0, 0.0);
    if (layers.high * key.scale.w * max(key.scale.x, key.scale.y) < kSharpTexels && receiver.above)
      return vec2(texelShares(key, receiver, receiver.place).x, 0.0);
  }
  float visible = 0.0, unsure = 0.0, all = 0.0;
  for (int i = 0; i < rays; ++i) {
    vec2 at = keyPoint(i, rays);
    vec3 ray = key.towards.xyz + key.scale.w * (at.x * right + at.y * up);
    float weight = max(dot(shading_normal, ray), 0.0);
    all += weight;
    if (weight <= 0.0 || dot(normal, ray) <= 0.0) continue;
    int fate = kRayFree;
    if (layers.low > 0.0) fate = rayFate(key, receiver, layers.low, at);
    if (fate != kRayBlocked && layers.high > layers.low) fate = min(fate, rayFate(key, receiver, layers.high, at));
    visible += fate == kRayFree ? weight : 0.0;
    unsure += fate == kRayUnsure ? weight : 0.0;
  }
  return all > 0.0 ? vec2(visible, unsure) / all : vec2(0.0);
}

// Returns the share of the disc's light that is visible at a point with this triangle normal and this shading normal,
// and the share of which the map cannot tell.
vec2 keyVisible(KeyRecord key, vec3 position, vec3 normal, vec3 shading_normal) {
  if (dot(normal, key.towards.xyz) <= -key.radiance.w) return vec2(0.0);
  KeyReceiver receiver = keyReceiver(key, position, normal);
  vec2 visible = visibleBeyondBias(key, receiver, normal, shading_normal);
  float doubtful = visible.x > 0.0 ? visible.x * doubtOfBias(key, receiver, normal) : 0.0;
  return vec2(visible.x - doubtful, visible.y + doubtful);
}

// Returns E/pi of the whole disc for radiance 1.
float keyShare(KeyRecord key, vec3 shading_normal) {
  return sphereShare(dot(shading_normal, key.towards.xyz), 1.0 / key.radiance.w);
}
