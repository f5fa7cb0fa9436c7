#include "reference/passes.hpp"

#include "baker/jobs/parallel.hpp"

namespace lambent::baker::reference {

std::uint32_t samplesInPass(const Options& options, const Volumes& volumes) {
  if (options.band_limit && options.band_limit->out) return 256;  // each pass integrates its kernels again
  return volumes.empty() ? 16 : 64;  // in volumes most paths end long before the longest
}

bool addSamples(const Integrator& integrator, Film& film, const Rows& rows, std::uint32_t samples,
                Progress& progress, const std::stop_token& stop) {
  return parallelRanges(rows.last - rows.first, 1, stop, [&](std::size_t begin, std::size_t end) {
    std::vector<PixelSum> row(film.size().width);
    for (std::size_t r = begin; r < end; ++r) {
      const std::uint32_t y = rows.first + static_cast<std::uint32_t>(r), done = film.done(y);
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
