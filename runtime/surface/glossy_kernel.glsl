// Computes what a glossy surface sends towards a view: the transferred light at its place, weighed by b(v) turned to
// its frame. It holds the mathematics only and no bindings.
// Vectors are unit vectors in the group's frame. The entry shader defines:
//   LAMBENT_BANDS        bands of the transferred light: 4, 5 or 6
//   LAMBENT_ANISOTROPIC  set if the table has azimuths
//   LAMBENT_MEASURED     set for three lobes, red, green and blue; otherwise two, which F0 and F90 multiply
//   LAMBENT_ZONAL_AXES   axes of sh::ZonalFactors, as vec3[](...)
// b turned to the frame is a sum of zonal functions, each about one axis a_i of the local frame turned to the group's
// (runtime/sh/zonal.hpp). A zonal function times the light is the light's band in the direction of its axis:
//   sum_k c_k l'_k = sum_l sum_i w_l,i L_l(a_i),   L_l(a) = sum_m y_lm(a) l'_lm.

const int kBands = LAMBENT_BANDS, kCoefficients = kBands * kBands;
#ifdef LAMBENT_ANISOTROPIC
const int kAxes = 2 * kBands - 1, kWeights = kBands * kBands;
#define LAMBENT_FIRST_WEIGHT(l) ((l) * (l))
#define LAMBENT_AXES_OF(l) (2 * (l) + 1)
#else
const int kAxes = kBands, kWeights = kBands * (kBands + 1) / 2;
#define LAMBENT_FIRST_WEIGHT(l) ((l) * ((l) + 1) / 2)
#define LAMBENT_AXES_OF(l) ((l) + 1)
#endif
#ifdef LAMBENT_MEASURED
const int kTexels = kWeights;
#else
const int kTexels = (kWeights + 1) / 2;
#endif
const vec3 kZonalAxes[] = LAMBENT_ZONAL_AXES;

const float kLeastViewCosine = 1e-3;  // smaller cosines count as this
const float kHalfPi = 1.5707963267948966;

// Returns a texel of the table, interpolated between nodes. `place` runs across and down, counted in nodes.
vec4 brdfTexel(vec2 place, uint layer);
uvec2 brdfNodes();  // counts of nodes across and down

// Evaluates each band of the light in direction d, by the polynomials of docs/conventions.md's functions (bands 0 to
// 5).
void bandsAt(vec3 d, vec4 light[kCoefficients], out vec4 bands[kBands]) {
  float x = d.x, y = d.y, z = d.z, z2 = z * z;
  bands[0] = 0.282094792 * light[0];
  bands[1] = 0.488602512 * (y * light[1] + z * light[2] + x * light[3]);
  float c2 = x * x - y * y, s2 = 2.0 * x * y;
  bands[2] = 0.546274215 * (s2 * light[4] + c2 * light[8]) + 1.09254843 * z * (y * light[5] + x * light[7]) +
             (0.946174696 * z2 - 0.315391565) * light[6];
  float c3 = x * c2 - y * s2, s3 = x * s2 + y * c2;
  bands[3] = 0.59004359 * (s3 * light[9] + c3 * light[15]) + 1.44530572 * z * (s2 * light[10] + c2 * light[14]) +
             (2.285229 * z2 - 0.457045799) * (y * light[11] + x * light[13]) +
             z * (1.86588166 * z2 - 1.119529) * light[12];
#if LAMBENT_BANDS > 4
  float c4 = x * c3 - y * s3, s4 = x * s3 + y * c3;
  bands[4] = 0.625835735 * (s4 * light[16] + c4 * light[24]) + 1.77013077 * z * (s3 * light[17] + c3 * light[23]) +
             (3.31161144 * z2 - 0.473087348) * (s2 * light[18] + c2 * light[22]) +
             z * (4.6833258 * z2 - 2.00713963) * (y * light[19] + x * light[21]) +
             ((3.70249414 * z2 - 3.17356641) * z2 + 0.317356641) * light[20];
#endif
#if LAMBENT_BANDS > 5
  float c5 = x * c4 - y * s4, s5 = x * s4 + y * c4;
  bands[5] = 0.656382057 * (s5 * light[25] + c5 * light[35]) + 2.07566231 * z * (s4 * light[26] + c4 * light[34]) +
             (4.40314469 * z2 - 0.489238299) * (s3 * light[27] + c3 * light[33]) +
             z * (7.19030518 * z2 - 2.39676839) * (s2 * light[28] + c2 * light[32]) +
             ((9.51187968 * z2 - 6.34125312) * z2 + 0.452946651) * (y * light[29] + x * light[31]) +
             z * ((7.36787031 * z2 - 8.18652257) * z2 + 1.75425484) * light[30];
#endif
}

