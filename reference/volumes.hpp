// Holds the participating media of a scene; where several overlap, their extinctions add. The scene comes in,
// with all nodes in place. It samples collisions by delta tracking (Woodcock et al. 1965) and estimates
// transmittance by residual ratio tracking (Novák, Selle and Jarosz, "Residual Ratio Tracking", SIGGRAPH Asia
// 2014). Both are unbiased for any density and use density bounds per block. Volumes without density are
// skipped, so that they do not change a picture. Calls are thread-safe.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include "baker/import/scene.hpp"
#include "reference/ray_tracer.hpp"
#include "reference/sampler.hpp"

namespace lambent::baker::reference {

// A GridMedium is one volume as rays see it. The importer's SceneVolume and its node's matrix come in. It
// returns the density at a point, as SceneVolume defines it (trilinear between voxel centres, constant in the
// half voxel at the faces), the part of a ray inside the box, and the coarse blocks along it with density
// bounds for tracking. The scene must outlive this.

// A GridRay is the part of a ray inside the box, in voxel coordinates. t is the same as for the ray in world
// space.
struct GridRay {
  glm::dvec3 origin{0.0}, dir{0.0};
  double metres = 1.0;  // per t
  double begin = 0.0, end = 0.0;
  glm::dvec3 at(double t) const { return origin + t * dir; }
};

class GridMedium {
 public:
  // `world_from_grid` must be invertible.
  GridMedium(const SceneVolume& volume, const glm::dmat4& world_from_grid);
  GridMedium(GridMedium&&) = default;
  GridMedium& operator=(GridMedium&&) = default;

  const SceneVolume& volume() const { return *volume_; }
  // Returns the density above which voxels count as this dense, or infinity if there is none.
  float densest() const { return densest_; }
  bool dark() const { return !(most_ > 0.0f); }  // the volume is empty

  // Returns the part within [begin, end] of the ray, or nothing if it misses the box.
  std::optional<GridRay> clipped(const Ray& ray, double begin, double end) const;

  // Returns the density in m^-1 at a point in voxel coordinates. Points outside the box get the density of
  // the nearest face.
  float at(const glm::dvec3& place) const;

  // Calls visit(begin, end, least, most) for each block along the ray until it returns false. least and most
  // bound the density per unit of t.
  template <typename Visit>
  void visitBlocks(const GridRay& ray, Visit&& visit) const;

 private:
  void boundDensity(const glm::dmat3& world_from_grid);

  static constexpr int kBlock = 8;  // edge of a block in voxels

  const SceneVolume* volume_;
  std::vector<float> bounded_;  // the densities, if some had to be bounded
  std::span<const float> density_;
  glm::uvec3 size_;
  glm::vec3 last_;  // centre of the last voxel, relative to the centre of the first
  glm::dmat3 linear_;
  glm::dvec3 shift_;
  glm::ivec3 blocks_;
  std::vector<glm::vec2> bounds_;  // minimum and maximum density per block, x fastest
  float most_ = 0.0f, densest_ = std::numeric_limits<float>::infinity();
};

inline float GridMedium::at(const glm::dvec3& place) const {
  const glm::vec3 q = glm::clamp(glm::vec3(place) - 0.5f, glm::vec3(0.0f), last_);
  const glm::uvec3 i(q);
  const glm::vec3 f = q - glm::vec3(i);
  const std::size_t row = size_.x, slice = row * size_.y;
  const std::size_t dx = f.x > 0.0f ? 1 : 0, dy = f.y > 0.0f ? row : 0, dz = f.z > 0.0f ? slice : 0;
  const float* d = density_.data() + i.x + row * i.y + slice * i.z;
  const auto along = [&](const float* p) { return p[0] + f.x * (p[dx] - p[0]); };
  const float near0 = along(d), near1 = along(d + dy), far0 = along(d + dz), far1 = along(d + dy + dz);
  const float near = near0 + f.y * (near1 - near0), far = far0 + f.y * (far1 - far0);
  return near + f.z * (far - near);
}

template <typename Visit>
void GridMedium::visitBlocks(const GridRay& ray, Visit&& visit) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const glm::dvec3 start = ray.at(ray.begin) / double{kBlock};
  glm::ivec3 block = glm::clamp(glm::ivec3(glm::floor(start)), glm::ivec3(0), blocks_ - 1), step(0);
  glm::dvec3 next(kInfinity), apart(kInfinity);  // t of the next block face per axis, and between faces
  for (int a = 0; a < 3; ++a) {
    if (ray.dir[a] == 0.0) continue;
    step[a] = ray.dir[a] > 0.0 ? 1 : -1;
    next[a] = (double{kBlock} * (block[a] + (step[a] > 0 ? 1 : 0)) - ray.origin[a]) / ray.dir[a];
    apart[a] = double{kBlock} / std::abs(ray.dir[a]);
  }
  double t = ray.begin;
  while (true) {
    const int axis = next.x < next.y ? (next.x < next.z ? 0 : 2) : (next.y < next.z ? 1 : 2);
    const double leave = std::min(next[axis], ray.end);
    if (leave > t) {
      const std::size_t b = static_cast<std::size_t>(block.x) +
                            static_cast<std::size_t>(blocks_.x) *
                                (static_cast<std::size_t>(block.y) +
                                 static_cast<std::size_t>(blocks_.y) * static_cast<std::size_t>(block.z));
      const glm::dvec2 bounds = ray.metres * glm::dvec2(bounds_[b]);
      if (!visit(t, leave, bounds.x, bounds.y)) return;
      t = leave;
    }
    if (leave >= ray.end) return;
    block[axis] += step[axis];
    if (block[axis] < 0 || block[axis] >= blocks_[axis]) return;
    next[axis] += apart[axis];
  }
}

