#include "baker/refine/probed_points.hpp"

#include <bit>
#include <utility>

#include "baker/jobs/stage.hpp"
#include "baker/transport/geometry_key.hpp"

namespace lambent::baker {

Result<const RayScene*> ProbedScene::rays() {
  if (!rays_) {
    auto built = build_();
    if (!built) return failAgain(built.error());
    rays_ = std::move(*built);
  }
  return &*rays_;
}

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

Result<bool> ProbedPoints::probe(ProbedScene& scene, const BakeContext& context) {
  const std::vector<Point> points = std::exchange(missing_, {});
  if (points.empty()) return true;
  const std::size_t size = probe_->packets(), first = seen_.size();
  seen_.resize(first + points.size());
  masks_.resize(seen_.size() * size);
  const auto masks = std::span(masks_).subspan(first * size);
  const RayScene* rays = nullptr;
  const auto compute = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      seen_[first + i] = probe_->look(*rays, points[i].origins, points[i].normal, points[i].kind,
                                      masks.subspan(i * size, size));
  };
  const Stage stage{.count = points.size(),
                    .grain = kPointsPerRange,
                    .writes = {rowsOf(masks, size), rowsOf(seen_, 1, static_cast<std::ptrdiff_t>(first))},
                    .compute = compute,
                    .keep = KeepWhen::Always};
  KeyMaker key;
  key.add(scene.key()).add(std::uint64_t{probe_->rays()});
  for (const Point& point : points) key.add(point.normal).add(point.kind).addList(point.origins);
  const BakeContext own = context.keyed(key.key());
  if (restoreStage(stage, own)) {
    kept_ += points.size() * probe_->rays();
    return true;
  }
  const auto built = scene.rays();
  if (!built) return failAgain(built.error());
  rays = *built;
  const auto done = runStage(stage, own);
  if (!done) return false;
  traced_ += done->computed * probe_->rays();
  kept_ += done->found * probe_->rays();
  return true;
}

}  // namespace lambent::baker
