#include "reference/film.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <numeric>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "runtime/base/atomic_file.hpp"
#include "runtime/bundle/container.hpp"

namespace lambent::baker::reference {

namespace {

constexpr std::uint32_t kMagic = 0x5052424c;  // "LBRP"
constexpr std::uint32_t kVersionDepths = 2;   // pixels have depths; version 1 had none
constexpr std::uint32_t kVersionCurrent = kVersionDepths;

struct Header {
  std::uint32_t magic = kMagic, version = kVersionCurrent;
  std::uint64_t digest = 0;
  std::uint32_t width = 0, height = 0;
  double seconds = 0.0;
};
static_assert(sizeof(Header) == 32);

template <typename T>
void put(std::vector<std::byte>& bytes, std::span<const T> values) {
  const auto raw = std::as_bytes(values);
  bytes.insert(bytes.end(), raw.begin(), raw.end());
}

template <typename T>
std::span<const std::byte> take(std::span<const std::byte> bytes, std::span<T> values) {
  std::memcpy(values.data(), bytes.data(), values.size_bytes());
  return bytes.subspan(values.size_bytes());
}

}  // namespace

Film::Film(const spec::Size& size, std::uint64_t digest)
    : size_(size),
      digest_(digest),
      done_(size.height, 0),
      rays_(size.height, 0),
      pixels_(std::size_t{size.width} * size.height) {
  static_assert(sizeof(Pixel) == kBytesOfPixel);
}

void Film::addRow(std::uint32_t y, std::uint32_t count, std::span<const PixelSum> pixels) {
  assert(pixels.size() == size_.width);
  for (std::size_t x = 0; x < pixels.size(); ++x) {
    Pixel& pixel = pixels_[std::size_t{y} * size_.width + x];
    for (std::size_t r = 0; r < 2; ++r) pixel.replicas[r] += pixels[x].replicas[r];
    pixel.alpha = pixels[x].alpha;
    pixel.depth = pixels[x].depth;
    rays_[y] += pixels[x].rays;
  }
  done_[y] += count;
}

std::uint64_t Film::rays() const {
  return std::accumulate(rays_.begin(), rays_.end(), std::uint64_t{0});
}

std::size_t Film::bytesOfFile() const {
  return sizeof(Header) + done_.size() * sizeof(done_[0]) + rays_.size() * sizeof(rays_[0]) +
         pixels_.size() * sizeof(Pixel) + sizeof(std::uint64_t);
}

Result<void> Film::save(const std::filesystem::path& path) const {
  const Header header{.digest = digest_, .width = size_.width, .height = size_.height, .seconds = seconds};
  std::vector<std::byte> bytes;
  bytes.reserve(bytesOfFile());  // growing would take three times as much
  put(bytes, std::span(&header, 1));
  put(bytes, std::span<const std::uint32_t>(done_));
  put(bytes, std::span<const std::uint64_t>(rays_));
  put(bytes, std::span<const Pixel>(pixels_));
  const std::uint64_t checksum = bundle::checksum(bytes);
  put(bytes, std::span(&checksum, 1));
  auto file = AtomicFile::open(path);
  if (!file) return failAgain(std::move(file.error()));
  if (auto written = file->write(bytes); !written) return written;
  return file->commit();
}

bool Film::restore(const std::filesystem::path& path) {
  const auto text = readTextFile(path);
  if (!text) return false;
  if (text->size() != bytesOfFile()) return false;
  std::span<const std::byte> bytes = std::as_bytes(std::span(*text));
  std::uint64_t checksum = 0;
  std::memcpy(&checksum, bytes.data() + bytes.size() - sizeof(checksum), sizeof(checksum));
  if (bundle::checksum(bytes.first(bytes.size() - sizeof(checksum))) != checksum) return false;
  Header header;
  bytes = take(bytes, std::span(&header, 1));
  if (header.magic != kMagic || header.version != kVersionCurrent || header.digest != digest_ ||
      header.width != size_.width || header.height != size_.height)
    return false;
  seconds = header.seconds;
  bytes = take(bytes, std::span(done_));
  bytes = take(bytes, std::span(rays_));
  take(bytes, std::span(pixels_));
  return true;
}

glm::dvec3 Film::mean(std::size_t pixel) const {
  const double samples = done_[pixel / size_.width];
  return (pixels_[pixel].replicas[0] + pixels_[pixel].replicas[1]) / samples;
}

spec::RgbaImage Film::image() const {
  spec::RgbaImage image{.width = size_.width,
                        .height = size_.height,
                        .texels = std::vector<glm::vec4>(pixels_.size()),
                        .depths = std::vector<float>(pixels_.size())};
  for (std::uint32_t y = 0; y < size_.height; ++y) putRow(y, image);
  return image;
}

void Film::putRow(std::uint32_t y, spec::RgbaImage& image) const {
  assert(image.width == size_.width && image.height == size_.height && done_[y] > 0);
  for (std::size_t i = std::size_t{y} * size_.width, end = i + size_.width; i < end; ++i) {
    image.texels[i] = glm::vec4(glm::vec3(mean(i)), static_cast<float>(pixels_[i].alpha));
    if (!image.depths.empty()) image.depths[i] = static_cast<float>(pixels_[i].depth);
  }
}

spec::RgbaImage Film::half(std::size_t replica) const {
  spec::RgbaImage half = image();
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    // Samples go alternately to the first and the second replica.
    const double samples = (done_[i / size_.width] + (replica == 0 ? 1 : 0)) / 2;
    half.texels[i] = glm::vec4(glm::vec3(pixels_[i].replicas[replica] / samples), half.texels[i].a);
  }
  return half;
}

