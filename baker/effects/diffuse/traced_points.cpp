#include "baker/effects/diffuse/traced_points.hpp"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/transport/face_points.hpp"

namespace lambent::baker {

TracedPoints::TracedPoints(const TracedScene& scene, FacePoints points, const DirectSettings& settings)
    : points_(std::move(points)), scene_(scene.withSamples(points_.samples)), pass_(scene_, settings) {}

bool TracedPoints::look(const BakeContext& context, const char* stage) {
  auto found = bakeDirect(pass_, scene_, context, stage);
  if (!found) return false;
  direct_ = std::move(*found);
  return true;
}

namespace {

// RMS of the change of direct light along a triangle's edges, relative to the light at its corners. Where it
// changes little from corner to corner it is nearly linear, and a fit gains nothing: on scans of 50,000
// vertices it would cost as much as the vertices.
constexpr float kLeastChange = 0.15f;
// Mostly bounced light comes to a triangle that gets less than this share of open light. It is large if an
// edge is at least this share of the extent of what is seen.
constexpr float kMostOpen = 0.5f, kLargeEdge = 1.0f / 256.0f;
// Uniform light of radiance 1 has sqrt(4 pi) as its coefficient 0 and no others.
constexpr float kUniform = 3.54490770f;

float squaredLength(std::span<const float> vector) {
  float sum = 0.0f;
  for (const float value : vector) sum += value * value;
  return sum;
}

float squaredDistance(std::span<const float> a, std::span<const float> b) {
  float sum = 0.0f;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// Returns the largest share, at most 1, of the way between two vectors at which the coefficient 0 of every
// channel is still between 0 and `most`, if it is so at the first.
float shareWithin(std::span<const float> from, std::span<const float> to, std::size_t columns, float most) {
  float share = 1.0f;
  for (std::size_t at = 0; at < from.size(); at += columns) {
    const float bound = to[at] < 0.0f ? 0.0f : most;
    if (to[at] >= 0.0f && to[at] <= most) continue;
    share = std::min(share, std::clamp((bound - from[at]) / (to[at] - from[at]), 0.0f, 1.0f));
  }
  return share;
}

// The same rays are traced as at the vertices. Bounces gather over a part of them, since neighbours even out
// the noise of fewer hits.
DirectSettings settingsInside(DirectSettings settings, std::size_t hit_memory) {
  settings.hit_memory = hit_memory;
  settings.hits_of_every = kThinned;
  return settings;
}

template <typename Values>
auto partOf(Values& values, const SampleStretch& stretch, std::size_t width) {
  return std::span(values).subspan(stretch.begin * width, stretch.size() * width);
}

}  // namespace

std::vector<std::uint32_t> changingDiffuse(const TracedScene& scene, const TransferField& direct) {
  const GroupGeometry& geometry = scene.geometry;
  const SampleSet& samples = scene.samples;
  const float large =
      kLargeEdge *
      (scene.importance ? scene.importance->extent : glm::distance(geometry.bounds_min, geometry.bounds_max));
  const std::size_t width = direct.vectorSize();
  std::vector<std::uint8_t> changes(geometry.triangles.size(), 0);
  for (const SampleStretch& stretch : {samples.diffuse, samples.normal_mapped})
    for (const std::uint32_t t :
         changingTriangles(geometry, samples, stretch, width, partOf(direct.vectors, stretch, width)))
      changes[t] = 1;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t t = 0; t < geometry.triangles.size(); ++t) {
    const glm::uvec3 corners = geometry.triangles[t];
    if (samples.vertex_sample[corners.x] >= samples.glossy.begin || !scene.matters(t)) continue;
    float change = 0.0f, light = 0.0f, open = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const auto here = direct.at(samples.vertex_sample[corners[c]]);
      change += squaredDistance(here, direct.at(samples.vertex_sample[corners[(c + 1) % 3]]));
      light += squaredLength(here);
      open += kUniform * here[0] / 3.0f;
    }
    if ((changes[t] != 0 && change >= kLeastChange * kLeastChange * light) ||
        (open < kMostOpen && longestEdge(geometry, corners) >= large))
      triangles.push_back(t);
  }
  return triangles;
}

DiffuseInsideFaces::DiffuseInsideFaces(const DirectPass& vertices, const TracedScene& scene,
                                       std::span<const std::uint32_t> triangles, std::size_t hit_memory)
    : vertices_(scene),
      points_(scene, facePoints(scene.geometry, scene.samples, triangles),
              settingsInside(vertices.settings(), hit_memory)) {}

bool DiffuseInsideFaces::look(const BakeContext& context) {
  if (!points_.look(context, "inside faces")) return false;
  const FacePoints& points = points_.points();
  const auto& valid = points_.direct().looks.valid;
  const GroupGeometry& geometry = vertices_.geometry;
  const SampleSet& samples = vertices_.samples;
  plain_.emplace(geometry, samples, samples.diffuse, points, points.samples.diffuse, valid);
  mapped_.emplace(geometry, samples, samples.normal_mapped, points, points.samples.normal_mapped, valid);
  return true;
}

bool DiffuseInsideFaces::fit(const TransferField& at_points, float most, TransferField& at_vertices,
                             const std::stop_token& stop) const {
  const SampleSet &of_points = points_.points().samples, &of_vertices = vertices_.samples;
  const std::size_t width = at_vertices.vectorSize();
  const TransferField before = at_vertices;
  const bool fitted = plain_->apply(width, partOf(at_points.vectors, of_points.diffuse, width),
                                    partOf(at_vertices.vectors, of_vertices.diffuse, width), stop) &&
                      mapped_->apply(width, partOf(at_points.vectors, of_points.normal_mapped, width),
                                     partOf(at_vertices.vectors, of_vertices.normal_mapped, width), stop);
  if (!fitted) return false;
  for (std::size_t s = 0; s < of_vertices.glossy.begin; ++s) {
    const auto from = before.at(s);
    const auto to = at_vertices.at(s);
    const float share = shareWithin(from, to, before.columns, most / kUniform);
    if (share < 1.0f)
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[i] + share * (to[i] - from[i]);
  }
  return true;
}

bool DiffuseInsideFaces::fitMapped(const TransferField& at_points, TransferField& at_vertices,
                                   const std::stop_token& stop) const {
  return mapped_->apply(at_vertices.vectorSize(), at_points.vectors, at_vertices.vectors, stop);
}

}  // namespace lambent::baker
