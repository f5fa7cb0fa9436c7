// How the surfaces of a group face, as one function over the sphere: their area times y_k of their normals,
// in five bands. That is all that the mean of any square of irradiance over them asks for, which is of four.
// What faces anywhere has band 0 alone.
#pragma once

#include <array>

#include <glm/vec3.hpp>

namespace lambent::baker {

using FacingArea = std::array<float, 25>;

void addFacing(FacingArea& sum, const glm::vec3& normal, float area);
void addFacingAnywhere(FacingArea& sum, float area);

}  // namespace lambent::baker