class Volumes {
 public:
  // Adds a notice for each volume that is skipped because its node is flat.
  static Volumes build(const Scene& scene, std::vector<std::string>& notices);

  bool empty() const { return grids_.empty(); }
  const std::vector<GridMedium>& grids() const { return grids_; }
  const SceneVolume& medium(std::uint32_t volume) const { return grids_[volume].volume(); }

  struct Collision {
    double t = 0.0;
    std::uint32_t volume = 0;
  };
  // Samples the first collision before `far`, in units of the ray direction's length. Ray::far is ignored.
  std::optional<Collision> collide(const Ray& ray, double far, Stream& random) const;
  // Returns an unbiased estimate of exp(-optical depth), in 0..1; exactly 1 if the ray meets no medium.
  double transmittance(const Ray& ray, double far, Stream& random) const;

 private:
  std::vector<GridMedium> grids_;
};

// Evaluates and samples the phase function of Henyey and Greenstein, Astrophysical Journal 93, 1941, per
// steradian. Its argument is the cosine between the directions of propagation before and after scattering;
// its mean cosine is g. A path from the eye that travels along d and looks towards s sees light that came
// along -s and left along -d, so the cosine is dot(d, s).

inline float phaseValue(float g, float cosine) {
  const double k = double{g};
  // (1 - g)² + 2g(1 - cos) is 1 + g² - 2g cos without its cancellation.
  const double base = (1.0 - k) * (1.0 - k) + 2.0 * k * (1.0 - double{cosine});
  return static_cast<float>((1.0 - k * k) / (4.0 * std::numbers::pi * base * std::sqrt(base)));
}

// Returns the first SH bands of the function, as runtime and baker use it: Σ_(l < bands) g^l (2l + 1)/(4π)
// P_l. The result can be negative.
inline float phaseValue(float g, float cosine, int bands) {
  const double c = double{cosine};
  double below = 0.0, legendre = 1.0, power = 1.0, sum = 0.0;
  for (int l = 0; l < bands; ++l) {
    sum += power * (2 * l + 1) * legendre;
    const double above = ((2 * l + 1) * c * legendre - l * below) / (l + 1);
    below = legendre;
    legendre = above;
    power *= double{g};
  }
  return static_cast<float>(sum / (4.0 * std::numbers::pi));
}

// Samples a direction with pdf = phaseValue(g, dot(along, result)); `along` is unit.
inline glm::vec3 samplePhase(float g, const glm::vec3& along, const glm::vec2& u) {
  const double k = double{g}, even = 1.0 - 2.0 * double{u.x};
  double cosine = even;
  if (std::abs(k) > 1e-4) {
    const double share = (1.0 - k * k) / (1.0 + k * even);
    cosine = (1.0 + k * k - share * share) / (2.0 * k);
  } else {
    cosine += 1.5 * k * (1.0 - even * even);  // first-order term in g
  }
  cosine = std::clamp(cosine, -1.0, 1.0);
  const auto sine = static_cast<float>(std::sqrt(1.0 - cosine * cosine));
  const float turn = 2.0f * kPi * u.y;
  return glm::normalize(frameAbout(along) *
                        glm::vec3(sine * std::cos(turn), sine * std::sin(turn), static_cast<float>(cosine)));
}

}  // namespace lambent::baker::reference
