// Sums of samples per pixel, in double, and their checkpoint on disk. Rows fill pass by pass, each row always
// in the same order, so that a picture that was interrupted and gone on with has the bytes of one that was
// not. The checkpoint carries a digest of everything that decides the picture; another digest, a damaged or a
// truncated file is refused. Layout: header, samples done per row, pixels, XXH3-64 of all before; native
// (little) endian, for this machine.
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
  // Samples a pixel that row y has.
  std::uint32_t done(std::uint32_t y) const { return done_[y]; }
  // `pixels` of row y took `count` samples more. Rows may be added from different threads.
  void addRow(std::uint32_t y, std::uint32_t count, std::span<const PixelSum> pixels);
  std::uint64_t rays() const;

  // Seconds of work behind the sums; carried by the checkpoint.
  double seconds = 0.0;

  Result<void> save(const std::filesystem::path& path) const;
  // Takes over what `path` holds. False, with nothing changed, where it is damaged or of another digest.
  bool restore(const std::filesystem::path& path);

  // Mean radiance, coverage and depths. Every row must have samples.
  spec::RgbaImage image() const;
  // Into a picture of the same size; depths only where it has any.
  void putRow(std::uint32_t y, spec::RgbaImage& image) const;
  // The mean of one of the two replicas alone, 0 or 1: pictures with independent noise, whose mean is image()
  // where they have as many samples each. Every row must have two samples.
  spec::RgbaImage half(std::size_t replica) const;

  // Standard error of the picture's pixels, relative as `compare` has it: sqrt(sum of variances / sum of
  // squares) over the pixels that it counts; from the difference of the two replicas. None where a pixel has
  // one sample.
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