// Returns a unit vector at right angles to the unit vector n [Duff et al., Building an orthonormal basis, revisited,
// 2017].
vec3 perpendicular(vec3 n) {
  float facing = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (facing + n.z);
  return vec3(1.0 + facing * n.x * n.x * a, facing * n.x * n.y * a, -facing * n.x);
}

// Describes the frame of a table, in which the view leans along x, and where the view stands in the table.
// Anisotropic BRDFs are symmetric about the material's tangent and bitangent, so views of all quadrants map to the
// first one, with y reversed in every other quadrant.
struct LocalView {
  vec3 tangent, bitangent, normal;
  float cos_theta;
  vec2 azimuth;  // cosine and sine from the material's tangent, both positive
};

// Returns the place of a cosine on the table's axis across (bundle::angleAxis), 0..1.
float angleAxis(float cos_theta) { return sqrt(max(1.0 - sqrt(max(1.0 - cos_theta, 0.0)), 0.0)); }

// Below this, the squared tangential part of a view is rounding error and its direction undefined; the table is
// smooth there.
const float kLeastAcross = 1e-8;

LocalView localView(vec3 normal, vec3 tangent, vec3 to_eye) {
  LocalView view;
  float along = dot(normal, to_eye);
  vec3 across = to_eye - along * normal;
  float squared = dot(across, across);
  view.normal = normal;
  view.cos_theta = clamp(along, kLeastViewCosine, 1.0);
  view.azimuth = vec2(1.0, 0.0);
#ifdef LAMBENT_ANISOTROPIC
  view.tangent = squared > kLeastAcross ? across * inversesqrt(squared) : tangent;
  view.bitangent = cross(normal, view.tangent);
  vec2 turned = vec2(dot(view.tangent, tangent), dot(view.tangent, cross(normal, tangent)));
  if (turned.x * turned.y < 0.0) view.bitangent = -view.bitangent;
  view.azimuth = abs(turned);
#else
  view.tangent = squared > kLeastAcross ? across * inversesqrt(squared) : perpendicular(normal);
  view.bitangent = cross(normal, view.tangent);
#endif
  return view;
}

// Looks up all weights for the view, packed as in the table.
void lookUpWeights(LocalView view, float roughness, float strength, uvec2 roughnesses_and_strengths,
                   out vec4 weights[kTexels]) {
  vec2 last = vec2(brdfNodes() - 1u);
#ifdef LAMBENT_ANISOTROPIC
  vec2 place = last * vec2(angleAxis(view.cos_theta), atan(view.azimuth.y, view.azimuth.x) / kHalfPi);
  vec2 nodes = vec2(roughnesses_and_strengths - 1u);
  vec2 at = clamp(vec2(roughness, strength), 0.0, 1.0) * nodes;
  vec2 low = min(floor(at), max(nodes - 1.0, 0.0)), part = at - low, high = min(low + 1.0, nodes);
  for (int t = 0; t < kTexels; ++t) weights[t] = vec4(0.0);
  for (int corner = 0; corner < 4; ++corner) {
    vec2 side = vec2(float(corner & 1), float(corner >> 1));
    vec2 share = mix(1.0 - part, part, side), node = mix(low, high, side);
    uint layer = uint(node.y * float(roughnesses_and_strengths.x) + node.x + 0.5) * uint(kTexels);
    for (int t = 0; t < kTexels; ++t) weights[t] += share.x * share.y * brdfTexel(place, layer + uint(t));
  }
#else
  vec2 place = last * vec2(angleAxis(view.cos_theta), clamp(roughness, 0.0, 1.0));
  for (int t = 0; t < kTexels; ++t) weights[t] = brdfTexel(place, uint(t));
#endif
}

// Holds the reflected light of a point. In each vec4, w treats the visibility in the light's w as RGB treats the light.
struct Reflected {
#ifdef LAMBENT_MEASURED
  vec4 light;
  vec3 albedo;  // directional, sqrt(4 pi) b_0
#else
  vec4 f0_light, f90_light;  // the parts that F0 and F90 multiply
  vec2 albedo;               // their directional albedos A and B
#endif
  vec4 diffuse;  // E/pi
};

