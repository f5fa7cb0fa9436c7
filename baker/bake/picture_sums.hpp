// Sums up how wrong the light is that leaves points towards eyes, relative RMS over real skies with lamps as
// in the file, and divides the error among its causes. A few points that are very bright, or very wrong,
// count no more than a screen would show of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/importance/importance.hpp"
#include "baker/trace/traced_samples.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// Chooses points of a group's surfaces as eyes see them (baker/importance), to measure there how wrong
// pictures are.
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

class PictureSums {
 public:
  // `eye_weights` are shares of all pictures.
  PictureSums(int order, std::vector<float> eye_weights);

  // The number of coefficients of a channel: those of the environment, then one for all lamps together.
  std::size_t coefficients() const { return coefficients_ + 1; }

  // The radiance that leaves a point as a function of the environment: coefficients of red, then of green,
  // then of blue. `exact` comes from many rays from the point, `noisy` from as many as a vertex has; `fields`
  // is interpolated between vertices, and `codes` from what codes hold of these.
  struct Shown {
    std::span<const float> exact, noisy, fields, codes;
  };
  struct Point {
    std::uint32_t eye = 0;
    double weight = 1.0;          // the number of points for which it stands
    double squared_shares = 1.0;  // the sum of the squares of the vertices' shares
    // The share of the squared difference between few and many rays that the many make.
    double noise_of_exact = 0.0;
  };
  void add(const Point& point, const Shown& shown);

  // Every eye counts by its weight alone, as it gets used to the light. Returns nothing if too few points
  // were added.
  std::optional<bundle::PictureError> result() const;

 private:
  double squareOf(std::span<const float> a, std::span<const float> b) const;

  struct Squares {  // at one point
    double weight, light, all, codes, samples;
  };
  std::size_t coefficients_;  // of the environment
  std::vector<float> eye_weights_;
  std::vector<std::vector<Squares>> of_eye_;
};

}  // namespace lambent::baker
