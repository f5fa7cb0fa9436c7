// Projects pictures to light vectors: c_i is the sum over texels of radiance y_i(direction) solid angle.
// projectImage projects an environment map in any image layout, in double precision; a texel with a NaN or
// infinite channel counts as black and is reported. CubeProjector projects small cube maps (light captures)
// many times per frame. Its table is made once per order and size. It uses the eightfold mirror symmetry of
// the cube, so a projection is one folding pass and an eighth of the multiplications. Rows of pictures start
// at the top.
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
  std::size_t replaced_texels = 0;  // covered texels that were not finite and counted as black
  std::size_t negative_texels = 0;  // covered texels with a negative channel, which is used as it is
  double solid_angle_sr = 0;        // sum over covered texels, 4pi up to the error of quadrature
};

// Projects `texels`, which has width * height entries, row by row. `report` may be null.
LightVector projectImage(int order, ImageLayout layout, int width, int height,
                         std::span<const glm::vec3> texels, ProjectionReport* report = nullptr);

// Returns the weights of texels. The weight of texel k (in the order of image_layout.hpp) for coefficient i
// is entry i * 6 size² + k. It is Omega (2 y(centre) - mean of y over the texel), where Omega is the texel's
// solid angle. For box-filtered texels this cancels the leading error that y(centre) or the mean alone would
// have. A multiple of Omega is then subtracted from coefficients 1 and up, so that uniform light gives
// exactly constantLight.
std::vector<float> cubeWeights(int order, int size);

class CubeProjector {
 public:
  CubeProjector(int order, int size);  // `size` is the number of texels along an edge, at least 1

  // Projects `faces`, which has 6 * size * size finite texels in the order of image_layout.hpp.
  LightVector project(std::span<const glm::vec3> faces) const;

  int order() const { return order_; }
  int size() const { return size_; }

 private:
  // Describes the coefficients of one parity class (even or odd in x, y and z), which are adjacent in the
  // table.
  struct ParityClass {
    std::vector<int> coefficients;
    std::size_t first_weight = 0;
  };

  int order_;
  int size_;
  std::size_t folded_count_;  // texels of one parity sum, padded to whole SIMD vectors
  std::array<ParityClass, 8> classes_;
  std::vector<float> weights_;
};

}  // namespace lambent::sh
