// From pictures to light vectors: c_i = sum over texels of radiance y_i(direction) solid angle.
// projectImage takes a whole probe in one of the image layouts, in double, and repairs what cannot be light:
// a texel with a NaN or infinite channel counts as black and is reported. CubeProjector takes small cube maps
// (light captures) many times a frame: its table is made once per (order, size), and it uses the eightfold
// mirror symmetry of the cube, so a projection is one folding pass and an eighth of the multiplications. Rows
// of pictures run from the top.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/light_vector.hpp"

namespace lambent::sh {

struct ProjectionReport {
  std::size_t covered_texels = 0;   // texels that show a direction
  std::size_t replaced_texels = 0;  // of these, not finite and taken as black
  std::size_t negative_texels = 0;  // of these, finite with a negative channel; used as they are
  double solid_angle_sr = 0;        // of all covered texels: 4pi up to the layout's quadrature
};

// texels: width * height, row by row. report may be null.
LightVector projectImage(int order, ImageLayout layout, int width, int height,
                         std::span<const glm::vec3> texels, ProjectionReport* report = nullptr);

// The plain table: weight of texel k (cube_map.hpp's order) for coefficient i at [i * 6 size² + k]. Weights
// are Omega (2 y(centre) - mean of y over the texel): for box-filtered texels this removes the leading error
// of either choice alone, since the filtered texel and the averaged basis would blur twice. A multiple of
// Omega is then taken off coefficients 1 and up, so that uniform light gives exactly constantLight.
std::vector<float> cubeWeights(int order, int size);

class CubeProjector {
 public:
  CubeProjector(int order, int size);  // size >= 1 texels along an edge

  // faces: 6 * size * size texels, finite, in the order of cube_map.hpp.
  LightVector project(std::span<const glm::vec3> faces) const;

  int order() const { return order_; }
  int size() const { return size_; }

 private:
  // The coefficients of one parity class (even or odd in x, y, z) lie side by side in the table.
  struct ParityClass {
    std::vector<int> coefficients;
    std::size_t first_weight = 0;
  };

  int order_;
  int size_;
  std::size_t folded_count_;  // texels of one parity sum, padded to whole vectors
  std::array<ParityClass, 8> classes_;
  std::vector<float> weights_;
};

}  // namespace lambent::sh
