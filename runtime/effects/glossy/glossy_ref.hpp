// This is the CPU twin of glossy_fill.comp and its entry shaders, with the same names, tables and order of
// terms. Memory is laid out as on the GPU, as in diffuse_ref.hpp, whose decoding of codes it shares. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/effects/glossy/glossy_shared.h"
#include "runtime/sh/zonal.hpp"
#include "runtime/streaming/brdf_texture.hpp"
#include "runtime/transfer/transfer_ref.hpp"

namespace lambent::effects::glossy::ref {

// This is the CPU twin of glossy_kernel.glsl, with the same names and order of terms. Texture lookups of the
// GPU are interpolated here from the same texels. Vectors are unit vectors in the group's frame. No GL.
inline constexpr int kMaxBands = 6;
using bundle::kLeastViewCosine;

using Bands = std::array<glm::vec4, kMaxBands>;

inline Bands bandsAt(int band_count, const glm::vec3& d, std::span<const glm::vec4> light) {
  Bands bands{};
  const float x = d.x, y = d.y, z = d.z, z2 = z * z;
  bands[0] = 0.282094792f * light[0];
  bands[1] = 0.488602512f * (y * light[1] + z * light[2] + x * light[3]);
  const float c2 = x * x - y * y, s2 = 2.0f * x * y;
  bands[2] = 0.546274215f * (s2 * light[4] + c2 * light[8]) +
             1.09254843f * z * (y * light[5] + x * light[7]) + (0.946174696f * z2 - 0.315391565f) * light[6];
  const float c3 = x * c2 - y * s2, s3 = x * s2 + y * c2;
  bands[3] = 0.59004359f * (s3 * light[9] + c3 * light[15]) +
             1.44530572f * z * (s2 * light[10] + c2 * light[14]) +
             (2.285229f * z2 - 0.457045799f) * (y * light[11] + x * light[13]) +
             z * (1.86588166f * z2 - 1.119529f) * light[12];
  if (band_count < 5) return bands;
  const float c4 = x * c3 - y * s3, s4 = x * s3 + y * c3;
  bands[4] = 0.625835735f * (s4 * light[16] + c4 * light[24]) +
             1.77013077f * z * (s3 * light[17] + c3 * light[23]) +
             (3.31161144f * z2 - 0.473087348f) * (s2 * light[18] + c2 * light[22]) +
             z * (4.6833258f * z2 - 2.00713963f) * (y * light[19] + x * light[21]) +
             ((3.70249414f * z2 - 3.17356641f) * z2 + 0.317356641f) * light[20];
  if (band_count < 6) return bands;
  const float c5 = x * c4 - y * s4, s5 = x * s4 + y * c4;
  bands[5] = 0.656382057f * (s5 * light[25] + c5 * light[35]) +
             2.07566231f * z * (s4 * light[26] + c4 * light[34]) +
             (4.40314469f * z2 - 0.489238299f) * (s3 * light[27] + c3 * light[33]) +
             z * (7.19030518f * z2 - 2.39676839f) * (s2 * light[28] + c2 * light[32]) +
             ((9.51187968f * z2 - 6.34125312f) * z2 + 0.452946651f) * (y * light[29] + x * light[31]) +
             z * ((7.36787031f * z2 - 8.18652257f) * z2 + 1.75425484f) * light[30];
  return bands;
}

inline glm::vec3 perpendicular(const glm::vec3& n) {
  const float facing = n.z >= 0.0f ? 1.0f : -1.0f;
  const float a = -1.0f / (facing + n.z);
  return {1.0f + facing * n.x * n.x * a, facing * n.x * n.y * a, -facing * n.x};
}

struct LocalView {
  glm::vec3 tangent, bitangent, normal;
  float cos_theta = 1.0f;
  glm::vec2 azimuth{1.0f, 0.0f};
};

inline constexpr float kLeastAcross = 1e-8f;

inline LocalView localView(bool isotropic, const glm::vec3& normal, const glm::vec3& tangent,
                           const glm::vec3& to_eye) {
  LocalView view;
  const float along = glm::dot(normal, to_eye);
  const glm::vec3 across = to_eye - along * normal;
  const float squared = glm::dot(across, across);
  view.normal = normal;
  view.cos_theta = std::clamp(along, kLeastViewCosine, 1.0f);
  view.tangent = squared > kLeastAcross ? across / std::sqrt(squared)
                 : isotropic            ? perpendicular(normal)
                                        : tangent;
  view.bitangent = glm::cross(normal, view.tangent);
  if (!isotropic) {
    const glm::vec2 turned(glm::dot(view.tangent, tangent),
                           glm::dot(view.tangent, glm::cross(normal, tangent)));
    if (turned.x * turned.y < 0.0f) view.bitangent = -view.bitangent;
    view.azimuth = glm::abs(turned);
  }
  return view;
}

// Holds a table of b(v) as the kernel reads it.
struct Table {
  const bundle::BrdfTable* table = nullptr;
  streaming::BrdfTexels texels;
  sh::ZonalFactors factors;

