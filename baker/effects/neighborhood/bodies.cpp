#include "baker/effects/neighborhood/bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/transport/panes.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

namespace {

// From this roughness on, five bands represent nine tenths of a highlight (docs/design/glossy.md), so
// matrices of few bands are enough.
constexpr float kRoughEnough = 0.5f;
// Paths per ray that hits a highlight: a mirror needs one, and with rougher surfaces neighbouring rays share
// the sampling.
constexpr float kMirrorRoughness = 0.1f;
constexpr std::size_t kRoughPaths = 2;
constexpr int kMostReflections = 32;
// Offset from a surface at which paths continue, relative to the body's radius.
constexpr float kClear = 1e-5f;

std::size_t pathsFor(float roughness) {
  return roughness < kMirrorRoughness ? 1 : kRoughPaths;
}

}  // namespace

SurfaceBody::SurfaceBody(const TracedScene& scene, const BakedSurfaces& baked)
    : scene_(scene), brdfs_(baked.brdfs), order_(baked.direct.order) {
  const GroupGeometry& geometry = scene.geometry;
  centre_ = 0.5f * (geometry.bounds_min + geometry.bounds_max);
  float square = 0.0f;
  for (const glm::uvec3& t : geometry.triangles)
    for (const std::uint32_t v : {t.x, t.y, t.z}) {
      const glm::vec3 to = geometry.positions[v] - centre_;
      square = std::max(square, glm::dot(to, to));
    }
  radius_ = std::sqrt(square);
  if (!baked.sends) return;

  channels_ = baked.direct.channels;
  const auto columns = static_cast<std::size_t>(sh::coefficientCount(order_));
  const std::size_t samples = baked.direct.size();
  diffuse_.resize(samples * channels_ * columns);
  float* out = diffuse_.data();
  for (std::size_t s = 0; s < samples; ++s)
    for (std::size_t c = 0; c < channels_; ++c)
      for (std::size_t i = 0; i < columns; ++i, ++out)
        *out = baked.direct.at(s)[c * baked.direct.columns + i] +
               (baked.bounced ? baked.bounced->at(s)[c * baked.bounced->columns + i] : 0.0f);
  if (!brdfs_) return;

  const GlossyField& field = *baked.glossy;
  const sh::GauntTable gaunt = sh::makeGauntTable(field.order_in, field.order_out);
  matrix_outputs_ = static_cast<std::size_t>(sh::coefficientCount(field.order_out));
  matrix_channels_ = field.bounced.empty() ? 1 : field.channels;
  const std::size_t size = matrix_outputs_ * columns;
  matrices_.assign(field.size() * matrix_channels_ * size, 0.0f);
  parallelRanges(field.size(), kSamplesPerRange, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t c = 0; c < matrix_channels_; ++c) {
        const std::size_t at = (s * matrix_channels_ + c) * size;
        const auto matrix = std::span(matrices_).subspan(at, size);
        sh::addVisibilityMatrix(gaunt, field.visibilityOf(s), matrix);
        if (!field.bounced.empty())
          for (std::size_t i = 0; i < size; ++i) matrix[i] += field.bounced[at + i];
      }
  });
}

SurfaceBody::Way SurfaceBody::wayOf(const FirstHit& hit) const {
  if (!brdfs_ || !brdfs_->glossy(hit.triangle)) return Way::Matte;
  return brdfs_->roughness(hit.triangle, hit.u, hit.v) < kRoughEnough ? Way::Path : Way::Kernel;
}

void SurfaceBody::addPlain(const FirstHit& hit, const glm::vec3& scale, std::span<float> out) const {
  const glm::uvec3 t = scene_.geometry.triangles[hit.triangle];
  const auto columns = static_cast<std::size_t>(sh::coefficientCount(order_));
  const auto of = [&](std::uint32_t vertex) {
    return diffuse_.data() + scene_.samples.vertex_sample[vertex] * channels_ * columns;
  };
  const float *a = of(t.x), *b = of(t.y), *c = of(t.z);
  float* sum = out.data();
  for (std::uint32_t channel = 0; channel < channels_; ++channel) {
    const float factor = scale[static_cast<int>(channel)];
    const float wa = factor * (1.0f - hit.u - hit.v), wb = factor * hit.u, wc = factor * hit.v;
    for (std::size_t i = 0; i < columns; ++i) sum[i] += wa * a[i] + wb * b[i] + wc * c[i];
    a += columns, b += columns, c += columns, sum += columns;
  }
}

