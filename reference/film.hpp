// A Film holds sums of samples per pixel, in double, and their checkpoint on disk. Rows fill pass by pass,
// each always in the same order, so that a picture that was interrupted and resumed has the same bytes as one
// that was not. The checkpoint carries a digest of everything that decides the picture; a file with another
// digest, or a damaged or truncated one, is refused. Layout: header, samples done per row, pixels, XXH3-64 of
// all before; native (little) endian, for this machine.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "reference/integrator.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/image.hpp"

namespace lambent::baker::reference {

class Film {
 public:
  Film(const spec::Size& size, std::uint64_t digest);

  const spec::Size& size() const { return size_; }
  // Returns the samples per pixel of row y.
  std::uint32_t done(std::uint32_t y) const { return done_[y]; }
  // Adds `count` more samples to row y. Different threads may add different rows.
  void addRow(std::uint32_t y, std::uint32_t count, std::span<const PixelSum> pixels);
  std::uint64_t rays() const;

  // Seconds of work behind the sums; the checkpoint stores them.
  double seconds = 0.0;

  Result<void> save(const std::filesystem::path& path) const;
  // Loads what `path` holds. Returns false, and changes nothing, if that is damaged or has another digest.
  bool restore(const std::filesystem::path& path);

  // Returns mean radiance, coverage and depths. Every row must have samples.
  spec::RgbaImage image() const;
  // Copies a row into a picture of the same size, with depths only if that has any.
  void putRow(std::uint32_t y, spec::RgbaImage& image) const;
  // Returns the mean of replica 0 or 1 alone. The two pictures have independent noise, and their mean is
  // image() if they have equally many samples. Every row must have two samples.
  spec::RgbaImage half(std::size_t replica) const;

  // Returns the standard error of the pixels, relative as in `compare`: sqrt(sum of variances / sum of
  // squares) over the pixels that it counts, from the difference of the two replicas. Returns nothing if a
  // pixel has one sample.
  std::optional<double> standardError() const;

 private:
  struct Pixel {
    glm::dvec3 replicas[2]{};
    double alpha = 0.0, depth = 0.0;
  };
  glm::dvec3 mean(std::size_t pixel) const;

  spec::Size size_;
  std::uint64_t digest_ = 0;
  std::vector<std::uint32_t> done_;  // by row
  std::vector<std::uint64_t> rays_;  // by row
  std::vector<Pixel> pixels_;
};

}  // namespace lambent::baker::reference
