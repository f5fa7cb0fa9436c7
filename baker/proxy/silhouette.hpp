// Measures how large a surface looks from far away.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec2.hpp>

#include "baker/proxy/simplify.hpp"

namespace lambent::baker {

class Silhouette {
 public:
  explicit Silhouette(std::span<const SimpleMesh> original);

  // Returns by how much `proxy` must grow, as a length, to cover as much as the original does, seen from far
  // away along seven axes (mean of areas). Of the proxy, only what lies within the original's bounds counts.
  // Returns 1 if either covers nothing; the result is within 1/2..2.
  float scaleOf(std::span<const SimpleMesh> proxy) const;

 private:
  struct View {
    glm::vec3 right{0.0f}, up{0.0f};
    glm::vec2 low{0.0f}, high{0.0f};  // bounds of the original
    double pixel = 0.0;               // square metres; 0 if seen edge on
    double covered = 0.0;             // pixels
  };
  static double pixelsOf(std::span<const SimpleMesh> meshes, const View& view);

  std::array<View, 7> views_;
};

}  // namespace lambent::baker