  explicit Table(const bundle::BrdfTable& from)
      : table(&from),
        texels(streaming::packBrdf(from)),
        factors(from.isotropic() ? sh::ZonalFactors::isotropic(static_cast<int>(from.order))
                                 : sh::ZonalFactors::anisotropic(static_cast<int>(from.order))) {}

  // Interpolates between the four texels around `place`, which is counted in nodes.
  glm::vec4 brdfTexel(glm::vec2 place, std::uint32_t layer) const {
    const auto texel = [&](std::uint32_t x, std::uint32_t y) {
      return texels
          .values[(std::size_t{layer} * texels.height + std::min(y, texels.height - 1)) * texels.width +
                  std::min(x, texels.width - 1)];
    };
    const glm::vec2 low = glm::floor(place), part = place - low;
    const auto x = static_cast<std::uint32_t>(low.x), y = static_cast<std::uint32_t>(low.y);
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), part.x),
                    glm::mix(texel(x, y + 1), texel(x + 1, y + 1), part.x), part.y);
  }
};

inline std::vector<glm::vec4> lookUpWeights(const Table& table, const LocalView& view, float roughness,
                                            float strength) {
  std::vector<glm::vec4> weights(table.texels.per_node, glm::vec4(0.0f));
  const glm::vec2 last(static_cast<float>(table.texels.width - 1),
                       static_cast<float>(table.texels.height - 1));
  if (table.table->isotropic()) {
    const glm::vec2 place =
        last * glm::vec2(bundle::angleAxis(view.cos_theta), std::clamp(roughness, 0.0f, 1.0f));
    for (std::uint32_t t = 0; t < weights.size(); ++t) weights[t] = table.brdfTexel(place, t);
    return weights;
  }
  constexpr float kHalfPi = std::numbers::pi_v<float> / 2;
  const glm::vec2 place = last * glm::vec2(bundle::angleAxis(view.cos_theta),
                                           std::atan2(view.azimuth.y, view.azimuth.x) / kHalfPi);
  const glm::vec2 nodes(static_cast<float>(table.table->roughnesses - 1),
                        static_cast<float>(table.table->strengths - 1));
  const glm::vec2 at = glm::clamp(glm::vec2(roughness, strength), 0.0f, 1.0f) * nodes;
  const glm::vec2 low = glm::min(glm::floor(at), glm::max(nodes - 1.0f, glm::vec2(0.0f))), part = at - low,
                  high = glm::min(low + 1.0f, nodes);
  for (int corner = 0; corner < 4; ++corner) {
    const glm::vec2 side(static_cast<float>(corner & 1), static_cast<float>(corner >> 1));
    const glm::vec2 share = glm::mix(1.0f - part, part, side), node = glm::mix(low, high, side);
    const auto layer =
        static_cast<std::uint32_t>(node.y * static_cast<float>(table.table->roughnesses) + node.x + 0.5f) *
        table.texels.per_node;
    for (std::uint32_t t = 0; t < weights.size(); ++t)
      weights[t] += share.x * share.y * table.brdfTexel(place, layer + t);
  }
  return weights;
}

// With two lobes, holds the factors of F0 and F90; with three, red, green and blue in `light`, and 0
// elsewhere.
struct Reflected {
  glm::vec4 light{0.0f};  // of a measured BRDF
  glm::vec4 f0_light{0.0f}, f90_light{0.0f};
  glm::vec3 albedo{0.0f};  // albedo of each lobe
  glm::vec4 diffuse{0.0f};
};

