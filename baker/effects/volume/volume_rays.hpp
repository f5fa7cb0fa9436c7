// Holds directions spread evenly over the whole sphere (spherical Fibonacci lattice), all of the same weight,
// with their spherical harmonics.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "baker/effects/volume/grids.hpp"
#include "baker/jobs/stage.hpp"
#include "baker/transport/ray_scene.hpp"

namespace lambent::baker {

inline constexpr double kMeanOfBandZero = 0.28209479177387814;  // y_00

class SphereTable {
 public:
  // rays > 0; order 1..sh::kMaxBasisOrder. `turn` rotates the directions, so that neighbouring tables differ.
  SphereTable(std::size_t rays, int order, const glm::dquat& turn = glm::dquat(1.0, 0.0, 0.0, 0.0));

  std::size_t size() const { return directions_.size(); }
  const glm::vec3& direction(std::size_t ray) const { return directions_[ray]; }
  std::span<const glm::vec3> directions() const { return directions_; }
  // Returns y_i in the direction of a ray, unweighted; order² values.
  std::span<const float> harmonics(std::size_t ray) const {
    return std::span(harmonics_).subspan(ray * columns_, columns_);
  }
  // Returns the mean of y_i over all directions, which is nearly 0 except for y_0.
  double mean(std::size_t i) const { return means_[i]; }

 private:
  std::size_t columns_;
  std::vector<glm::vec3> directions_;
  std::vector<float> harmonics_;
  std::vector<double> means_;
};

// Holds the surfaces that a volume never moves against, for its rays to hit.

class Occluders {
 public:
  Occluders() = default;  // none
  // `scene_from_group` maps the volume's frame to that of the rays' scene; it is a rotation and a
  // translation.
  Occluders(const RayScene& rays, const glm::mat4& scene_from_group)
      : rays_(&rays), scene_from_group_(scene_from_group) {}

  bool any() const { return rays_ != nullptr; }

  // Computes how far each ray from `origin` gets, in metres; infinity if it hits nothing.
  void reach(const glm::vec3& origin, std::span<const glm::vec3> directions,
             std::span<float> distances) const {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    if (rays_ == nullptr) {
      std::fill(distances.begin(), distances.end(), kFar);
      return;
    }
    const glm::vec3 from(scene_from_group_ * glm::vec4(origin, 1.0f));
    std::vector<RaySegment> segments(directions.size());
    for (std::size_t i = 0; i < segments.size(); ++i)
      segments[i] = {from, glm::vec3(scene_from_group_ * glm::vec4(directions[i], 0.0f)), kFar};
    std::vector<FirstHit> hits(segments.size());
    rays_->firstHits(segments, hits);
    for (std::size_t i = 0; i < hits.size(); ++i) distances[i] = hits[i].distance;
  }

 private:
  const RayScene* rays_ = nullptr;
  glm::mat4 scene_from_group_{1.0f};
};

// Computes the light that arrives at places of a medium without having been scattered.

// Shares of the directions from a place: `met` is the part of a ray that the medium takes before the ray
// ends, `out` the part that reaches the outside or a surface. Both are means over the rays, and their sum is
// 1.
struct Arrival {
  double met = 0.0, out = 0.0;
};

// One object serves one thread. Both arguments must outlive it.
class FirstLight {
 public:
  FirstLight(const DensityField& density, const Occluders& occluders)
      : density_(density), occluders_(occluders) {}

  // Traces the table's rays from `place`. `transfer` receives the mean radiance per coefficient of the light.
  // If `clear` is not empty, `transfer` receives the transmittance by direction as spherical harmonics
  // instead, tau_k = int tau y_k ds, and `clear` the same through the medium alone, up to the surfaces.
  Arrival look(const glm::vec3& place, const SphereTable& table, std::span<float> transfer,
               std::span<float> clear = {});

 private:
  const DensityField& density_;
  const Occluders& occluders_;
  std::vector<float> reach_;
  std::vector<double> lost_, gone_;
};

// Holds a medium, its grid and the surfaces around it, for everything that traces rays through the volume.

// The referenced objects must outlive every holder of a VolumeScene.
struct VolumeScene {
  const DensityField& density;
  const TransferGrid& grid;
  const Occluders& occluders;
};

// Steps along rays through a medium as they read its transfer grid: stretches at the density's own resolution
// are combined over less than a voxel of the level that is read at their distance. Rays diverge; once they
// are a voxel apart, a coarser level is enough.

class RaySteps {
 public:
  // `rays` is the number of rays from each sample over the sphere. Density and grid must outlive this.
  RaySteps(const DensityField& density, const TransferGrid& grid, std::size_t rays)
      : density_(&density),
        grid_(&grid),
        voxels_per_metre_(std::sqrt(4.0 * std::numbers::pi / static_cast<double>(rays)) /
                          double{grid.meanEdge()}) {}

