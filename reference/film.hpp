// Accumulates the samples of a picture per pixel, in double precision, and saves them as a checkpoint. Rows
// are filled pass by pass in a fixed order, so that a resumed picture has the same bytes as an uninterrupted
// one. The checkpoint stores a digest of everything that decides the picture; a file with another digest, or
// a damaged one, is refused. Layout: header, samples per row, pixels, XXH3-64 of all before, in native
// (little) endian.
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

}  // namespace lambent::baker::reference
