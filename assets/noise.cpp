#include "assets/noise.hpp"

#include <glm/common.hpp>

namespace lambent::assets {

// This is lowbias32 by C. Wellons.
float hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 0x9e3779b9u ^ (y * 0x85ebca6bu + seed * 0xc2b2ae35u);
  h = (h ^ (h >> 16)) * 0x21f0aaadu;
  h = (h ^ (h >> 15)) * 0x735a2d97u;
  return static_cast<float>((h ^ (h >> 15)) >> 8) / 16777216.0f;
}

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

}  // namespace lambent::assets
