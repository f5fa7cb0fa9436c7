// Accumulates the samples of a picture per pixel, in double precision, and saves them as a checkpoint. Rows
// are filled pass by pass in a fixed order, so that a resumed picture has the same bytes as an uninterrupted
// one. The checkpoint stores a digest of everything that decides the picture; a file with another digest, or
// a damaged one, is refused. Layout: header, samples per row, pixels, XXH3-64 of all before, in native
// (little) endian.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "baker/jobs/progress.hpp"
#include "reference/camera.hpp"
#include "reference/lights.hpp"
#include "reference/ray_tracer.hpp"
#include "reference/reference.hpp"
#include "reference/volumes.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker::reference {

// A TracedScene is a scene prepared for path tracing, independent of distant light and view: surfaces, their
// ray-tracing hierarchy, the lights of the file, and volumes. The importer's Scene comes in, with all nodes
// in place. It is slow to build, but any number of threads may trace pictures of it at the same time. The
// Scene must outlive it.
struct TracedScene {
  // Errors: a texture cannot be decoded, or Embree has no memory.
  static Result<std::unique_ptr<const TracedScene>> build(const Scene& scene);
  TracedScene(const Scene& scene, Surfaces built);  // for build()
  TracedScene(const TracedScene&) = delete;         // parts refer to the surfaces
  TracedScene& operator=(const TracedScene&) = delete;

  Surfaces surfaces;
  EmissiveTriangles emissive;
  std::vector<PunctualLight> punctual;
  std::vector<std::string> notices;  // what was left out, one sentence each
  Volumes volumes;
  Result<RayTracer> rays;  // always there after build()
};

// A World is a scene in a light, as seen by a camera: everything that paths of one picture need.
struct World {
  const TracedScene& scene;
  const Environment& environment;
  const std::vector<spec::LocalLight>& shapes;
  EyeRays eye;
  const Options& options;
};

struct PixelSum {
  std::array<glm::dvec3, 2> replicas{};  // sum of the samples of each replica
  double alpha = 0.0;                    // coverage; not a sum
  // Depth of the first opaque surface along the camera's axis, in metres; not a sum.
  double depth = std::numeric_limits<double>::infinity();
  std::uint64_t rays = 0;
};

// Traces the paths of one pixel. At every vertex it samples one direction from the BRDF (for a diffuse
// surface, from the cosine), one direction towards discs and environment maps, one towards each sphere and
// disc light in the scene, one point on an emissive triangle, and one punctual light, combined by multiple
// importance sampling (Veach's power heuristic). At a vertex in a volume the phase function replaces the
// BRDF. With `--band-limit IN,OUT` the first hit's response to the unoccluded sky is exact, and paths only
// find what is blocked. The transmittance of volumes along eye rays is exact, too, so coverage has no noise.
//
// All samples of a pixel in one call advance together, so that their rays are traced in packets. Samples
// alternate between two independent replicas, which gives an unbiased error estimate of their mean: even
// samples belong to replica 0. Traces samples first..first + count - 1. May be called from any thread.
PixelSum tracePixel(const World& world, std::uint32_t x, std::uint32_t y, std::uint32_t first,
                    std::uint32_t count);

class Film {
 public:
  static constexpr std::size_t kBytesOfPixel = 8 * sizeof(double);

  Film(const spec::Size& size, std::uint64_t digest);

  const spec::Size& size() const { return size_; }
  // Returns the samples per pixel that row y has.
  std::uint32_t done(std::uint32_t y) const { return done_[y]; }
  // Adds `count` more samples to row y. Different threads may add different rows.
  void addRow(std::uint32_t y, std::uint32_t count, std::span<const PixelSum> pixels);
  std::uint64_t rays() const;

  // Time spent on the samples so far, which the checkpoint stores.
  double seconds = 0.0;

  Result<void> save(const std::filesystem::path& path) const;
  // Loads a checkpoint. Returns false, and changes nothing, if it is missing, damaged or has another digest.
  bool restore(const std::filesystem::path& path);

  // Returns the mean radiance, coverage and depths. Every row must have at least one sample.
  spec::RgbaImage image() const;
  // Writes a row into a picture of the same size, and its depths if the picture has depths.
  void putRow(std::uint32_t y, spec::RgbaImage& image) const;
  // Returns the mean of replica 0 or 1. The two have independent noise; if they have equally many samples,
  // their mean is image(). Every row must have at least two samples.
  spec::RgbaImage half(std::size_t replica) const;

  // Returns the relative standard error of the pixels, estimated from the difference of the two replicas:
  // sqrt(sum of variances / sum of squares), over the same pixels as `compare`. Returns nothing if a pixel
  // has only one sample.
  std::optional<double> standardError() const;

 private:
  struct Pixel {
    glm::dvec3 replicas[2]{};
    double alpha = 0.0, depth = 0.0;
  };
  glm::dvec3 mean(std::size_t pixel) const;
  std::size_t bytesOfFile() const;

  spec::Size size_;
  std::uint64_t digest_ = 0;
  std::vector<std::uint32_t> done_;  // by row
  std::vector<std::uint64_t> rays_;  // by row
  std::vector<Pixel> pixels_;
};

// Fills a film in passes of samples. The boundaries of passes affect the last bits of a picture (rounding of
// sums, ray packets) and, with a band limit, its kernels. render() and ProgressiveReference both use these
// functions, so that their pictures are equal.

// Returns the number of samples per pixel in one pass.
std::uint32_t samplesInPass(const World& world);

// The number of rows traced between two checks of the clock.
inline constexpr std::uint32_t kRowsAtOnce = 32;

struct Rows {
  std::uint32_t first, last;  // [first, last)
};

// Brings rows to `samples` per pixel, in parallel. Returns false if stopped; unfinished rows
// are dropped, so stopping takes no longer than a few pixels.
bool addSamples(const World& world, Film& film, const Rows& rows, std::uint32_t samples, Progress& progress,
                const std::stop_token& stop);

}  // namespace lambent::baker::reference