void SurfaceBody::addDiffuse(const FirstHit& hit, const glm::vec3& scale, std::span<float> out) const {
  addPlain(hit, scale * scene_.colors.albedo(hit.triangle, hit.u, hit.v), out);
}

void SurfaceBody::addKernel(const FirstHit& hit, const glm::vec3& along, float chance, const glm::vec3& scale,
                            std::span<float> out) const {
  std::array<float, 3 * 36> kernel;
  brdfs_->exitKernel(hit.triangle, hit.u, hit.v, -along, std::span(kernel).first(3 * matrix_outputs_));
  const glm::uvec3 t = scene_.geometry.triangles[hit.triangle];
  const std::uint32_t corner = chance < hit.u ? t.y : chance < hit.u + hit.v ? t.z : t.x;
  const std::size_t sample = scene_.samples.vertex_sample[corner] - scene_.samples.glossy.begin;
  const auto columns = static_cast<std::size_t>(sh::coefficientCount(order_));
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::size_t own = matrix_channels_ == 1 ? 0 : c;
    const float* matrix = matrices_.data() + (sample * matrix_channels_ + own) * matrix_outputs_ * columns;
    for (std::size_t k = 0; k < matrix_outputs_; ++k) {
      const float factor = scale[static_cast<int>(c)] * kernel[c * matrix_outputs_ + k];
      for (std::size_t i = 0; i < columns; ++i) out[c * columns + i] += factor * matrix[k * columns + i];
    }
  }
}

// Follows the paths of a packet's rays that hit highlights, and adds the light at their ends.
class SurfaceBody::Paths {
 public:
  explicit Paths(const SurfaceBody& body)
      : body_(body), columns_(static_cast<std::size_t>(sh::coefficientCount(body.order_))) {}

  // Starts paths at `hit`, which a ray along `along` from `from` has found, by way of panes that pass
  // `passed`. Their light is added to row `row` of the packet.
  void start(const FirstHit& hit, const glm::vec3& from, const glm::vec3& along, const glm::vec3& passed,
             std::size_t ray, std::size_t row) {
    const std::size_t count = pathsFor(body_.brdfs_->roughness(hit.triangle, hit.u, hit.v));
    for (std::size_t p = 0; p < count; ++p)
      paths_.push_back({.hit = hit,
                        .from = from,
                        .along = along,
                        .scale = passed / static_cast<float>(count),
                        .row = row,
                        .number = static_cast<std::uint32_t>(ray * kRoughPaths + p)});
  }

  // `sent` is [row][channel][order²].
  void follow(std::span<float> sent) {
    const std::size_t row_size = body_.channels_ * columns_;
    std::vector<RaySegment> rays;
    std::vector<FirstHit> hits;
    for (std::uint32_t reflection = 0; reflection < kMostReflections && !paths_.empty(); ++reflection) {
      rays.clear();
      std::erase_if(paths_, [&](Path& path) {
        return !reflect(path, reflection, sent.subspan(path.row * row_size, row_size));
      });
      for (const Path& path : paths_)
        rays.push_back({path.from, path.along, std::numeric_limits<float>::infinity()});
      hits.resize(rays.size());
      body_.scene_.rays.firstHits(rays, hits);
      passed_.resize(rays.size());
      for (std::size_t i = 0; i < rays.size(); ++i) rays[i].length = hits[i].distance;
      passedAlong(rays, body_.scene_.rays, body_.scene_.colors, passed_);
      std::size_t next = 0;
      std::erase_if(paths_, [&](Path& path) {
        path.scale *= passed_[next];
        path.hit = hits[next++];
        return !goesOn(path, reflection, sent.subspan(path.row * row_size, row_size));
      });
    }
  }

 private:
  struct Path {
    FirstHit hit;
    glm::vec3 from, along, scale;
    glm::vec3 towards{0.0f};  // direction of incident light at the last highlight
    std::size_t row;
    std::uint32_t number;
  };

  // Adds the diffuse part at a highlight, and directs the path into the highlight. Returns false if the path
  // ends there.
  bool reflect(Path& path, std::uint32_t reflection, std::span<float> out) const {
    const FirstHit& hit = path.hit;
    const PointReflection at = body_.brdfs_->reflection(hit.triangle, hit.u, hit.v, -path.along);
    if (at.diffuse != glm::vec3(0.0f)) body_.addPlain(hit, path.scale * at.diffuse, out);
    const HighlightSample next = sampleHighlight(at, -path.along, choices(path.number, reflection));
    path.scale *= next.weight;
    path.from += hit.distance * path.along + kClear * body_.radius_ * at.geometric;
    path.along = next.ray, path.towards = next.direction;
    return path.scale != glm::vec3(0.0f);
  }

