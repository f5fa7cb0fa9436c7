// Glossy surfaces in the raster pass: l' at the pixel from the samples of its triangle's corners, then what the BRDF makes
// of it (glossy_kernel.glsl). No varyings for l': OpenGL 4.5 promises too few.
layout(std140, binding = kBindView) uniform ViewBlock {
  mat4 view_from_world;
  mat4 clip_from_view;
  vec4 eye;  // world; w 0: a direction, towards the eye of an orthographic camera
};
layout(std430, binding = kBindGeometry) readonly buffer Geometry { uint geometry[]; };
layout(std430, binding = kBindRows) readonly buffer Rows { uint rows[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };
layout(binding = kUnitMetallicRoughness) uniform sampler2D metallic_roughness_texture;
layout(binding = kUnitSpecular) uniform sampler2D specular_texture;
layout(binding = kUnitSpecularColor) uniform sampler2D specular_color_texture;
layout(binding = kUnitAnisotropy) uniform sampler2D anisotropy_texture;
layout(binding = kUnitBrdf) uniform sampler2DArray brdf_table;
layout(location = 6) in vec3 position_mesh;
layout(location = 7) in vec4 looks_at_reflection;
layout(location = 8) in vec4 looks_at_lobes;

#include "glossy_kernel.glsl"

// Bands that count; the others are as if the light had none.
#ifndef LAMBENT_USED_BANDS
#define LAMBENT_USED_BANDS LAMBENT_BANDS
#endif
const int kUsedCoefficients = LAMBENT_USED_BANDS * LAMBENT_USED_BANDS;

uvec2 brdfNodes() { return uvec2(textureSize(brdf_table, 0).xy); }
vec4 brdfTexel(vec2 place, uint layer) {
  return textureLod(brdf_table, vec3((place + 0.5) / vec2(textureSize(brdf_table, 0).xy), float(layer)), 0.0);
}

vec3 cornerPosition(uint corner) {
  uint at = draws[draw_of].positions_word + 3u * corner;
  return vec3(uintBitsToFloat(geometry[at]), uintBitsToFloat(geometry[at + 1u]), uintBitsToFloat(geometry[at + 2u]));
}

#ifdef LAMBENT_BOUNCES
layout(std430, binding = kBindGlossyBounced) readonly buffer Bounced { float bounced_of[]; };

// What patches send on: light of bands 0..2 at the corners.
void addBounces(uvec3 corners, vec3 weights, inout vec4 light[kCoefficients]) {
  uint word = draws[draw_of].bounced_word;
  for (int corner = 0; corner < 3; ++corner)
    for (int k = 0; k < min(kUsedCoefficients, 9); ++k) {
      uint at = word + 3u * (9u * corners[corner] + uint(k));
      light[k].rgb += weights[corner] * vec3(bounced_of[at], bounced_of[at + 1u], bounced_of[at + 2u]);
    }
}
#endif

// A row as it lies in the page is what the diffuse effect reads (diffuse_eval.glsl). A vertex without any sample leaves
// the pixel to the others.
void gatherLight(out vec4 light[kCoefficients]) {
  uint first = draws[draw_of].glossy.indices_word + 3u * uint(gl_PrimitiveID);
  uvec3 corners = uvec3(geometry[first], geometry[first + 1u], geometry[first + 2u]);
  vec3 weights = cornerWeights(position_mesh, cornerPosition(corners.x), cornerPosition(corners.y),
                               cornerPosition(corners.z));
  uint rows_word = draws[draw_of].glossy.rows_word;
  uint samples_word = rows_word + draws[draw_of].glossy.vertex_count + 1u;
  uint weights_word = samples_word + draws[draw_of].glossy.row_entries;
  float total = 0.0;
  for (int k = 0; k < kCoefficients; ++k) light[k] = vec4(0.0);
  for (int corner = 0; corner < 3; ++corner) {
    uint vertex = corners[corner], end = rows[rows_word + vertex + 1u];
    for (uint entry = rows[rows_word + vertex]; entry < end; ++entry) {
      uint pair = rows[weights_word + (entry >> 1u)];
      float weight = weights[corner] * float((pair >> (16u * (entry & 1u))) & 0xffffu) / 65535.0;
      uint at = draws[draw_of].glossy.first_sample + uint(kCoefficients) * rows[samples_word + entry];
      total += weight;
      for (int k = 0; k < kUsedCoefficients; ++k) light[k] += weight * samples[at + uint(k)];
    }
  }
  float scale = total > 0.0 ? 1.0 / total : 0.0;
  for (int k = 0; k < kCoefficients; ++k) light[k] *= scale;
#ifdef LAMBENT_BOUNCES
  addBounces(corners, weights, light);
#endif
}

// Group frame, unit.
vec3 towardsEye() {
  vec3 position_ws = (draws[draw_of].world_from_mesh * vec4(position_mesh, 1.0)).xyz;
  return unit(mat3(draws[draw_of].glossy.group_from_world) * (eye.xyz - eye.w * position_ws));
}

#ifndef LAMBENT_MEASURED
struct Lobes {
  float metallic, roughness, anisotropy;
  vec3 tangent;  // of the longer lobe
  Fresnel fresnel;
};

Lobes lobesAt(vec3 base_color, TangentFrame frame, vec3 normal) {
  Lobes lobes;
  lobes.metallic = draws[draw_of].glossy.metallic;
  lobes.roughness = draws[draw_of].glossy.roughness;
  if (draws[draw_of].glossy.metallic_roughness_texture.set != kAbsent) {
    vec2 texel = look(metallic_roughness_texture, looks_at_reflection.xy).gb;
    lobes.roughness *= texel.x;
    lobes.metallic *= texel.y;
  }
  lobes.roughness = clamp(lobes.roughness, 0.0, 1.0);
  vec4 dielectric = draws[draw_of].glossy.dielectric;
  if (draws[draw_of].glossy.specular_color_texture.set != kAbsent)
    dielectric.rgb *= look(specular_color_texture, looks_at_lobes.xy).rgb;
  if (draws[draw_of].glossy.specular_texture.set != kAbsent)
    dielectric.a *= look(specular_texture, looks_at_reflection.zw).a;
  lobes.fresnel = fresnelOf(base_color, lobes.metallic, dielectric.rgb, dielectric.a);
  lobes.anisotropy = 0.0;
  lobes.tangent = vec3(0.0);
#ifdef LAMBENT_ANISOTROPIC
  lobes.anisotropy = draws[draw_of].glossy.anisotropy;
  vec2 direction = vec2(1.0, 0.0);
  if (draws[draw_of].glossy.anisotropy_texture.set != kAbsent) {
    vec3 texel = look(anisotropy_texture, looks_at_lobes.zw).rgb;
    vec2 turned = 2.0 * texel.rg - 1.0;
    float squared = dot(turned, turned);
    if (squared > 1e-6) direction = turned * inversesqrt(squared);
    lobes.anisotropy *= texel.b;
  }
  vec2 turn = vec2(draws[draw_of].glossy.direction_cos, draws[draw_of].glossy.direction_sin);
  direction = vec2(turn.x * direction.x - turn.y * direction.y, turn.y * direction.x + turn.x * direction.y);
  vec3 along = frame.tangent == vec3(0.0) ? perpendicular(frame.normal) : frame.tangent;
  vec3 bitangent = frame.handedness * cross(frame.normal, along);
  lobes.tangent = alongSurface(normal, direction.x * along + direction.y * bitangent);
  if (lobes.tangent == vec3(0.0)) lobes.tangent = perpendicular(normal);
#endif
  return lobes;
}
#endif

#if defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS)
#ifdef LAMBENT_MEASURED
// Of this pixel.
LocalView light_view;
vec4 light_weights[kTexels];

// The harmonics in a direction: light of a point there. Cartesian recurrences, as in diffuse_eval.glsl.
void pointLight(vec3 d, out vec4 light[kCoefficients]) {
  float c = 1.0, s = 0.0, sectoral = 0.28209479;
  for (int m = 0; m < kBands; ++m) {
    if (m > 0) {
      float next_c = d.x * c - d.y * s;
      s = d.x * s + d.y * c;
      c = next_c;
      sectoral *= m == 1 ? sqrt(3.0) : sqrt(float(2 * m + 1) / float(2 * m));
    }
    float p = sectoral, before = 0.0;
    for (int l = m; l < kBands; ++l) {
      if (l > m) {
        float factor = sqrt(float(4 * l * l - 1) / float(l * l - m * m));
        float back = l == m + 1 ? 0.0 : factor * sqrt(float((l - 1) * (l - 1) - m * m) / float(4 * (l - 1) * (l - 1) - 1));
        float next = factor * d.z * p - back * before;
        before = p;
        p = next;
      }
      light[l * (l + 1) + m] = vec4(p * c);
      if (m > 0) light[l * (l + 1) - m] = vec4(p * s);
    }
  }
}

// As far as the table's bands carry it.
vec3 lightReflectance(vec3 to_light, float spread) {
  vec4 light[kCoefficients];
  pointLight(to_light, light);
  return 3.14159265 * max(reflectLight(light_view, light_weights, light).light.rgb, vec3(0.0)) /
         max(dot(light_view.normal, to_light), 0.05);
}
#else
// Of this pixel.
Lobes light_lobes = Lobes(0.0, 1.0, 0.0, vec3(0.0), Fresnel(vec3(0.0), 0.0));
vec3 light_normal = vec3(0.0), light_to_eye = vec3(0.0);

// f of docs/conventions.md, "Materials". A light's extent widens the lobe, in half vectors by half.
vec3 lobeReflectance(vec3 to_light, float spread) {
  float narrow = max(light_lobes.roughness * light_lobes.roughness, 1e-3);
  float wide = mix(narrow, 1.0, light_lobes.anisotropy * light_lobes.anisotropy);
  // Slopes along the tangent, across it, and 1 along the normal.
  vec3 alpha = vec3(sqrt(min(wide * wide + 0.25 * spread * spread, 1.0)), sqrt(min(narrow * narrow + 0.25 * spread * spread, 1.0)), 1.0);
  float nv = max(dot(light_normal, light_to_eye), kLeastViewCosine), nl = max(dot(light_normal, to_light), 1e-3);
  vec3 h = unit(light_to_eye + to_light), across = cross(light_normal, light_lobes.tangent);
  bool round_lobe = light_lobes.tangent == vec3(0.0);
  float nh = clamp(dot(light_normal, h), 0.0, 1.0), vh = clamp(dot(light_to_eye, h), 0.0, 1.0);
  float root, view_width, light_width;
  if (round_lobe) {
    float squared = alpha.y * alpha.y;
    root = (1.0 - nh * nh) / squared + nh * nh;
    view_width = sqrt(nv * nv * (1.0 - squared) + squared);
    light_width = sqrt(nl * nl * (1.0 - squared) + squared);
  } else {
    vec3 t = light_lobes.tangent;
    vec3 slopes = vec3(dot(t, h), dot(across, h), nh) / alpha;
    root = dot(slopes, slopes);
    view_width = length(alpha * vec3(dot(t, light_to_eye), dot(across, light_to_eye), nv));
    light_width = length(alpha * vec3(dot(t, to_light), dot(across, to_light), nl));
  }
  float distribution = 1.0 / (alpha.x * alpha.y * root * root);  // times pi
  if (round_lobe) distribution = 1.0 / (alpha.y * alpha.y * root * root);
  float shadowing = 0.5 / (nl * view_width + nv * light_width);
  float edge = 1.0 - vh, edge2 = edge * edge;
  return distribution * shadowing *
         (light_lobes.fresnel.f0 + (light_lobes.fresnel.f90 - light_lobes.fresnel.f0) * edge2 * edge2 * edge);
}

// A lobe that is sharper than the light shows the light's shape: the mean over points on its disc, weighed by cosine.
vec3 lightReflectance(vec3 to_light, float spread) {
  const int kPoints = 24;
  float alpha = light_lobes.roughness * light_lobes.roughness;
  if (spread < 0.5 * alpha) return lobeReflectance(to_light, spread);
  if (light_lobes.anisotropy == 0.0 && spread > 6.0 * alpha) {
    // Almost a mirror: the share of the lobe, as GGX spreads its slopes, that falls on the disc's side of its edge.
    float angle = acos(clamp(dot(reflect(-light_to_eye, light_normal), to_light), -1.0, 1.0));
    float beyond = (spread - angle) / max(2.0 * alpha, 2e-3), inside = 0.5 + 0.5 * beyond * inversesqrt(1.0 + beyond * beyond);
    float edge = 1.0 - clamp(dot(light_normal, light_to_eye), 0.0, 1.0), edge2 = edge * edge;
    vec3 fresnel = light_lobes.fresnel.f0 + (light_lobes.fresnel.f90 - light_lobes.fresnel.f0) * edge2 * edge2 * edge;
    vec3 at_edge = inside * fresnel / max(sphereShare(dot(light_normal, to_light), 1.0 / sin(spread)), 1e-6);
    // Its edge is taken to be straight; from afar the disc is a point.
    return mix(at_edge, lobeReflectance(to_light, 0.0), smoothstep(1.2, 2.0, angle / spread));
  }
  vec3 s = perpendicular(to_light), t = cross(to_light, s), sum = vec3(0.0);
  float width = tan(min(spread, 1.4)), weights = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    float angle = 2.39996323 * float(i), place = width * sqrt((float(i) + 0.5) / float(kPoints));
    vec3 towards = normalize(to_light + place * (cos(angle) * s + sin(angle) * t));
    float weight = max(dot(light_normal, towards), 0.0);
    if (weight > 0.0) sum += weight * lobeReflectance(towards, spread * inversesqrt(float(kPoints)));
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : vec3(0.0);
}
#endif
#endif

#ifdef LAMBENT_RESIDUAL
#include "prefiltered_shared.h"
layout(std140, binding = kBindReflection) uniform ReflectionBlock { ReflectionValues reflection; };
layout(binding = kUnitFirstReflection) uniform samplerCube first_reflection;
layout(binding = kUnitSecondReflection) uniform samplerCube second_reflection;
#ifdef LAMBENT_KEY_LIGHTS
layout(binding = kUnitFirstWhole) uniform samplerCube first_whole;
layout(binding = kUnitSecondWhole) uniform samplerCube second_whole;

// What a rough mirror shows of key lights in their true shape.
vec3 keyPicture(vec3 direction_ws, float roughness) {
  float level = reflection.shares.z * pow(roughness, 2.0 / 3.0);
  vec3 direction = mat3(reflection.light_from_world) * direction_ws;
  vec3 first = textureLod(first_whole, direction, level).rgb - textureLod(first_reflection, direction, level).rgb;
  vec3 second = textureLod(second_whole, direction, level).rgb - textureLod(second_reflection, direction, level).rgb;
  return max(reflection.shares.x * first + reflection.shares.y * second, vec3(0.0));
}

// Highlights by discs, or of a mirror that is sharp enough to tell what the discs are pieces of, by that.
vec3 keyHighlights(Lobes lobes, vec3 mirrored_ws, vec3 rho) {
  const float kSharp = 0.05, kRough = 0.12;  // alpha
  float alpha = lobes.roughness * lobes.roughness;
  float pictured = lobes.anisotropy != 0.0 ? 0.0 : reflection.shares.w * (1.0 - smoothstep(kSharp, kRough, alpha));
  if (pictured == 0.0) return key_highlights;
  float open = dot(key_open_highlights, vec3(1.0)), seen = dot(key_highlights, vec3(1.0));
  float visible = open > 0.0 ? clamp(seen / open, 0.0, 1.0) : 1.0;
  return mix(key_highlights, visible * rho * keyPicture(mirrored_ws, lobes.roughness), pictured);
}
#endif

// What a rough mirror shows of the sky besides the bands that the surface has of it: P(L) - P(L_n). The bands scale
// between levels as the levels themselves mix, so that light of few bands leaves nothing. Signed.
vec3 residualLight(vec3 direction_ws, float roughness) {
  float level = reflection.shares.z * pow(roughness, 2.0 / 3.0);  // roughnessOfLevel, turned about
  vec3 direction = mat3(reflection.light_from_world) * direction_ws;
  vec3 seen = reflection.shares.x * textureLod(first_reflection, direction, level).rgb +
              reflection.shares.y * textureLod(second_reflection, direction, level).rgb;
  vec4 light[kCoefficients], bands[kBands];
  for (int k = 0; k < kCoefficients; ++k) light[k] = k < kUsedCoefficients ? reflection.light[k] : vec4(0.0);
  bandsAt(direction_ws, light, bands);
  int low = int(min(level, reflection.shares.z - 1.0));
  float share = level - float(low);
  vec4 first = mix(reflection.bands[2 * low], reflection.bands[2 * low + 2], share);
  vec4 second = mix(reflection.bands[2 * low + 1], reflection.bands[2 * low + 3], share);
  vec3 known = first.x * bands[0].rgb + first.y * bands[1].rgb + first.z * bands[2].rgb + first.w * bands[3].rgb;
#if LAMBENT_BANDS > 4
  known += second.x * bands[4].rgb;
#endif
#if LAMBENT_BANDS > 5
  known += second.y * bands[5].rgb;
#endif
  return seen - known;
}
#endif

#ifdef LAMBENT_NEIGHBORHOODS
// Of light in as many bands as grid and surface both have, reflected by the kernel of this view.
Reflected reflectedChange(uint draw, vec3 position, LocalView view, vec4 weights[kTexels]) {
  Reflected sum;
#ifdef LAMBENT_MEASURED
  sum.light = vec4(0.0);
#else
  sum.f0_light = sum.f90_light = vec4(0.0);
#endif
  sum.diffuse = vec4(0.0);
  for (uint a = receivers[draw].first; a < receivers[draw].first + receivers[draw].count; ++a) {
    vec3 place = vec4(position, 1.0) * arrivals[a].grid_from_position;
    float share = gridShare(place, arrivals[a].grid);
    if (share == 0.0) continue;
    vec4 change[kCoefficients];
    for (int k = 0; k < kCoefficients; ++k)
      change[k] = k < kUsedCoefficients && uint(k) < arrivals[a].grid.outputs ? share * gridOutput(place, arrivals[a].grid, uint(k)) : vec4(0.0);
    LocalView turned_view = view;
    turned_view.tangent = vec4(view.tangent, 0.0) * arrivals[a].body_from_group;
    turned_view.bitangent = vec4(view.bitangent, 0.0) * arrivals[a].body_from_group;
    turned_view.normal = vec4(view.normal, 0.0) * arrivals[a].body_from_group;
    Reflected reflected = reflectLight(turned_view, weights, change);
#ifdef LAMBENT_MEASURED
    sum.light += reflected.light;
#else
    sum.f0_light += reflected.f0_light;
    sum.f90_light += reflected.f90_light;
#endif
    sum.diffuse += reflected.diffuse;
  }
  return sum;
}
#endif

#if defined(LAMBENT_RESIDUAL) && !defined(LAMBENT_MEASURED)
// Brushed metal reflects a fan: round lobes of its narrow roughness about the view mirrored in normals that lean along the
// tangent, by equal shares of the slopes of GGX (their marginal is s = a u / sqrt(1 - u^2), u even in -1..1).
vec3 residualOver(Lobes lobes, vec3 normal, vec3 to_eye) {
  const int kShares = 12;
  float narrow = lobes.roughness * lobes.roughness, wide = mix(narrow, 1.0, lobes.anisotropy * lobes.anisotropy);
  float fan = sqrt(max(wide * wide - narrow * narrow, 0.0));
  mat3 group_from_world = mat3(draws[draw_of].glossy.group_from_world);
  if (fan < 0.05) return residualLight(reflect(-to_eye, normal) * group_from_world, lobes.roughness);  // by the transpose
  float between = fan / float(kShares);  // of one share to the next, halved: wide enough to leave no gaps
  float roughness = sqrt(sqrt(narrow * narrow + between * between));
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int i = 0; i < kShares; ++i) {
    float u = (2.0 * float(i) + 1.0) / float(kShares) - 1.0;
    vec3 leaning = normalize(normal + fan * u * inversesqrt(1.0 - u * u) * lobes.tangent);
    vec3 mirrored = reflect(-to_eye, leaning);
    float weight = max(dot(leaning, to_eye), 0.0) * step(0.0, dot(mirrored, normal));
    if (weight <= 0.0) continue;
    sum += weight * residualLight(mirrored * group_from_world, roughness);
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : vec3(0.0);
}
#endif

vec3 reflectedLight(vec3 base_color) {
  TangentFrame frame = pixelFrame();
  vec3 normal = pixelNormal(frame), to_eye = towardsEye();
  vec4 light[kCoefficients];
  gatherLight(light);
  vec4 weights[kTexels];
#ifdef LAMBENT_MEASURED
  LocalView view = localView(normal, vec3(0.0), to_eye);
  lookUpWeights(view, 0.0, 0.0, uvec2(1u), weights);
  Reflected reflected = reflectLight(view, weights, light);
  vec3 radiance = reflected.light.rgb;
#ifdef LAMBENT_NEIGHBORHOODS
  radiance = withChange(radiance, reflectedChange(draws[draw_of].glossy.draw, position_mesh, view, weights).light.rgb);
#endif
#ifdef LAMBENT_VIEW_IRRADIANCE
  radiance = reflected.diffuse.rgb;
#ifdef LAMBENT_NEIGHBORHOODS
  radiance = withChange(radiance, reflectedChange(draws[draw_of].glossy.draw, position_mesh, view, weights).diffuse.rgb);
#endif
  reflected.albedo = vec3(1.0);
#endif
#ifdef LAMBENT_KEY_LIGHTS
  light_view = view;
  light_weights = weights;
  keyLight(draw_of, normal);
  radiance += key_highlights;
#endif
#ifdef LAMBENT_SHADOWED_LIGHTS
  // As from a diffuse surface that sends as much towards the eye of light from all around.
  radiance += reflected.albedo * shadowedLight(draws[draw_of].glossy.draw, draws[draw_of].facing * frame.normal, normal);
#endif
#else
  Lobes lobes = lobesAt(base_color, frame, normal);
  LocalView view = localView(normal, lobes.tangent, to_eye);
  uvec2 nodes = uvec2(draws[draw_of].glossy.roughnesses, draws[draw_of].glossy.strengths);
  lookUpWeights(view, lobes.roughness, lobes.anisotropy, nodes, weights);
  Reflected reflected = reflectLight(view, weights, light);
  vec3 diffuse = diffuseAlbedo(base_color, lobes.metallic, lobes.fresnel, reflected.albedo);
  vec3 received = reflected.diffuse.rgb;
  vec3 mirrored_light = lobes.fresnel.f0 * reflected.f0_light.rgb + lobes.fresnel.f90 * reflected.f90_light.rgb;
#ifdef LAMBENT_NEIGHBORHOODS
  Reflected change = reflectedChange(draws[draw_of].glossy.draw, position_mesh, view, weights);
  received = withChange(received, change.diffuse.rgb);
  mirrored_light =
      withChange(mirrored_light, lobes.fresnel.f0 * change.f0_light.rgb + lobes.fresnel.f90 * change.f90_light.rgb);
  reflected.f0_light.w += change.f0_light.w;
  reflected.f90_light.w += change.f90_light.w;
#endif
#if defined(LAMBENT_SHADOWED_LIGHTS) || defined(LAMBENT_KEY_LIGHTS)
  light_lobes = lobes;
  light_normal = normal;
  light_to_eye = to_eye;
#endif
#ifdef LAMBENT_KEY_LIGHTS
  received += keyLight(draw_of, normal);
#endif
#ifdef LAMBENT_SHADOWED_LIGHTS
  received += shadowedLight(draws[draw_of].glossy.draw, draws[draw_of].facing * frame.normal, normal);
#endif
#ifdef LAMBENT_VIEW_IRRADIANCE
  return received;
#endif
  vec3 radiance = mirrored_light + diffuse * received;
#ifdef LAMBENT_SHADOWED_LIGHTS
  radiance += local_highlights;
#endif
#if defined(LAMBENT_KEY_LIGHTS) && !defined(LAMBENT_RESIDUAL)
  radiance += key_highlights;
#endif
#ifdef LAMBENT_RESIDUAL
  // By the share of the sky that the lobe sees, as far as few bands can tell: (c . V) / (c . 1).
  vec3 rho = lobes.fresnel.f0 * reflected.albedo.x + lobes.fresnel.f90 * reflected.albedo.y;
  float f0 = dot(lobes.fresnel.f0, vec3(1.0 / 3.0));
  float seen = f0 * reflected.f0_light.w + lobes.fresnel.f90 * reflected.f90_light.w;
  float open = f0 * reflected.albedo.x + lobes.fresnel.f90 * reflected.albedo.y;
  float visibility = clamp(seen / max(open, 1e-6), 0.0, 1.0);
  radiance += visibility * rho * residualOver(lobes, normal, to_eye);
#ifdef LAMBENT_KEY_LIGHTS
  vec3 mirrored_ws = reflect(-to_eye, normal) * mat3(draws[draw_of].glossy.group_from_world);  // by the transpose
  radiance += keyHighlights(lobes, mirrored_ws, rho);
#endif
#endif
#endif
  return radiance;
}