// Sums the lobes over the light. The table's band 0 has one axis, and y_00 sqrt(4 pi) is 1, so its weight is the
// directional albedo.
Reflected reflectLight(LocalView view, vec4 weights[kTexels], vec4 light[kCoefficients]) {
  Reflected sum;
  vec4 bands[kBands];
  sum.diffuse = vec4(0.0);
#ifdef LAMBENT_MEASURED
  sum.light = vec4(0.0);
  sum.albedo = weights[0].xyz;
#define LAMBENT_ADD(p, band) \
  sum.light += vec4(weights[p].xyz, dot(weights[p].xyz, vec3(1.0 / 3.0))) * (band)
#else
  sum.f0_light = sum.f90_light = vec4(0.0);
  sum.albedo = weights[0].xy;
#define LAMBENT_ADD(p, band)                                                \
  sum.f0_light += (((p) & 1) == 0 ? weights[(p) / 2].x : weights[(p) / 2].z) * (band); \
  sum.f90_light += (((p) & 1) == 0 ? weights[(p) / 2].y : weights[(p) / 2].w) * (band)
#endif
// The loop is unrolled here, so that weights are named by constant indices.
#define LAMBENT_AXIS(i)                                                                                      \
  if (i < kAxes) {                                                                                           \
    vec3 axis = kZonalAxes[min(i, kAxes - 1)];                                                               \
    bandsAt(axis.x * view.tangent + axis.y * view.bitangent + axis.z * view.normal, light, bands);           \
    for (int l = 0; l < kBands; ++l) {                                                                       \
      if (i < LAMBENT_AXES_OF(l)) { LAMBENT_ADD(LAMBENT_FIRST_WEIGHT(l) + i, bands[l]); }                    \
    }                                                                                                        \
  }
  LAMBENT_AXIS(0)
  // The first axis is the normal, so the bands weighed by A_l/pi (docs/conventions.md) give E/pi; A_3 and A_5 are 0.
  sum.diffuse = bands[0] + 2.0 / 3.0 * bands[1] + 0.25 * bands[2];
#if LAMBENT_BANDS > 4
  sum.diffuse -= 1.0 / 24.0 * bands[4];
#endif
  LAMBENT_AXIS(1)
  LAMBENT_AXIS(2)
  LAMBENT_AXIS(3)
  LAMBENT_AXIS(4)
  LAMBENT_AXIS(5)
#ifdef LAMBENT_ANISOTROPIC
  LAMBENT_AXIS(6)
  LAMBENT_AXIS(7)
  LAMBENT_AXIS(8)
  LAMBENT_AXIS(9)
  LAMBENT_AXIS(10)
#endif
  return sum;
}

// Holds F0 and F90 of a point. `dielectric` is ((ior-1)/(ior+1))² times the specular colour.
struct Fresnel {
  vec3 f0;
  float f90;
};
Fresnel fresnelOf(vec3 base_color, float metallic, vec3 dielectric, float specular) {
  return Fresnel(mix(min(dielectric, vec3(1.0)) * specular, base_color, metallic), mix(specular, 1.0, metallic));
}

// Returns the albedo of the diffuse part: what the reflection at the surface leaves, in the channel where it leaves
// least.
vec3 diffuseAlbedo(vec3 base_color, float metallic, Fresnel fresnel, vec2 albedo) {
  vec3 rho = fresnel.f0 * albedo.x + fresnel.f90 * albedo.y;
  return (1.0 - metallic) * max(1.0 - max(rho.r, max(rho.g, rho.b)), 0.0) * base_color;
}

// Returns barycentric weights of a place in a triangle. Each is in 0..1 for any place and any triangle.
vec3 cornerWeights(vec3 place, vec3 a, vec3 b, vec3 c) {
  vec3 ab = b - a, ac = c - a, ap = place - a;
  vec3 size = max(abs(ab), abs(ac));
  float scale = max(size.x, max(size.y, size.z));
  if (!(scale > 0.0)) return vec3(1.0 / 3.0);
  ab /= scale;
  ac /= scale;
  ap /= scale;
  vec3 normal = cross(ab, ac);
  float squared = dot(normal, normal);
  if (squared > 1e-12) {
    vec2 share = vec2(dot(cross(ap, ac), normal), dot(cross(ab, ap), normal)) / squared;
    vec3 weights = max(vec3(1.0 - share.x - share.y, share), vec3(0.0));
    return weights / (weights.x + weights.y + weights.z);
  }
  // The triangle is a sliver, so the weights come from where the place lies along its longest side.
  float length_ab = dot(ab, ab), length_ac = dot(ac, ac), length_bc = dot(ac - ab, ac - ab);
  if (length_bc >= max(length_ab, length_ac)) {
    float t = clamp(dot(ap - ab, ac - ab) / length_bc, 0.0, 1.0);
    return vec3(0.0, 1.0 - t, t);
  }
  if (length_ab >= length_ac) {
    float t = clamp(dot(ap, ab) / length_ab, 0.0, 1.0);
    return vec3(1.0 - t, t, 0.0);
  }
  float t = clamp(dot(ap, ac) / length_ac, 0.0, 1.0);
  return vec3(1.0 - t, 0.0, t);
}
