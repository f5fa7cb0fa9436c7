// An Environment is the distant light as paths see it. The distant lights, their rotation and the band limit
// come in. Without a band limit the light consists of a constant, discs with sharp edges, and environment
// maps whose texels are constant over their area; discs and environment maps can be sampled in proportion to
// their radiance. Band-limited light is given by its signed spherical harmonics and can only be evaluated.
#pragma once

#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::baker::reference {

class Environment {
 public:
  // `band_limit` is the number of SH bands, or 0 for no limit.
  Environment(spec::DistantLights lights, float turn_degrees, int band_limit);

  // Returns the radiance that an eye ray sees, as the runtime draws its sky: environment maps are
  // interpolated bilinearly, and the edges of discs are smoothed over a pixel.
  glm::vec3 shown(const glm::vec3& dir, float pixel_angle_rad) const;

  // Returns whether directions can be sampled, which is the case for discs and environment maps but not for
  // constant and band-limited light.
  bool sampled() const { return !parts_.empty(); }
  // Returns a unit direction in world space, or occasionally (at the border of an angular map) a zero vector.
  // `choice` selects a light, `u` a direction within it.
  glm::vec3 sample(float choice, const glm::vec2& u) const;
  // A Look is the radiance from dir, and the density per steradian with which sample() draws dir.
  struct Look {
    glm::vec3 radiance{0.0f};
    float pdf = 0.0f;
  };
  Look look(const glm::vec3& dir) const;
  bool dark() const { return dark_; }
  // Returns the light as spherical harmonics in world space, rotated, and cut to the band limit if there is
  // one.
  const sh::LightVector& lightVector() const { return vector_; }

 private:
  // Samples texels by a cumulative distribution over rows and one within each row, which preserves
  // stratification.
  struct Distribution {
    std::vector<float> rows, columns;  // both begin with 0 and end with 1; columns do so in each row
    std::vector<glm::vec4> texels;     // radiance, and the probability of the texel
  };
  struct Part {
    double probability = 0.0;
    std::size_t environment_map = 0;  // index of the environment map, unless is_disc
    std::size_t disc = 0;
    bool is_disc = false;
  };
  struct Cone {
    glm::mat3 frame{1.0f};  // in the lights' frame; z is the centre
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
