#include "baker/trace/traced_ranges.hpp"

#include <numeric>
#include <utility>

#include "baker/trace/hit_bytes.hpp"

namespace lambent::baker {

TracedRanges::TracedRanges(const TracedScene& scene, std::size_t samples, Settings settings, Paint paint,
                           HitStore& store)
    : scene_(scene),
      paint_(std::move(paint)),
      store_(store),
      settings_(settings),
      rays_((samples + kSamplesPerRange - 1) / kSamplesPerRange, 0),
      unpainted_(rays_.size()) {}

void TracedRanges::offer(std::size_t range, RangeHits&& hits) {
  paint_(range * kSamplesPerRange, hits);
  store_.offer(range, std::move(hits));
}

void TracedRanges::add(std::size_t range, std::uint64_t rays, RangeHits&& hits, const std::stop_token& stop) {
  rays_[range] = rays;
  traced_ += rays;
  if (!settings_.keep_hits || stop.stop_requested()) return;
  if (settings_.kept) {
    ByteWriter bytes;
    writeHits(hits, bytes);
    unpainted_[range] = bytes.take();
  }
  offer(range, std::move(hits));
}

Output TracedRanges::output() {
  return {[this](std::size_t begin, std::size_t, ByteWriter& out) { write(begin / kSamplesPerRange, out); },
          [this](std::size_t begin, std::size_t end, ByteReader& in) {
            return read(begin / kSamplesPerRange, end - begin, in);
          }};
}

void TracedRanges::write(std::size_t range, ByteWriter& out) {
  out.add(rays_[range]);
  // Hits that had no room in memory are not written; they are traced again when they are asked for.
  const bool with_hits = settings_.keep_hits && store_.range(range).kept;
  out.add(with_hits);
  const std::vector<std::byte> hits = std::exchange(unpainted_[range], {});
  if (with_hits) out.addBytes(hits);
}

bool TracedRanges::read(std::size_t range, std::size_t samples, ByteReader& in) {
  bool with_hits = false;
  RangeHits hits;
  if (!in.read(rays_[range]) || !in.read(with_hits) ||
      (with_hits && !readHits(in, samples, scene_.geometry.triangles.size(), hits)))
    return false;
  if (with_hits) offer(range, std::move(hits));
  return true;
}

std::uint64_t TracedRanges::raysFound() const {
  return std::accumulate(rays_.begin(), rays_.end(), std::uint64_t{0}) - traced_;
}

}  // namespace lambent::baker
