#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/light_probes/light_probes.hpp"
#include "baker/proxy/capture_proxy.hpp"

namespace lambent::baker {

std::vector<SurfacePoint> pointsOn(const GroupGeometry& geometry, std::span<const std::uint32_t> triangles,
                                   std::size_t count) {
  std::vector<double> sums;
  double sum = 0.0;
  for (const std::uint32_t triangle : triangles)
    sums.push_back(sum += triangleArea(geometry, geometry.triangles[triangle]));
  std::vector<SurfacePoint> points;
  if (!(sum > 0.0) || !std::isfinite(sum)) return points;
  const double step = sum / static_cast<double>(count);
  constexpr double kRoot = 1.32471795724474602596;  // the real root of x³ = x + 1
  std::size_t at = 0;
  for (std::size_t i = 0; i < count; ++i) {
    while (at + 1 < sums.size() && sums[at] <= (static_cast<double>(i) + 0.5) * step) ++at;
    double u = std::fmod(0.5 + static_cast<double>(i) / kRoot, 1.0);
    double v = std::fmod(0.5 + static_cast<double>(i) / (kRoot * kRoot), 1.0);
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    points.push_back({triangles[at], static_cast<float>(u), static_cast<float>(v), static_cast<float>(step)});
  }
  return points;
}

namespace {

constexpr std::size_t kCoveragePoints = 256;
constexpr float kLeastCoverage = 0.5f;

std::vector<std::uint32_t> trianglesOf(const DrawGeometry& draw) {
  std::vector<std::uint32_t> triangles(draw.triangle_count);
  std::iota(triangles.begin(), triangles.end(), draw.first_triangle);
  return triangles;
}

bool isSeen(const GroupGeometry& geometry, const SurfaceColors& colors,
            const std::vector<std::uint32_t>& triangles) {
  float sum = 0.0f;
  for (const SurfacePoint& point : pointsOn(geometry, triangles, kCoveragePoints))
    sum += colors.coverage(point.triangle, point.u, point.v);
  return sum >= kLeastCoverage * float{kCoveragePoints};
}

ProxyPart& partFor(std::uint32_t light, bool two_sided, std::vector<ProxyPart>& parts) {
  const auto found = std::find_if(parts.begin(), parts.end(), [&](const ProxyPart& part) {
    return part.light == light && part.two_sided == two_sided;
  });
  return found != parts.end() ? *found : parts.emplace_back(ProxyPart{light, two_sided, {}, {}});
}

void append(const std::vector<std::uint32_t>& from, std::vector<std::uint32_t>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

float partArea(const GroupGeometry& geometry, const ProxyPart& part) {
  float sum = 0.0f;
  for (const std::uint32_t triangle : part.front)
    sum += static_cast<float>(triangleArea(geometry, geometry.triangles[triangle]));
  return sum;
}

void darkenSmallest(const GroupGeometry& geometry, std::vector<ProxyPart>& parts) {
  std::size_t smallest = parts.size();
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (parts[p].light != kNoLight &&
        (smallest == parts.size() || partArea(geometry, parts[p]) < partArea(geometry, parts[smallest])))
      smallest = p;
  const ProxyPart darkened = std::move(parts[smallest]);
  parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(smallest));
  ProxyPart& dark = partFor(kNoLight, darkened.two_sided, parts);
  append(darkened.front, dark.front);
  append(darkened.back, dark.back);
}

}  // namespace

std::vector<ProxyPart> proxyParts(const GroupGeometry& geometry, const SurfaceColors& colors,
                                  std::size_t most) {
  std::vector<ProxyPart> parts;
  for (std::size_t d = 0; d < geometry.draws.size(); ++d) {
    const DrawGeometry& draw = geometry.draws[d];
    if (draw.back || draw.triangle_count == 0) continue;  // taken with its front
    const std::vector<std::uint32_t> triangles = trianglesOf(draw);
    if (!isSeen(geometry, colors, triangles)) continue;
    const bool two_sided = d + 1 < geometry.draws.size() && geometry.draws[d + 1].back;
    ProxyPart& part = partFor(colors.lightOf(draw.first_triangle), two_sided, parts);
    append(triangles, part.front);
    if (two_sided) append(trianglesOf(geometry.draws[d + 1]), part.back);
  }
  const auto sides = [&] {
    return std::accumulate(parts.begin(), parts.end(), std::size_t{0},
                           [](std::size_t sum, const ProxyPart& part) { return sum + part.sides(); });
  };
  while (sides() > most) darkenSmallest(geometry, parts);
  return parts;
}

namespace {

constexpr std::size_t kGrain = 256;

struct Sums {
  double weight = 0.0;
  glm::dvec3 reflected{0.0};
};

struct FaceSums {
  std::map<std::uint32_t, Sums> samples;
  double area = 0.0;
  glm::dvec3 emitted{0.0};
};

glm::vec3 faceNormal(const std::array<glm::vec3, 3>& c) {
  const glm::vec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
  const float length = glm::length(n);
  return length > 0.0f ? n / length : glm::vec3(0.0f);
}

float faceArea(const std::array<glm::vec3, 3>& c) {
  return 0.5f * glm::length(glm::cross(c[1] - c[0], c[2] - c[0]));
}

// Returns the point of a triangle that is nearest to p (Ericson 2005, section 5.1.5).
glm::vec3 nearestOf(const std::array<glm::vec3, 3>& t, glm::vec3 p) {
  const glm::vec3 ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
  const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0.0f && d2 <= 0.0f) return t[0];
  const glm::vec3 bp = p - t[1];
  const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0.0f && d4 <= d3) return t[1];
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) return t[0] + d1 / (d1 - d3) * ab;
  const glm::vec3 cp = p - t[2];
  const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0.0f && d5 <= d6) return t[2];
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) return t[0] + d2 / (d2 - d6) * ac;
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0.0f && d4 - d3 >= 0.0f && d5 - d6 >= 0.0f)
    return t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1]);
  const float sum = va + vb + vc;
  return sum > 0.0f ? t[0] + vb / sum * ab + vc / sum * ac : t[0];
}

