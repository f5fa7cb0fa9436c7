// Turns the sums that the GPU made over a point's tiles into the light at that point. Texels without a tile
// see all of the sky, so the light is
//   bodies + (projection of the whole sky's texels - sky that bodies hide)
//   + v ∘ (exact sky - projection of the whole sky's texels)
// where v is the visible share of the sky's light. The last term corrects the error that the texels make in
// the sky: with nothing in front the exact light results, and behind a closed wall nothing of it is left.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "runtime/lighting/capture_scene.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::lighting::capture {

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
