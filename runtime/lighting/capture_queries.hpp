// Measures how much of a light's disc bodies hide. Directions spread over the disc are looked up in the drawn
// cube maps, and the visible ones also correct the shape of the light. appendLookups() turns a query and the
// tiles of its point into pixels and depths for the GPU; visibleShare() turns the bits that come back into
// the visible share and the correction. No GL.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/capture_scene.hpp"
#include "runtime/lighting/capture_shared.h"
#include "runtime/sh/basis.hpp"

namespace lambent::lighting::capture {

// A surface does not hide the light if it is as far away as the light, within this relative tolerance.
inline constexpr double kSameDistance = 1e-3;

// Describes a lookup for the GPU. Bit i of a result word tells whether something is nearer than the light
// along direction i.
struct Lookup {
  std::uint32_t pixel = kNoPixel;  // x | y << 16
  std::uint32_t depth_bits = 0;    // bits of a float: near / w, so larger values are nearer
};

// Returns unit directions that each represent the same solid angle of the disc. Radius 0 gives one direction.
std::vector<glm::vec3> discDirections(const LightQuery& query);

// Appends kLookupsPerWord entries for each of the point's queries.
void appendLookups(std::uint32_t size, std::uint32_t subsamples, const PlannedPoint& planned,
                   std::span<const Tile> tiles, const CapturePoint& point, std::vector<Lookup>& lookups);

// Returns the visible share, 0..1. If it is neither 0 nor 1, adds
//   radiance Omega (mean over visible directions of y · visible - visible · mean over all of y)
// to `light`, so that `visible` times the closed form of the disc plus this term has the shape of the visible
// part.
float visibleShare(const LightQuery& query, std::uint32_t hidden_bits, sh::LightVector& light);

// Turns the sums that the GPU made over a point's tiles into the light at that point. Texels without a tile
// see all of the sky, so the light is
//   bodies + (projection of the whole sky's texels - sky that bodies hide)
//   + v ∘ (exact sky - projection of the whole sky's texels)
// where v is the visible share of the sky's light. The last term corrects the error that the texels make in
// the sky: with nothing in front the exact light results, and behind a closed wall nothing of it is left.

// Fills light and sky_visible of `out`. `sums` holds order² pairs as capture_project.comp writes them;
// `uncovered` is the number of the cube's texels without a tile.
inline void combine(std::span<const glm::vec4> sums, std::uint32_t uncovered, const sh::LightVector& exact,
                    const sh::LightVector& through_texels, CapturedLight& out) {
  out.light = sh::LightVector{.order = exact.order};
  const std::span<glm::vec3> light = out.light.coefficients();
  for (std::size_t i = 0; i < light.size(); ++i) light[i] = glm::vec3(sums[2 * i]);
  // Nothing of the sky is visible. The general formula would subtract two large numbers here, and the
  // rounding errors of a bright sky would shine into closed rooms.
  if (uncovered == 0 && sums[0].w == 0.0f) {
    out.sky_visible = glm::vec3(0.0f);
    return;
  }
  // w_0 = Omega y_00, so these are sums over solid angle. For a channel in which the sky is black, the share
  // is that of the solid angle alone.
  const glm::vec4& hidden = sums[1];
  const float hidden_share = hidden.w / (2 * std::sqrt(std::numbers::pi_v<float>));
  for (int channel = 0; channel < 3; ++channel) {
    const float all = through_texels.c[0][channel];
    const float share = all > 0 ? hidden[channel] / all : hidden_share;
    out.sky_visible[channel] = glm::clamp(1.0f - share, 0.0f, 1.0f);
  }
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] += (through_texels.c[i] - glm::vec3(sums[2 * i + 1])) +
                out.sky_visible * (exact.c[i] - through_texels.c[i]);
}

}  // namespace lambent::lighting::capture
