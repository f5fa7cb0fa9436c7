// Multiplies diffuse transfer with light. It holds the mathematics only and no bindings. An entry shader
// selects the stage (LAMBENT_STAGE_VERTICES, _TEXELS or _PROXIES) and defines the fetches that the stage's functions
// declare.
#include "diffuse_shared.h"

const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);  // Rec. 709

vec3 lightAt(uint index);  // coefficient of the light, RGB, group frame

#if defined(LAMBENT_STAGE_VERTICES) || defined(LAMBENT_STAGE_PROXIES) || defined(LAMBENT_STAGE_TEXELS)
vec4 sampleAt(uint index);  // shaded sample; w > 0: resident

float shadedShare(vec4 shaded) { return shaded.w > 0.0 ? 1.0 : 0.0; }

#include "harmonics.glsl"

// Returns E/pi of an open surface with this normal (group frame).
vec3 unshadowedRadiance(vec3 normal, uint light, int order) { return sumOfHarmonics(normal, light, order, true); }
#endif

#ifdef LAMBENT_STAGE_TEXELS
uint rowWordAt(uint word);

// Returns E/pi of a texel times the share of it that is shaded, and that share.
vec4 texelRadiance(DrawRecord draw, uint texel) {
  if (draw.texels_word == kNoRows) return vec4(0.0);
  vec4 shaded = sampleAt(draw.first_output + rowWordAt(draw.texels_word + texel) - draw.first_sample);
  return vec4(shadedShare(shaded) * shaded.rgb, shadedShare(shaded));
}
#endif

#ifdef LAMBENT_STAGE_VERTICES
#include "vertex_rows.glsl"

const float kAllStraight = 1e4;  // more than any light, where nothing is known of shadows

// Returns a vertex's radiance from its row of samples, and the luminance of what comes straight from lights that are
// shaded per pixel. Samples that are not resident count as unshadowed.
vec4 vertexRadiance(DrawRecord draw, uint vertex, vec3 normal, int order) {
  vec4 sum = vec4(0.0);
  float resident = 0.0, total = 0.0;
  if (draw.rows_word != kNoRows) {
    VertexRows rows = VertexRows(draw.rows_word, draw.vertex_count, draw.row_entries);
    uvec2 row = rowOf(rows, vertex);
    for (uint i = row.x; i < row.y; ++i) {
      RowEntry entry = rowEntryAt(rows, i);
      vec4 shaded = sampleAt(draw.first_output + entry.sample_index - draw.first_sample);
      sum += entry.weight * shadedShare(shaded) * vec4(shaded.rgb, shaded.w - 1.0);
      resident += entry.weight * shadedShare(shaded);
      total += entry.weight;
    }
  }
  if (total == 0.0) return vec4(unshadowedRadiance(normal, draw.light, order), kAllStraight);
  if (resident < total)
    sum += (total - resident) * vec4(unshadowedRadiance(normal, draw.light, order), kAllStraight);
  return sum / total;
}

// Gathers the transferred light of bands 0..2 of a vertex with a normal map, in the group's frame. An unshadowed
// vertex receives the light itself.
void vertexLight(DrawRecord draw, uint vertex, out vec3 light[kMappedOutputs]) {
  float resident = 0.0, total = 0.0;
  for (uint j = 0u; j < kMappedOutputs; ++j) light[j] = vec3(0.0);
  if (draw.rows_word != kNoRows) {
    VertexRows rows = VertexRows(draw.rows_word, draw.vertex_count, draw.row_entries);
    uvec2 row = rowOf(rows, vertex);
    for (uint i = row.x; i < row.y; ++i) {
      RowEntry entry = rowEntryAt(rows, i);
      uint first = draw.first_output + kMappedOutputs * (entry.sample_index - draw.first_sample);
      float shaded = shadedShare(sampleAt(first));
      for (uint j = 0u; j < kMappedOutputs; ++j) light[j] += entry.weight * shaded * sampleAt(first + j).rgb;
      resident += entry.weight * shaded;
      total += entry.weight;
    }
  }
  float unshadowed = total == 0.0 ? 1.0 : max(total - resident, 0.0), sum = total == 0.0 ? 1.0 : total;
  for (uint j = 0u; j < kMappedOutputs; ++j) light[j] = (light[j] + unshadowed * lightAt(draw.light + j)) / sum;
}
#endif

#ifdef LAMBENT_STAGE_PROXIES
#include "diffuse_light.glsl"

ProxyEntryRecord proxyEntryAt(uint index);