  // Returns the level of the grid to read at a distance of t metres.
  int levelAt(double t) const {
    const double spread = t * voxels_per_metre_;
    return spread < 1.0 ? 0 : std::min(std::ilogb(spread) + 1, grid_->levels() - 1);
  }

  // Calls give(t, share) along the ray up to `reach` metres: the share of the light starting at `origin` that
  // the medium takes there, and the mean distance at which it does. Returns the share that is left; together
  // with the others it sums to 1.
  template <typename Give>
  double gather(const glm::vec3& origin, const glm::vec3& direction, float reach, const Give& give) const {
    const auto longest = [&](float t) {
      return kLongestStretch * grid_->shortestEdge() * static_cast<float>(1 << levelAt(double{t}));
    };
    double left = 1.0, share = 0.0, moment = 0.0, window = 0.0;  // metres; end of the window
    density_->march(origin, direction, reach, longest, [&](float from, float to, float depth) {
      if (share > 0.0 && double{to} > window) {
        give(moment / share, share);
        share = moment = 0.0;
      }
      if (share == 0.0)
        window = double{from} + kWindow * double{grid_->meanEdge()} * (1 << levelAt(double{from}));
      const double gone = -std::expm1(-double{depth}) * left;
      share += gone;
      moment += gone * (double{from} + middleOf(double{depth}) * (double{to} - double{from}));
      left -= gone;
      return left > kNothingLeft;
    });
    if (share > 0.0) give(moment / share, share);
    return left;
  }

 private:
  static constexpr float kLongestStretch = 0.5f;  // relative to the shortest edge of a voxel
  static constexpr double kWindow = 0.75;         // length of a window in voxels of its level
  static constexpr double kNothingLeft = 1e-7;

  // Returns the mean place at which a stretch of optical depth e takes light, as a share of its length.
  static double middleOf(double e) {
    if (e < 0.05) return 0.5 - e / 12.0 + e * e * e / 720.0;
    return 1.0 / e - 1.0 / std::expm1(e);
  }

  const DensityField* density_;
  const TransferGrid* grid_;
  double voxels_per_metre_;  // distance between rays in voxels of level 0, per metre
};

// Keeps the traced results of chunks of samples in memory up to a limit, whichever come first; other chunks
// are traced again each time they are needed. In the output of the stage that traces, a chunk without room is
// written as an empty one. A chunk type has bytes(), shrink(), write() and read() (baker/jobs/stage.hpp), and
// is empty by default.

template <typename Chunk>
class KeptChunks {
 public:
  KeptChunks(std::size_t chunks, std::uint64_t most_bytes) : chunks_(chunks), most_bytes_(most_bytes) {}

  // Keeps the chunk if there is room. May be called from any thread, once for each chunk.
  void offer(std::size_t index, Chunk&& chunk) {
    const std::uint64_t size = chunk.bytes();
    if (bytes_.fetch_add(size) + size > most_bytes_) {
      bytes_.fetch_sub(size);
      return;
    }
    chunk.shrink();
    chunks_[index] = std::move(chunk);
  }
  const Chunk& operator[](std::size_t index) const { return chunks_[index]; }
  std::uint64_t bytes() const { return bytes_; }

  // Returns the output of a stage whose ranges are the chunks, of `grain` items each. `fits` says whether a
  // chunk that was read is valid for that many items.
  Output output(std::size_t grain, std::function<bool(const Chunk&, std::size_t items)> fits) {
    return {[this, grain](std::size_t begin, std::size_t, ByteWriter& out) {
              write(chunks_[begin / grain], out);
            },
            [this, grain, fits = std::move(fits)](std::size_t begin, std::size_t end, ByteReader& in) {
              Chunk chunk;
              if (!read(in, chunk) || !fits(chunk, end - begin)) return false;
              offer(begin / grain, std::move(chunk));
              return true;
            }};
  }

 private:
  std::vector<Chunk> chunks_;
  std::uint64_t most_bytes_;
  std::atomic<std::uint64_t> bytes_ = 0;
};

}  // namespace lambent::baker
