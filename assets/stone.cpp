#include <algorithm>
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "assets/noise.hpp"
#include "assets/scenes.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::assets {

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