  // Adds the light that the path finds. Returns true if it is at another highlight.
  bool goesOn(const Path& path, std::uint32_t reflection, std::span<float> out) const {
    const FirstHit& hit = path.hit;
    if (!hit.any()) {
      std::array<float, sh::kMaxCoefficients> y;
      sh::evaluate(body_.order_, path.towards, y);
      for (std::size_t c = 0; c < body_.channels_; ++c)
        for (std::size_t i = 0; i < columns_; ++i)
          out[c * columns_ + i] += path.scale[static_cast<int>(c)] * y[i];
      return false;
    }
    if (hit.back) return false;
    switch (body_.wayOf(hit)) {
      case Way::Path:
        return true;
      case Way::Kernel:
        body_.addKernel(hit, path.along, choices(path.number, reflection).x, path.scale, out);
        return false;
      case Way::Matte:
        body_.addDiffuse(hit, path.scale, out);
    }
    return false;
  }

  const SurfaceBody& body_;
  std::size_t columns_;
  std::vector<Path> paths_;
  std::vector<glm::vec3> passed_;
};

void SurfaceBody::look(const glm::vec3& from, const DirectionPacket& along, std::size_t first_ray,
                       bool with_light, BodyLook& out) const {
  std::array<RaySegment, kPacketWidth> rays;
  std::array<FirstHit, kPacketWidth> hits;
  for (std::size_t k = 0; k < kPacketWidth; ++k)
    rays[k] = {from, along[k], std::numeric_limits<float>::infinity()};
  scene_.rays.firstHits(rays, hits);
  std::array<glm::vec3, kPacketWidth> passed;
  for (std::size_t k = 0; k < kPacketWidth; ++k) rays[k].length = hits[k].distance;
  passedAlong(rays, scene_.rays, scene_.colors, passed);
  out.sends = out.backs = 0;
  out.nearest_back = std::numeric_limits<float>::infinity();
  const std::size_t row_size = channels_ * static_cast<std::size_t>(sh::coefficientCount(order_));
  std::optional<Paths> paths;
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const FirstHit& hit = hits[k];
    out.stopped[k] = hit.any() ? 1.0f : 1.0f - meanOf(passed[k]);
    if (!hit.any()) continue;
    const auto bit = static_cast<std::uint16_t>(1u << k);
    if (hit.back) {
      out.backs |= bit;
      if (hit.distance < out.nearest_back) {
        out.nearest_back = hit.distance;
        out.nearest_point = from + hit.distance * along[k];
        const glm::uvec3 t = scene_.geometry.triangles[hit.triangle];
        const auto& positions = scene_.geometry.positions;
        out.nearest_normal =
            glm::normalize(glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]));
      }
      continue;
    }
    if (!with_light || channels_ == 0) continue;
    out.sends |= bit;
    const auto row = std::span(out.sent).subspan(k * row_size, row_size);
    std::fill(row.begin(), row.end(), 0.0f);
    switch (wayOf(hit)) {
      case Way::Matte:
        addDiffuse(hit, passed[k], row);
        break;
      case Way::Kernel:
        addKernel(hit, along[k], choices(static_cast<std::uint32_t>(first_ray + k), 0).x, passed[k], row);
        break;
      case Way::Path:
        if (!paths) paths.emplace(*this);
        paths->start(hit, from, along[k], passed[k], first_ray + k, k);
    }
  }
  if (paths) paths->follow(out.sent);
}

void VolumeBody::look(const glm::vec3& from, const DirectionPacket& along, std::size_t, bool with_light,
                      BodyLook& out) const {
  out.sends = out.backs = 0;
  const std::size_t row_size = 3 * static_cast<std::size_t>(sh::coefficientCount(order_));
  std::array<float, 3 * sh::kMaxCoefficients> unwanted;
  const float far = glm::distance(from, centre_) + radius_;
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const auto row = with_light ? std::span(out.sent).subspan(k * row_size, row_size)
                                : std::span(unwanted).first(row_size);
    std::fill(row.begin(), row.end(), 0.0f);
    const float through = march_(from, along[k], far, row);
    out.stopped[k] = 1.0f - std::clamp(through, 0.0f, 1.0f);
    if (with_light && std::any_of(row.begin(), row.end(), [](float value) { return value != 0.0f; }))
      out.sends |= static_cast<std::uint16_t>(1u << k);
  }
}

}  // namespace lambent::baker
