#include "reference/passes.hpp"

#include "baker/jobs/parallel.hpp"

namespace lambent::baker::reference {

std::uint32_t samplesInPass(const Options& options, const Volumes& volumes) {
  if (options.band_limit && options.band_limit->out) return 256;  // each pass integrates its kernels again
  return volumes.empty() ? 16 : 64;  // in volumes most paths end long before the longest
}

bool addSamples(const Integrator& integrator, Film& film, std::uint32_t first, std::uint32_t last,
                std::uint32_t samples, Progress& progress, const std::stop_token& stop) {
  return parallelRanges(last - first, 1, stop, [&](std::size_t begin, std::size_t end) {
    std::vector<PixelSum> row(film.size().width);
    for (std::size_t r = begin; r < end; ++r) {
      const std::uint32_t y = first + static_cast<std::uint32_t>(r), done = film.done(y);
      if (done >= samples) continue;
      for (std::uint32_t x = 0; x < row.size(); ++x) {
        if (stop.stop_requested()) return;
        row[x] = integrator.pixel(x, y, done, samples - done);
      }
      film.addRow(y, samples - done, row);
      progress.add(std::uint64_t{film.size().width} * (samples - done));
    }
  });
}

}  // namespace lambent::baker::reference
