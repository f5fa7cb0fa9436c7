// Chooses points of a group's surfaces as eyes see them (baker/importance), to measure there how wrong
// pictures are.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/importance/importance.hpp"
#include "baker/trace/traced_samples.hpp"
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
  std::vector<float> eye_weights;  // shares of all pictures
  ViewPoints diffuse;              // and normal-mapped
  ViewPoints glossy;               // at most kMostGlossyPoints, since their rays are dear
};
inline constexpr std::size_t kMostGlossyPoints = 400;

View viewPoints(const TracedScene& scene, const Importance& importance);

}  // namespace lambent::baker
