// An Environment is the light from infinity, as paths meet it. The distant lights, their rotation and the
// band limit come in. Whole light consists of a constant, discs with sharp rims, and environment maps whose
// texels are each uniform over their area; discs and environment maps can be sampled in proportion to what
// they send. Band-limited light is given by its signed spherical harmonics and can only be looked up.
#pragma once

#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::baker::reference {

class Environment {
 public:
  // `band_limit` is 0 for whole light.
  Environment(spec::DistantLights lights, float turn_degrees, int band_limit);

  // Returns what the eye sees in a direction, as the runtime draws its sky: environment maps bilinear, rims
  // of discs softened over a pixel.
  glm::vec3 shown(const glm::vec3& dir, float pixel_angle_rad) const;

  // Returns whether there is a density to draw directions from. Discs and environment maps have one; a
  // constant and band-limited light have none.
  bool sampled() const { return !parts_.empty(); }
  // Returns a unit direction in the world, or occasionally (at the rim of an angular map) none, as 0.
  // `choice` picks the part, `u` the place in it.
  glm::vec3 sample(float choice, const glm::vec2& u) const;
  // A Look is what arrives from dir, and the density with which sample() draws dir.
  struct Look {
    glm::vec3 radiance{0.0f};
    float pdf = 0.0f;
  };
  Look look(const glm::vec3& dir) const;
  bool dark() const { return dark_; }
  // Returns the light in the world's frame, rotated, and cut to the band limit if there is one.
  const sh::LightVector& lightVector() const { return vector_; }

 private:
  // Cumulated row by row, so that evenly spread numbers stay evenly spread over the picture.
  struct Distribution {
    std::vector<float> rows, columns;  // both begin with 0 and end with 1, columns in each row
    std::vector<glm::vec4> texels;     // radiance, and the probability of drawing the texel
  };
  struct Part {
    double probability = 0.0;
    std::size_t environment_map = 0;  // if is_disc, `disc` is used instead
    std::size_t disc = 0;
    bool is_disc = false;
  };
  struct Cone {
    glm::mat3 frame{1.0f};  // in the lights' own frame
    float cap = 0.0f;       // 1 - cos of the radius
  };

  Look lookAtEnvironmentMap(std::size_t environment_map, const glm::dvec3& dir) const;
  bool inside(const Cone& cone, const glm::vec3& dir) const;
  void addEnvironmentMap(std::size_t environment_map);

  spec::DistantLights lights_;
  glm::mat3 world_from_light_{1.0f};
  int band_limit_ = 0;
  sh::LightVector vector_;
  bool dark_ = true;
  std::vector<Cone> cones_;
  std::vector<Distribution> distributions_;
  std::vector<Part> parts_;
};

}  // namespace lambent::baker::reference
