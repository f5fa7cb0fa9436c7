// Computes value noise for the generator, with the same results on every machine.
#pragma once

#include <cstdint>

#include <glm/vec2.hpp>

namespace lambent::assets {

// Hashes integers to [0, 1).
float hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed);
// Interpolates smoothly between lattice points and repeats after `period` lattice cells.
float noise(glm::vec2 at, std::uint32_t period, std::uint32_t seed);

}  // namespace lambent::assets