std::optional<double> Film::standardError() const {
  double variances = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    if (pixels_[i].alpha < double{spec::kLeastCoverage}) continue;
    const std::uint32_t samples = done_[i / size_.width];
    if (samples < 2) return std::nullopt;
    const double second = samples / 2, first = samples - second, done = samples;
    // For two replicas with means a, b of n, m samples, the variance of (n a + m b)/(n + m) is nm/(n + m)²
    // times that of a - b, if their variances are proportional to 1/n and 1/m.
    const glm::dvec3 apart = pixels_[i].replicas[0] / first - pixels_[i].replicas[1] / second;
    variances += glm::dot(apart, apart) * first * second / (done * done);
    squares += glm::dot(mean(i), mean(i));
  }
  if (!(squares > 0.0)) return std::nullopt;
  return std::sqrt(variances / squares);
}

std::uint32_t samplesInPass(const World& world) {
  const auto& limit = world.options.band_limit;
  if (limit && limit->out) return 256;           // each pass integrates its kernels again
  return world.scene.volumes.empty() ? 16 : 64;  // in volumes most paths end long before the longest
}

bool addSamples(const World& world, Film& film, const Rows& rows, std::uint32_t samples, Progress& progress,
                const std::stop_token& stop) {
  return parallelRanges(rows.last - rows.first, 1, stop, [&](std::size_t begin, std::size_t end) {
    std::vector<PixelSum> row(film.size().width);
    for (std::size_t r = begin; r < end; ++r) {
      const std::uint32_t y = rows.first + static_cast<std::uint32_t>(r), done = film.done(y);
      if (done >= samples) continue;
      for (std::uint32_t x = 0; x < row.size(); ++x) {
        if (stop.stop_requested()) return;
        row[x] = tracePixel(world, x, y, done, samples - done);
      }
      film.addRow(y, samples - done, row);
      progress.add(std::uint64_t{film.size().width} * (samples - done));
    }
  });
}

TracedScene::TracedScene(const Scene& scene, Surfaces built)
    : surfaces(std::move(built)),
      emissive(surfaces),
      punctual(punctualLights(scene)),
      volumes(Volumes::build(scene, notices)),
      rays(RayTracer::build(surfaces)) {}

Result<std::unique_ptr<const TracedScene>> TracedScene::build(const Scene& scene) {
  auto surfaces = Surfaces::build(scene);
  if (!surfaces) return failAgain(std::move(surfaces.error()));
  auto traced = std::make_unique<TracedScene>(scene, std::move(*surfaces));
  if (!traced->rays) return failAgain(std::move(traced->rays.error()));
  return traced;
}

}  // namespace lambent::baker::reference
