// A FacingArea says which way surfaces face: it holds the sum of their areas times y_k of their normals in
// five bands. Five bands are enough for the mean square over these surfaces of any irradiance, because
// irradiance has three bands and so its square has five. A surface that may face anywhere adds to band 0
// only.
#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace lambent::baker {

using FacingArea = std::array<float, 25>;

void addFacing(FacingArea& sum, const glm::vec3& normal, float area);
void addFacingAnywhere(FacingArea& sum, float area);

}  // namespace lambent::baker
