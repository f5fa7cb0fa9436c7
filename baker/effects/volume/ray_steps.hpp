// Holds a medium, its grid and the surfaces around it, for everything that traces rays through the volume.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/effects/volume/first_light.hpp"
#include "baker/effects/volume/grids.hpp"
#include "baker/jobs/stage.hpp"

namespace lambent::baker {

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
  KeptChunks(KeptChunks&& other) noexcept
      : chunks_(std::move(other.chunks_)), most_bytes_(other.most_bytes_), bytes_(other.bytes_.load()) {}

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
