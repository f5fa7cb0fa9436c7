// Chooses what to keep on the GPU if the bundles need more memory than there is. The choice depends on each
// bundle's parts, on how large the camera sees it and its groups, and on the previous choice. The result is a
// number of steps per unit. The same camera path gives the same choices, however fast loading is. A choice
// stays until something else is clearly worth more, so that nothing is loaded and dropped again and again.
// Nothing here uses GL or threads.
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
  std::vector<float> size;  // sizeSeen() of each unit; the first unit has the largest of all
  // Steps of each unit: the previous choice on input, the new one on output.
  std::vector<std::uint32_t> target;
};

// Returns about the share of the view that a sphere covers: the square of radius over distance. It is reduced
// if the sphere is out of sight.
float sizeSeen(const spec::View& view, const glm::vec3& center_ws, float radius_m);

// Returns the value of a step of a unit that is seen with this size. It falls from step to step.
float worthOf(const Parts& parts, std::uint32_t unit, std::uint32_t step, float size);

// Chooses steps that need at most `max_bytes` together. The surfaces of the largest bundle in view are chosen
// in any case. Proxy levels of detail come next, largest first, for up to a quarter of the memory, so that no
// part of the world is empty. The remaining steps follow by value. Surfaces have more value than shadows, and
// these more than their finer detail, unless another bundle is much larger in view.
void choose(std::span<Interest> bundles, std::uint64_t max_bytes);

}  // namespace lambent::streaming
