// Holds the GGX lobe of a pixel: its parameters, its weights of the table, and its highlights of lights.
#include "shadowed_light.glsl"

struct Lobes {
  float metallic, roughness, anisotropy;
  vec3 tangent;  // direction of the longer lobe
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
#ifndef LAMBENT_LAYERED
  if (draws[draw_of].glossy.specular_color_texture.set != kAbsent)
    dielectric.rgb *= look(specular_color_texture, looks_at_lobes.xy).rgb;
  if (draws[draw_of].glossy.specular_texture.set != kAbsent)
    dielectric.a *= look(specular_texture, looks_at_reflection.zw).a;
#endif
  lobes.fresnel = fresnelOf(base_color, lobes.metallic, dielectric.rgb, dielectric.a);
  lobes.anisotropy = 0.0;
  lobes.tangent = vec3(0.0);
#if defined(LAMBENT_ANISOTROPIC) && !defined(LAMBENT_LAYERED)
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

// These hold values of the pixel that is being shaded, for modules.
Lobes pixel_lobes = Lobes(0.0, 1.0, 0.0, vec3(0.0), Fresnel(vec3(0.0), 0.0));
vec3 pixel_normal = vec3(0.0), pixel_to_eye = vec3(0.0);

// Returns pi f, with f as in docs/conventions.md, "Materials". The extent of a light widens the lobe; the half vector
// takes half of it.
vec3 lobeReflectance(vec3 to_light, float spread) {
  float narrow = max(pixel_lobes.roughness * pixel_lobes.roughness, 1e-3);
  float wide = mix(narrow, 1.0, pixel_lobes.anisotropy * pixel_lobes.anisotropy);
  // These are the slopes along the tangent and across it, and 1 along the normal.
  vec3 alpha = vec3(sqrt(min(wide * wide + 0.25 * spread * spread, 1.0)), sqrt(min(narrow * narrow + 0.25 * spread * spread, 1.0)), 1.0);
  float nv = max(dot(pixel_normal, pixel_to_eye), kLeastViewCosine), nl = max(dot(pixel_normal, to_light), 1e-3);
  vec3 h = unit(pixel_to_eye + to_light), across = cross(pixel_normal, pixel_lobes.tangent);
  bool round_lobe = pixel_lobes.tangent == vec3(0.0);
  float nh = clamp(dot(pixel_normal, h), 0.0, 1.0), vh = clamp(dot(pixel_to_eye, h), 0.0, 1.0);
  float root, view_width, light_width;
  if (round_lobe) {
    float squared = alpha.y * alpha.y;
    root = (1.0 - nh * nh) / squared + nh * nh;
    view_width = sqrt(nv * nv * (1.0 - squared) + squared);
    light_width = sqrt(nl * nl * (1.0 - squared) + squared);
  } else {
    vec3 t = pixel_lobes.tangent;
    vec3 slopes = vec3(dot(t, h), dot(across, h), nh) / alpha;
    root = dot(slopes, slopes);
    view_width = length(alpha * vec3(dot(t, pixel_to_eye), dot(across, pixel_to_eye), nv));
    light_width = length(alpha * vec3(dot(t, to_light), dot(across, to_light), nl));
  }
  float distribution = 1.0 / (alpha.x * alpha.y * root * root);  // D times pi
  if (round_lobe) distribution = 1.0 / (alpha.y * alpha.y * root * root);
  float shadowing = 0.5 / (nl * view_width + nv * light_width);
  float edge = 1.0 - vh, edge2 = edge * edge;
  return distribution * shadowing *
         (pixel_lobes.fresnel.f0 + (pixel_lobes.fresnel.f90 - pixel_lobes.fresnel.f0) * edge2 * edge2 * edge);
}

// Returns pi f for a light with an extent. If the lobe is sharper than the light, it shows the light's shape: the
// result is the mean over points on the light's disc, weighted by cosine.
vec3 lightReflectance(vec3 to_light, float spread) {
  const int kPoints = 24;
  float alpha = pixel_lobes.roughness * pixel_lobes.roughness;
  if (spread < 0.5 * alpha) return lobeReflectance(to_light, spread);
  if (pixel_lobes.anisotropy == 0.0 && spread > 6.0 * alpha) {
    // The surface is almost a mirror. `inside` is the share of the lobe on the disc's side of its edge, with GGX's
    // distribution of slopes.
    float angle = acos(clamp(dot(reflect(-pixel_to_eye, pixel_normal), to_light), -1.0, 1.0));
    float beyond = (spread - angle) / max(2.0 * alpha, 2e-3), inside = 0.5 + 0.5 * beyond * inversesqrt(1.0 + beyond * beyond);
    float edge = 1.0 - clamp(dot(pixel_normal, pixel_to_eye), 0.0, 1.0), edge2 = edge * edge;
    vec3 fresnel = pixel_lobes.fresnel.f0 + (pixel_lobes.fresnel.f90 - pixel_lobes.fresnel.f0) * edge2 * edge2 * edge;
    vec3 at_edge = inside * fresnel / max(sphereShare(dot(pixel_normal, to_light), 1.0 / sin(spread)), 1e-6);
    // The edge is taken to be straight; far from it the disc counts as a point.
    return mix(at_edge, lobeReflectance(to_light, 0.0), smoothstep(1.2, 2.0, angle / spread));
  }
  vec3 s = perpendicular(to_light), t = cross(to_light, s), sum = vec3(0.0);
  float width = tan(min(spread, 1.4)), weights = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    float angle = 2.39996323 * float(i), place = width * sqrt((float(i) + 0.5) / float(kPoints));
    vec3 towards = normalize(to_light + place * (cos(angle) * s + sin(angle) * t));
    float weight = max(dot(pixel_normal, towards), 0.0);
    if (weight > 0.0) sum += weight * lobeReflectance(towards, spread * inversesqrt(float(kPoints)));
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : vec3(0.0);
}