// Returns E/pi at a normal from nine outputs of a sample. w holds the part that comes straight from key lights, as
// luminance.
vec4 mappedRadiance(uint first, vec3 normal) {
  vec3 light[kMappedOutputs], straight[kMappedOutputs];
  for (uint j = 0u; j < kMappedOutputs; ++j) {
    vec4 value = sampleAt(first + j);
    light[j] = value.rgb;
    straight[j] = vec3(value.w - 1.0);
  }
  return vec4(diffuseLight(light, normal), diffuseLight(straight, normal).r);
}

// Returns how visible the key lights are from a glossy sample, 0..1. They are taken to stand at their mean direction.
float keyVisibility(uint first, vec3 direction) {
  vec3 visibility[kMappedOutputs];
  for (uint j = 0u; j < kMappedOutputs; ++j) visibility[j] = vec3(sampleAt(first + j).w);
  const float kBack[9] = {1.0, 1.5, 1.5, 1.5, 4.0, 4.0, 4.0, 4.0, 4.0};  // pi / A_l, undoes the cosine's weights
  for (uint j = 0u; j < kMappedOutputs; ++j) visibility[j] *= kBack[j];
  return clamp(diffuseLight(visibility, direction).r, 0.0, 1.0);
}

// Returns the colour, of luminance 1, of the light that samples know only by its luminance. Where there are both key
// lights and lamps, it is the mean of their colours.
vec3 straightTint(ProxyGroupRecord group, vec3 key, float key_luminance) {
  vec3 lamps = vec3(0.0);
  for (uint k = 0u; k < group.lamp_count; ++k) lamps += lightAt(group.lamps + 2u * group.lamp_count + k);
  float lamps_luminance = dot(lamps, kLuminance);
  vec3 sum = vec3(0.0);
  float count = 0.0;
  if (key_luminance > 0.0) {
    sum += key / key_luminance;
    count += 1.0;
  }
  if (lamps_luminance > 0.0) {
    sum += lamps / lamps_luminance;
    count += 1.0;
  }
  return sum / max(count, 1.0);
}

// Returns the radiance that a proxy's triangle sends out. Samples that are not shaded yet count as unshadowed.
// Truncated light may be negative somewhere, but a surface never sends out negative radiance.
vec3 proxyRadiance(ProxyGroupRecord group, ProxyTriangleRecord triangle) {
  vec3 normal = vec3(triangle.normal[0], triangle.normal[1], triangle.normal[2]);
  uint key = group.light + kKeyBlock;
  float key_luminance = dot(lightAt(key), kLuminance);
  vec3 tint = straightTint(group, lightAt(key), key_luminance);
  vec3 towards_key = vec3(dot(lightAt(key + 3u), kLuminance), dot(lightAt(key + 1u), kLuminance), dot(lightAt(key + 2u), kLuminance));
  vec3 sum = vec3(0.0), waiting = vec3(0.0);
  for (uint i = triangle.first_entry; i < triangle.first_entry + triangle.entry_count; ++i) {
    ProxyEntryRecord entry = proxyEntryAt(i);
    vec3 reflectance = vec3(entry.reflectance[0], entry.reflectance[1], entry.reflectance[2]);
    vec4 shaded = sampleAt(entry.sample_index);
    if (entry.outputs > kMappedOutputs) {  // glossy samples always have light
      sum += reflectance * mappedRadiance(entry.sample_index, normal).rgb;
      if (key_luminance > 0.0)
        sum += reflectance * keyVisibility(entry.sample_index, normalize(towards_key)) *
               max(unshadowedRadiance(normal, key, int(group.order)), vec3(0.0));
    } else if (shaded.w == 0.0) {
      waiting += reflectance;
    } else {
      vec4 received = entry.outputs == 1u ? vec4(shaded.rgb, shaded.w - 1.0) : mappedRadiance(entry.sample_index, normal);
      sum += reflectance * (received.rgb + max(received.w, 0.0) * tint);
    }
  }
  if (waiting != vec3(0.0)) {
    vec3 open = unshadowedRadiance(normal, group.light, int(group.order));
    if (key_luminance > 0.0) open += unshadowedRadiance(normal, key, int(group.order));
    sum += waiting * open;
  }
  sum = max(sum, vec3(0.0));
  if (triangle.lamp != kNoLamp)
    sum += vec3(triangle.emission[0], triangle.emission[1], triangle.emission[2]) * lightAt(group.lamps + triangle.lamp);
  return sum;
}
#endif