inline Reflected reflectLight(const Table& table, const LocalView& view, std::span<const glm::vec4> weights,
                              std::span<const glm::vec4> light) {
  Reflected sum;
  const auto band_count = static_cast<int>(table.table->order);
  const bool measured = table.table->lobes == 3;
  sum.albedo = measured ? glm::vec3(weights[0]) : glm::vec3(weights[0].x, weights[0].y, 0.0f);
  for (int i = 0; i < static_cast<int>(table.factors.axes().size()); ++i) {
    const glm::vec3 axis = table.factors.axes()[static_cast<std::size_t>(i)];
    const Bands bands =
        bandsAt(band_count, axis.x * view.tangent + axis.y * view.bitangent + axis.z * view.normal, light);
    for (int l = 0; l < band_count; ++l) {
      if (i >= table.factors.axesOfBand(l)) continue;
      const int p = (table.factors.isIsotropic() ? l * (l + 1) / 2 : l * l) + i;
      const glm::vec4& band = bands[static_cast<std::size_t>(l)];
      if (measured) {
        const glm::vec3 weight(weights[static_cast<std::size_t>(p)]);
        sum.light += glm::vec4(weight, glm::dot(weight, glm::vec3(1.0f / 3.0f))) * band;
      } else {
        const glm::vec4& two = weights[static_cast<std::size_t>(p / 2)];
        sum.f0_light += (p % 2 == 0 ? two.x : two.z) * band;
        sum.f90_light += (p % 2 == 0 ? two.y : two.w) * band;
      }
    }
    if (i == 0) sum.diffuse = bands[0] + 2.0f / 3.0f * bands[1] + 0.25f * bands[2] - 1.0f / 24.0f * bands[4];
  }
  return sum;
}

struct Fresnel {
  glm::vec3 f0;
  float f90;
};
inline Fresnel fresnelOf(const glm::vec3& base_color, float metallic, const glm::vec3& dielectric,
                         float specular) {
  return {glm::mix(glm::min(dielectric, glm::vec3(1.0f)) * specular, base_color, metallic),
          glm::mix(specular, 1.0f, metallic)};
}

inline glm::vec3 diffuseAlbedo(const glm::vec3& base_color, float metallic, const Fresnel& fresnel,
                               const glm::vec2& albedo) {
  const glm::vec3 rho = fresnel.f0 * albedo.x + fresnel.f90 * albedo.y;
  return (1.0f - metallic) * std::max(1.0f - std::max(rho.r, std::max(rho.g, rho.b)), 0.0f) * base_color;
}

inline glm::vec3 cornerWeights(const glm::vec3& place, const glm::vec3& a, const glm::vec3& b,
                               const glm::vec3& c) {
  glm::vec3 ab = b - a, ac = c - a, ap = place - a;
  const glm::vec3 size = glm::max(glm::abs(ab), glm::abs(ac));
  const float scale = std::max(size.x, std::max(size.y, size.z));
  if (!(scale > 0.0f)) return glm::vec3(1.0f / 3.0f);
  ab /= scale;
  ac /= scale;
  ap /= scale;
  const glm::vec3 normal = glm::cross(ab, ac);
  const float squared = glm::dot(normal, normal);
  if (squared > 1e-12f) {
    const glm::vec2 share =
        glm::vec2(glm::dot(glm::cross(ap, ac), normal), glm::dot(glm::cross(ab, ap), normal)) / squared;
    const glm::vec3 weights = glm::max(glm::vec3(1.0f - share.x - share.y, share), glm::vec3(0.0f));
    return weights / (weights.x + weights.y + weights.z);
  }
  const float length_ab = glm::dot(ab, ab), length_ac = glm::dot(ac, ac),
              length_bc = glm::dot(ac - ab, ac - ab);
  if (length_bc >= std::max(length_ab, length_ac)) {
    const float t = std::clamp(glm::dot(ap - ab, ac - ab) / length_bc, 0.0f, 1.0f);
    return {0.0f, 1.0f - t, t};
  }
  if (length_ab >= length_ac) {
    const float t = std::clamp(glm::dot(ap, ab) / length_ab, 0.0f, 1.0f);
    return {1.0f - t, t, 0.0f};
  }
  const float t = std::clamp(glm::dot(ap, ac) / length_ac, 0.0f, 1.0f);
  return {1.0f - t, 0.0f, t};
}

using transfer::ref::Memory;

inline constexpr float kSqrtFourPi = 3.5449077018110318f;

// Returns one output of a sample in a cell without transfer, as glossy_fill.comp does.
inline glm::vec4 openLight(const Memory& memory, const FillRecord& fill, uint output_index) {
  const glm::vec3 light =
      output_index < fill.coefficients ? memory.lightAt(fill.light + output_index) : glm::vec3(0.0f);
  return {light, output_index == 0 && fill.open != 0 ? kSqrtFourPi : 0.0f};
}

}  // namespace lambent::effects::glossy::ref