// Compares faces and points by squared distance and facing. Facing 90 degrees apart counts as much as the
// size of a mean face; facing away from each other counts more than any distance.
class Likeness {
 public:
  Likeness(std::span<const ProxyFace> faces, const std::vector<std::uint32_t>& own) : faces_(faces) {
    double area = 0.0;
    for (const std::uint32_t f : own) {
      const auto& c = faces[f].corners;
      normals_.push_back(faceNormal(c));
      centres_.push_back((c[0] + c[1] + c[2]) / 3.0f);
      radii_.push_back(std::max({glm::distance(c[0], centres_.back()), glm::distance(c[1], centres_.back()),
                                 glm::distance(c[2], centres_.back())}));
      area += double{faceArea(faces[f].corners)};
    }
    size_ = static_cast<float>(area / static_cast<double>(std::max<std::size_t>(own.size(), 1)));
  }

  // A quick test: returns true if the face certainly lies farther than `reach_m`.
  bool beyond(std::size_t place, const ShiningPoint& point, float reach_m) const {
    const glm::vec3 d = centres_[place] - point.position;
    const float sum = reach_m + radii_[place];
    return glm::dot(d, d) >= sum * sum;
  }
  float cost(std::size_t place, std::uint32_t face, const ShiningPoint& point) const {
    const glm::vec3 d = nearestOf(faces_[face].corners, point.position) - point.position;
    const float facing = glm::dot(normals_[place], point.normal);
    const float turned = size_ * (1.0f - facing);
    return glm::dot(d, d) + (facing < 0.0f ? kAway * turned : turned);
  }

 private:
  static constexpr float kAway = 1e4f;
  std::span<const ProxyFace> faces_;
  std::vector<glm::vec3> normals_, centres_;
  std::vector<float> radii_;
  float size_ = 0.0f;
};

void add(const ShiningPoint& point, const GroupGeometry& geometry, const SampleSet& samples, FaceSums& sums) {
  const glm::uvec3 triangle = geometry.triangles[point.at.triangle];
  const glm::vec3 corner_weights(1.0f - point.at.u - point.at.v, point.at.u, point.at.v);
  for (int corner = 0; corner < 3; ++corner) {
    Sums& sample = sums.samples[samples.vertex_sample[triangle[corner]]];
    const double weight = double{point.at.area} * double{std::max(corner_weights[corner], 0.0f)};
    sample.weight += weight;
    sample.reflected += weight * glm::dvec3(point.reflectance);
  }
  sums.area += double{point.at.area};
  sums.emitted += double{point.at.area} * glm::dvec3(point.emission);
}

// Chooses a few samples that stand for all of a face: those nearest to the centres of as many clusters.
std::vector<std::uint32_t> chosenSamples(const std::map<std::uint32_t, Sums>& of, const SampleSet& samples) {
  std::vector<std::uint32_t> all;
  std::vector<glm::vec3> places;
  std::vector<float> weights;
  for (const auto& [sample, sums] : of) {
    all.push_back(sample);
    places.push_back(samples.positions[sample]);
    weights.push_back(static_cast<float>(sums.weight));
  }
  if (all.size() <= bundle::kMaxProxyEntries) return all;
  std::vector<std::uint32_t> chosen;
  for (const glm::vec3& centre : lightPoints(places, weights, bundle::kMaxProxyEntries)) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < all.size(); ++i)
      if (glm::distance(places[i], centre) < glm::distance(places[nearest], centre)) nearest = i;
    chosen.push_back(all[nearest]);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

