// What should be on the GPU, of bundles that take more than there is room for. Comes in: each bundle's parts,
// how large the camera sees it and its groups, what was chosen before. Goes out: how many steps of each unit.
// The same camera path gives the same choices, however fast things load. What was chosen stays until
// something else is clearly worth more, so that nothing goes to and fro. No GL, no threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/spec/camera.hpp"
#include "runtime/streaming/parts.hpp"

namespace lambent::streaming {

struct Interest {
  const Parts* parts = nullptr;
  std::vector<float> size;            // by unit, sizeSeen(); of the first the largest of all
  std::vector<std::uint32_t> target;  // by unit: steps chosen before; then, steps chosen now
};

// A sphere's share of the view, about: radius over distance, squared; less where it is out of sight.
float sizeSeen(const spec::View& view, const glm::vec3& center_ws, float radius_m);

// What a step of a unit is worth that is seen as large as `size`; falls from step to step.
float worthOf(const Parts& parts, std::uint32_t unit, std::uint32_t step, float size);

// Steps that together take at most `max_bytes`. The surfaces of what is largest are chosen in any case. Then
// proxy levels of detail come, the largest in sight first, before anything else up to a quarter of the
// memory, so that no place in the world is empty. Then the most worth first, where surfaces come before
// shadows and these before their finer detail, as far as other bundles are not much larger in sight.
void choose(std::span<Interest> bundles, std::uint64_t max_bytes);

}  // namespace lambent::streaming
