// Chooses points of a group's surfaces as eyes see them, to measure there how wrong pictures are. In
// a room the eyes stand in its free space and look all around; a body without such space is looked at from
// around. Where they stand depends on the geometry alone.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/trace/traced_scene.hpp"
#include "baker/transport/face_points.hpp"

namespace lambent::baker {

struct ViewPoints {
  FacePoints points;                // in the order of the eyes
  std::vector<glm::vec3> weights;   // of the corners of each point's triangle
  std::vector<glm::vec3> to_eyes;   // unit directions
  std::vector<std::uint32_t> eyes;  // the eye that sees each point, rising
  std::uint32_t stands_for = 1;     // so many points that are seen
};

struct View {
  std::uint32_t eyes = 0;
  ViewPoints diffuse;
  ViewPoints glossy;  // at most kMostGlossyPoints, since their rays are dear
};
inline constexpr std::size_t kMostGlossyPoints = 400;

View viewPoints(const TracedScene& scene);

}  // namespace lambent::baker
