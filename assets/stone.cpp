#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "assets/scenes.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::assets {

namespace {

// Integer hash to [0, 1): lowbias32 by C. Wellons.
float hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x9e3779b9u ^ (y * 0x85ebca6bu + seed * 0xc2b2ae35u);
  h = (h ^ (h >> 16)) * 0x21f0aaadu;
  h = (h ^ (h >> 15)) * 0x735a2d97u;
  return static_cast<float>((h ^ (h >> 15)) >> 8) / 16777216.0f;
}

// Value noise that repeats after `period` lattice cells.
float noise(glm::vec2 at, std::uint32_t period, std::uint32_t seed) {
  const glm::vec2 cell = glm::floor(at), t = at - cell;
  const glm::vec2 blend = t * t * (3.0f - 2.0f * t);
  const auto corner = [&](float dx, float dy) {
    return hash(static_cast<std::uint32_t>(cell.x + dx) % period,
                static_cast<std::uint32_t>(cell.y + dy) % period, seed);
  };
  return glm::mix(glm::mix(corner(0, 0), corner(1, 0), blend.x),
                  glm::mix(corner(0, 1), corner(1, 1), blend.x), blend.y);
}

}  // namespace

std::vector<std::uint8_t> stonePng(int tiles, int texels_per_tile) {
  const auto side = static_cast<std::uint32_t>(tiles * texels_per_tile);
  spec::Rgba8Image image{side, side, {}};
  image.texels.reserve(std::size_t{4} * side * side);
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) {
      const auto per_tile = static_cast<std::uint32_t>(texels_per_tile);
      const std::uint32_t tile_x = x / per_tile, tile_y = y / per_tile;
      const float in_x = static_cast<float>(x % per_tile) + 0.5f,
                  in_y = static_cast<float>(y % per_tile) + 0.5f;
      const float edge = static_cast<float>(texels_per_tile);
      const float to_joint = std::min({in_x, in_y, edge - in_x, edge - in_y});
      float grain = 0.0f;
      for (std::uint32_t octave = 0; octave < 5; ++octave) {
        const std::uint32_t period = static_cast<std::uint32_t>(tiles) * (2u << octave);
        const glm::vec2 at = glm::vec2(x, y) * (static_cast<float>(period) / static_cast<float>(side));
        grain += (noise(at, period, octave) - 0.5f) / static_cast<float>(1u << (octave / 2));
      }
      const glm::vec3 tone =
          (tile_x + tile_y) % 2 ? glm::vec3(0.80f, 0.74f, 0.65f) : glm::vec3(0.62f, 0.54f, 0.46f);
      const float own = 1.0f + 0.08f * (hash(tile_x, tile_y, 99) - 0.5f) + 0.07f * grain;
      const float joint = glm::mix(0.62f, 1.0f, glm::smoothstep(1.0f, 2.5f, to_joint));
      const glm::vec3 colour = glm::clamp(tone * own * joint, 0.0f, 1.0f);
      for (int channel = 0; channel < 3; ++channel)
        image.texels.push_back(static_cast<std::uint8_t>(std::lround(255.0f * colour[channel])));
      image.texels.push_back(255);
    }
  return spec::encodePng(image);
}

}  // namespace lambent::assets
