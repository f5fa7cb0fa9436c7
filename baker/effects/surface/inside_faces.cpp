#include "baker/effects/surface/inside_faces.hpp"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/transport/face_points.hpp"

namespace lambent::baker {

TracedPoints::TracedPoints(const TracedScene& scene, FacePoints points, const DirectSettings& settings)
    : points_(std::move(points)), scene_(scene.withSamples(points_.samples)), pass_(scene_, settings) {}

bool TracedPoints::look(const BakeContext& context, const char* stage) {
  direct = pass_.untraced();
  return traceDirect(pass_, context, stage, direct);
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

// The same rays are traced as at the vertices. Bounces at diffuse points gather over a part of them, since
// neighbours even out the noise of fewer hits.
DirectSettings settingsInside(DirectSettings settings, std::size_t hit_memory) {
  settings.hit_memory = hit_memory;
  settings.hits_of_every = kThinned;
  return settings;
}

template <typename Values>
auto partOf(Values& values, const SampleStretch& stretch, std::size_t width) {
  return std::span(values).subspan(stretch.begin * width, stretch.size() * width);
}

std::array<SampleStretch, 3> stretchesOf(const SampleSet& samples) {
  return {samples.diffuse, samples.normal_mapped, samples.glossy};
}

// Returns, in ascending order, the triangles of matte draws over which light may change much: those over
// which direct light does, and large ones to which mostly bounced light comes. Colours have no say, so that
// after a change of colours no ray is traced again.
std::vector<std::uint32_t> changingMatte(const TracedScene& scene, const TransferField& direct) {
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

std::vector<std::uint32_t> changingGlossy(const TracedScene& scene, const GlossyField& direct) {
  auto triangles = changingTriangles(scene.geometry, scene.samples, scene.samples.glossy,
                                     direct.visibilitySize(), direct.visibility);
  std::erase_if(triangles, [&](std::uint32_t t) { return !scene.matters(t); });
  return triangles;
}

}  // namespace

InsideFaces::InsideFaces(const DirectPass& vertices, SurfacePart part,
                         std::span<const std::uint32_t> triangles, std::size_t hit_memory)
    : vertices_(vertices.scene()),
      part_(part),
      points_(vertices_, facePoints(vertices_.geometry, vertices_.samples, triangles),
              settingsInside(vertices.settings(), hit_memory)) {}

bool InsideFaces::look(const BakeContext& context) {
  if (!points_.look(context, "inside faces")) return false;
  const auto of_vertices = stretchesOf(vertices_.samples), of_points = stretchesOf(points_.points().samples);
  for (std::size_t kind = 0; kind < of_vertices.size(); ++kind) {
    if (of_points[kind].empty()) continue;
    fits_[kind].emplace(vertices_.geometry, vertices_.samples, of_vertices[kind], points_.points(),
                        of_points[kind], points_.direct.looks.valid);
  }
  return true;
}

bool InsideFaces::fitDirect(DirectResult& at_vertices, const std::stop_token& stop) {
  DirectResult& found = points_.direct;
  if (part_ == SurfacePart::Matte)
    return fit(found.field, 1.0f, at_vertices.field, stop) &&
           fit(SampleKind::NormalMapped, found.mapped.vectors, at_vertices.mapped.vectors, stop);
  // Bounces need no direct light of points, whose visibility is large.
  const std::vector<float> visibility = std::exchange(found.glossy.visibility, {}),
                           lights = std::exchange(found.glossy.lights_shadowed, {});
  return fit(SampleKind::Glossy, visibility, at_vertices.glossy.visibility, stop) &&
         fit(SampleKind::Glossy, lights, at_vertices.glossy.lights_shadowed, stop);
}

bool InsideFaces::fit(const TransferField& at_points, float most, TransferField& at_vertices,
                      const std::stop_token& stop) const {
  const SampleSet &of_points = points_.points().samples, &of_vertices = vertices_.samples;
  const std::size_t width = at_vertices.vectorSize();
  const TransferField before = at_vertices;
  const auto fitStretch = [&](SampleKind kind, const SampleStretch& from, const SampleStretch& to) {
    return fit(kind, partOf(at_points.vectors, from, width), partOf(at_vertices.vectors, to, width), stop);
  };
  if (!fitStretch(SampleKind::Diffuse, of_points.diffuse, of_vertices.diffuse) ||
      !fitStretch(SampleKind::NormalMapped, of_points.normal_mapped, of_vertices.normal_mapped))
    return false;
  for (std::size_t s = 0; s < of_vertices.glossy.begin; ++s) {
    const auto from = before.at(s);
    const auto to = at_vertices.at(s);
    const float share = shareWithin(from, to, before.columns, most / kUniform);
    if (share < 1.0f)
      for (std::size_t i = 0; i < to.size(); ++i) to[i] = from[i] + share * (to[i] - from[i]);
  }
  return true;
}

bool InsideFaces::fit(SampleKind kind, std::span<const float> at_points, std::span<float> at_vertices,
                      const std::stop_token& stop) const {
  const auto index = static_cast<std::size_t>(kind);
  if (at_vertices.empty() || !fits_[index]) return true;
  const std::size_t width = at_vertices.size() / stretchesOf(vertices_.samples)[index].size();
  return fits_[index]->apply(width, at_points, at_vertices, stop);
}

bool fitInsideFaces(const DirectPass& vertices, SurfacePart part, const BakeContext& context,
                    DirectResult& direct, std::unique_ptr<InsideFaces>& inside) {
  const auto triangles = part == SurfacePart::Glossy ? changingGlossy(vertices.scene(), direct.glossy)
                                                     : changingMatte(vertices.scene(), direct.field);
  if (triangles.empty()) return true;
  KeyMaker key = KeyMaker::ofStage("inside faces");
  const BakeContext own =
      context.keeps() ? context.keyed(key.add(context.key).addList(triangles).key()) : context;
  inside = std::make_unique<InsideFaces>(vertices, part, triangles, direct.of(part).hits.bytesLeft());
  return inside->look(own) && inside->fitDirect(direct, context.stop);
}

}  // namespace lambent::baker
