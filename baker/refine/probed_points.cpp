#include "baker/refine/probed_points.hpp"

#include <bit>
#include <utility>

#include "baker/jobs/stage.hpp"
#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

std::uint32_t ProbedPoints::numberOf(const glm::vec3& position, const glm::vec3& normal, SampleKind kind,
                                     std::span<const SampleOrigin> origins) {
  const auto next = static_cast<std::uint32_t>(seen_.size() + missing_.size());
  // A vertex looks from a little inside the faces around it. Once these are split it looks from elsewhere,
  // and is another point.
  std::uint32_t from = 0;
  for (const SampleOrigin& origin : origins)
    for (int k = 0; k < 3; ++k) from = from * 0x9E3779B1u + std::bit_cast<std::uint32_t>(origin.position[k]);
  VertexKey key = vertexKey(position, normal, kind);
  key.back() = from;
  const auto [entry, is_new] = known_.try_emplace(key, next);
  if (is_new) missing_.push_back({normal, kind, {origins.begin(), origins.end()}});
  return entry->second;
}

bool ProbedPoints::probe(const ProbedScene& scene, const BakeContext& context) {
  const std::vector<Point> points = std::exchange(missing_, {});
  if (points.empty()) return true;
  const std::size_t size = probe_->packets(), first = seen_.size();
  seen_.resize(first + points.size());
  light_.resize(seen_.size());
  masks_.resize(seen_.size() * size);
  const auto masks = std::span(masks_).subspan(first * size);
  const auto compute = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Point& point = points[i];
      seen_[first + i] =
          probe_->look(scene.rays, point.origins, point.normal, point.kind, masks.subspan(i * size, size));
      if (seen_[first + i] != 0) light_[first + i] = scene.light.at(point.origins, point.normal);
    }
  };
  const auto begin = static_cast<std::ptrdiff_t>(first);
  const Stage stage{.count = points.size(),
                    .grain = kPointsPerRange,
                    .writes = {rowsOf(masks, size), rowsOf(seen_, 1, begin), rowsOf(light_, 1, begin)},
                    .compute = compute,
                    .keep = KeepWhen::Always};
  KeyMaker key;
  key.add(scene.key).add(std::uint64_t{probe_->rays()});
  for (const Point& point : points) key.add(point.normal).add(point.kind).addList(point.origins);
  const auto done = runStage(stage, context.keyed(key.key()));
  if (!done) return false;
  traced_ += done->computed * probe_->rays();
  kept_ += done->found * probe_->rays();
  return true;
}

}  // namespace lambent::baker