std::vector<bundle::ProxyEntry> entriesOf(const FaceSums& face, const SampleSet& samples) {
  const std::vector<std::uint32_t> chosen = chosenSamples(face.samples, samples);
  std::vector<glm::dvec3> sums(chosen.size(), glm::dvec3(0.0));
  double weight = 0.0;
  for (const auto& [sample, own] : face.samples) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < chosen.size(); ++k)
      if (glm::distance(samples.positions[sample], samples.positions[chosen[k]]) <
          glm::distance(samples.positions[sample], samples.positions[chosen[nearest]]))
        nearest = k;
    sums[nearest] += own.reflected;
    weight += own.weight;
  }
  std::vector<bundle::ProxyEntry> entries;
  for (std::size_t k = 0; k < chosen.size(); ++k)
    if (sums[k] != glm::dvec3(0.0) && weight > 0.0)
      entries.push_back({chosen[k], glm::vec3(sums[k] / weight)});
  return entries;
}

// Assigns points to the faces of one side of one part.
void dealOut(std::span<const ProxyFace> faces, const std::vector<std::uint32_t>& own,
             const std::vector<ShiningPoint>& points, const GroupGeometry& geometry, const SampleSet& samples,
             std::vector<FaceSums>& sums) {
  if (own.empty() || points.empty()) return;
  const Likeness likeness(faces, own);
  std::vector<std::uint32_t> face_of(points.size());
  parallelRanges(points.size(), kGrain, {}, [&](std::size_t begin, std::size_t end) {
    std::size_t best = 0;  // neighbours in the list are neighbours on the surface
    for (std::size_t i = begin; i < end; ++i) {
      float least = likeness.cost(best, own[best], points[i]), reach_m = std::sqrt(least);
      for (std::size_t k = 0; k < own.size(); ++k) {
        if (likeness.beyond(k, points[i], reach_m)) continue;
        if (const float cost = likeness.cost(k, own[k], points[i]); cost < least)
          least = cost, reach_m = std::sqrt(cost), best = k;
      }
      face_of[i] = own[best];
    }
  });
  for (std::size_t i = 0; i < points.size(); ++i) add(points[i], geometry, samples, sums[face_of[i]]);
  // A face that got no point takes the one that is most like it.
  for (std::size_t k = 0; k < own.size(); ++k) {
    if (sums[own[k]].area > 0.0) continue;
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      if (likeness.cost(k, own[k], points[i]) < likeness.cost(k, own[k], points[nearest])) nearest = i;
    add(points[nearest], geometry, samples, sums[own[k]]);
  }
}

}  // namespace

std::vector<ShiningPoint> shiningPoints(const GroupGeometry& geometry, const SurfaceColors& colors,
                                        std::span<const std::uint32_t> triangles, bool gives_light,
                                        std::size_t count) {
  std::vector<ShiningPoint> points;
  for (const SurfacePoint& at : pointsOn(geometry, triangles, count)) {
    const glm::uvec3 t = geometry.triangles[at.triangle];
    const std::array<glm::vec3, 3> corners = {geometry.positions[t.x], geometry.positions[t.y],
                                              geometry.positions[t.z]};
    points.push_back({at, (1.0f - at.u - at.v) * corners[0] + at.u * corners[1] + at.v * corners[2],
                      faceNormal(corners),
                      colors.coverage(at.triangle, at.u, at.v) * colors.albedo(at.triangle, at.u, at.v),
                      gives_light ? colors.emission(at.triangle, at.u, at.v) : glm::vec3(0.0f)});
  }
  return points;
}

std::vector<FaceShine> shineOf(std::span<const ProxyFace> faces,
                               std::span<const std::array<std::vector<ShiningPoint>, 2>> points,
                               const GroupGeometry& geometry, const SampleSet& samples) {
  std::vector<FaceSums> sums(faces.size());
  std::vector<FaceShine> shine(faces.size());
  for (std::uint32_t part = 0; part < points.size(); ++part)
    for (const bool back : {false, true}) {
      std::vector<std::uint32_t> own;
      for (std::uint32_t f = 0; f < faces.size(); ++f)
        if (faces[f].part == part && faces[f].back == back) own.push_back(f);
      const std::vector<ShiningPoint>& side = points[part][back ? 1 : 0];
      dealOut(faces, own, side, geometry, samples, sums);

      glm::dvec3 given(0.0), found(0.0);
      for (const ShiningPoint& point : side) given += double{point.at.area} * glm::dvec3(point.emission);
      for (const std::uint32_t f : own)
        if (sums[f].area > 0.0) found += double{faceArea(faces[f].corners)} * sums[f].emitted / sums[f].area;
      for (const std::uint32_t f : own) {
        if (!(sums[f].area > 0.0)) continue;
        shine[f].entries = entriesOf(sums[f], samples);
        for (int channel = 0; channel < 3; ++channel)
          if (found[channel] > 0.0)
            shine[f].emission[channel] =
                static_cast<float>(sums[f].emitted[channel] / sums[f].area * given[channel] / found[channel]);
      }
    }
  return shine;
}

}  // namespace lambent::baker
