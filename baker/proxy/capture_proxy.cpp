#include "baker/proxy/capture_proxy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

namespace lambent::baker {

namespace {

constexpr std::array<std::size_t, 3> kLevels = {bundle::kMaxProxyTriangles, 64, 16};
constexpr std::size_t kLeastTriangles = 4;  // per side of a part
constexpr std::size_t kPointsPerTriangle = 128, kPointsPerPatch = 16;
constexpr std::size_t kTrianglesPerPatch = 2;  // of the group
// Patches show no less than this share of the extent of what is seen (runtime/lighting/patches.cpp).
constexpr float kPatchError = 2e-3f;
// Larger surfaces are simplified to this many triangles before their silhouette is taken.
constexpr std::size_t kSilhouetteTriangles = 32768;
// A level is worth having if it has at most this share of the triangles of the one before.
constexpr double kFewer = 0.75;

double meshArea(const SimpleMesh& mesh) {
  double sum = 0.0;
  for (const glm::uvec3& t : mesh.triangles)
    sum += 0.5 * double{glm::length(glm::cross(mesh.positions[t.y] - mesh.positions[t.x],
                                               mesh.positions[t.z] - mesh.positions[t.x]))};
  return sum;
}

// Returns how many triangles each part may have, so that all sides together have `most`: by area, but at
// least kLeastTriangles, or as many as the part has. Returns nothing if that is too many.
std::optional<std::vector<std::size_t>> shares(const std::vector<ProxyPart>& parts,
                                               const std::vector<SimpleMesh>& meshes, std::size_t most) {
  std::vector<std::size_t> counts;
  std::size_t taken = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    counts.push_back(std::min(meshes[p].triangles.size(), kLeastTriangles));
    taken += counts[p] * parts[p].sides();
  }
  if (taken > most) return std::nullopt;
  // The rest goes by area to the parts that can use it, until none can.
  for (;;) {
    double area = 0.0;
    for (std::size_t p = 0; p < parts.size(); ++p)
      if (counts[p] < meshes[p].triangles.size())
        area += meshArea(meshes[p]) * static_cast<double>(parts[p].sides());
    const auto left = static_cast<double>(most - taken);
    std::size_t given = 0;
    for (std::size_t p = 0; p < parts.size() && area > 0.0; ++p) {
      const std::size_t more = std::min(static_cast<std::size_t>(left * meshArea(meshes[p]) / area),
                                        meshes[p].triangles.size() - counts[p]);
      counts[p] += more;
      given += more * parts[p].sides();
    }
    if (given == 0) return counts;
    taken += given;
  }
}

// All patches of a triangle are of one size, and what they send counts alike. A ground that reaches far
// beyond what eyes see, and under the walls of their room, is therefore cut into triangles that grow with the
// distance. Makes at most `most` cuts and returns how many.
std::size_t cutWide(SimpleMesh& mesh, const Importance& importance, std::size_t most) {
  constexpr float kWide = 4.0f, kNear = 0.0625f, kGrowth = 0.5f;  // in extents of what is seen
  const float extent = importance.extent();
  const auto edge = [&](const glm::uvec3& t, int k) {
    return glm::distance(mesh.positions[t[k]], mesh.positions[t[(k + 1) % 3]]);
  };
  const auto longest = [&](const glm::uvec3& t) {
    const std::array lengths = {edge(t, 0), edge(t, 1), edge(t, 2)};
    return static_cast<int>(std::ranges::max_element(lengths) - lengths.begin());
  };
  std::deque<glm::uvec3> wide;
  std::vector<glm::uvec3> done;
  for (const glm::uvec3& t : mesh.triangles)
    if (edge(t, longest(t)) > kWide * extent)
      wide.push_back(t);
    else
      done.push_back(t);
  std::size_t cuts = 0;
  for (; !wide.empty(); wide.pop_front()) {
    const glm::uvec3 t = wide.front();
    const int k = longest(t);
    const float length = edge(t, k);
    const glm::vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0f;
    const float away = glm::distance(middle, importance.middle()) - length - 0.5f * extent;
    if (length <= std::max(kNear * extent, kGrowth * away) || cuts == most) {
      done.push_back(t);
      continue;
    }
    ++cuts;
    const auto cut = static_cast<std::uint32_t>(mesh.positions.size());
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
    mesh.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
    wide.push_back({a, cut, c});
    wide.push_back({cut, b, c});
  }
  mesh.triangles = std::move(done);
  return cuts;
}

class ProxyMaker {
 public:
  ProxyMaker(const GroupGeometry& geometry, const SampleSet& samples, const SurfaceColors& colors,
             const Importance& importance)
      : geometry_(geometry), samples_(samples), colors_(colors), importance_(importance) {
    parts_ = proxyParts(geometry, colors, bundle::kMaxProxyTriangles / kLeastTriangles);
    for (const ProxyPart& part : parts_) meshes_.push_back(welded(geometry, part.front));
    for (std::size_t p = parts_.size(); p-- > 0;)
      if (meshes_[p].triangles.empty()) {
        parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(p));
        meshes_.erase(meshes_.begin() + static_cast<std::ptrdiff_t>(p));
      }
  }

  bundle::CaptureProxy make() {
    for (const std::size_t most : kLevels) {
      if (parts_.empty()) break;
      const auto counts = shares(parts_, meshes_, most);
      if (!counts) break;
      std::vector<SimpleMesh> simple;
      for (std::size_t p = 0; p < parts_.size(); ++p) simple.push_back(simplified(meshes_[p], (*counts)[p]));
      const std::size_t triangles = trianglesOf(simple);
      if (!proxy_.levels.empty() &&
          static_cast<double>(triangles) > kFewer * static_cast<double>(proxy_.levels.back().triangle_count))
        continue;
      if (points_.empty()) points_ = pointsOn(simple, kPointsPerTriangle);
      growToSilhouette(simple);
      addLevel(simple);
    }
    addPatches();
    for (glm::vec3& position : proxy_.positions) position += geometry_.origin;
    return std::move(proxy_);
  }

 private:
  std::size_t trianglesOf(const std::vector<SimpleMesh>& meshes) const {
    std::size_t sum = 0;
    for (std::size_t p = 0; p < meshes.size(); ++p) sum += meshes[p].triangles.size() * parts_[p].sides();
    return sum;
  }

  using PartPoints = std::vector<std::array<std::vector<ShiningPoint>, 2>>;  // by part and side

  // Returns as many points as these triangles can use; coarser levels use those of the finest.
  PartPoints pointsOn(const std::vector<SimpleMesh>& simple, std::size_t per_triangle) const {
    PartPoints points;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const std::size_t count = per_triangle * std::max<std::size_t>(simple[p].triangles.size(), 4);
      const bool gives_light = parts_[p].light != kNoLight;
      points.push_back({shiningPoints(geometry_, colors_, parts_[p].front, gives_light, count),
                        shiningPoints(geometry_, colors_, parts_[p].back, gives_light, count)});
    }
    return points;
  }

  // A few triangles between points of a round surface lie inside of it and look smaller, so they grow until
  // they cover as much.
  void growToSilhouette(std::vector<SimpleMesh>& simple) {
    if (!outline_) {
      std::vector<SimpleMesh> shown;
      for (const SimpleMesh& mesh : meshes_)
        shown.push_back(mesh.triangles.size() > kSilhouetteTriangles ? simplified(mesh, kSilhouetteTriangles)
                                                                     : mesh);
      outline_.emplace(shown);
    }
    const float scale = outline_->scaleOf(simple);
    const glm::vec3 centre = 0.5f * (geometry_.bounds_min + geometry_.bounds_max);
    for (SimpleMesh& mesh : simple)
      for (glm::vec3& p : mesh.positions) {
        const glm::vec3 grown = centre + scale * (p - centre);
        mesh.error_m = std::max(mesh.error_m, glm::distance(grown, p));
        p = grown;
      }
  }

  // Appends the sides of all parts to positions and triangles, and returns them as faces.
  template <typename Triangle>
  std::vector<ProxyFace> appendFaces(const std::vector<SimpleMesh>& simple, std::vector<glm::vec3>& positions,
                                     std::vector<Triangle>& triangles, float& error_m) const {
    std::vector<ProxyFace> faces;
    for (std::uint32_t p = 0; p < simple.size(); ++p) {
      error_m = std::max(error_m, simple[p].error_m);
      const auto first = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), simple[p].positions.begin(), simple[p].positions.end());
      for (std::size_t side = 0; side < parts_[p].sides(); ++side)
        for (glm::uvec3 t : simple[p].triangles) {
          if (side == 1) std::swap(t.y, t.z);
          faces.push_back(
              {{simple[p].positions[t.x], simple[p].positions[t.y], simple[p].positions[t.z]}, p, side == 1});
          Triangle& triangle = triangles.emplace_back();
          triangle.vertices = {first + t.x, first + t.y, first + t.z};
          triangle.front_only = parts_[p].two_sided;
        }
    }
    return faces;
  }

  void addLevel(const std::vector<SimpleMesh>& simple) {
    bundle::ProxyLevel level{static_cast<std::uint32_t>(proxy_.triangles.size()), 0, 0.0f};
    const std::vector<ProxyFace> faces =
        appendFaces(simple, proxy_.positions, proxy_.triangles, level.error_m);
    const std::vector<FaceShine> shine = shineOf(faces, points_, geometry_, samples_);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      bundle::ProxyTriangle& triangle = proxy_.triangles[level.first_triangle + f];
      if (shine[f].emission != glm::vec3(0.0f)) {
        triangle.emission = shine[f].emission;
        triangle.light = static_cast<std::int32_t>(parts_[faces[f].part].light);
      }
      triangle.first_entry = static_cast<std::uint32_t>(proxy_.entries.size());
      triangle.entry_count = static_cast<std::uint32_t>(shine[f].entries.size());
      proxy_.entries.insert(proxy_.entries.end(), shine[f].entries.begin(), shine[f].entries.end());
    }
    level.triangle_count = static_cast<std::uint32_t>(faces.size());
    proxy_.levels.push_back(level);
  }

  // The group's own parts need a finer surface than others do, but no entries: patches have light of their
  // own.
  void addPatches() {
    if (proxy_.levels.empty()) return;
    const float allowed = kPatchError * importance_.extent();
    std::vector<SimpleMesh> simple;
    for (const SimpleMesh& mesh : meshes_)
      simple.push_back(simplified(mesh, std::max(mesh.triangles.size(), kLeastTriangles), allowed));
    // Small bundles are not to grow by a fifth for patches that their few triangles do not need. Parts share
    // what flat ones leave, such as a wide ground.
    const auto counts =
        shares(parts_, simple,
               std::min<std::size_t>(bundle::kMaxPatchTriangles, trianglesOf(meshes_) / kTrianglesPerPatch));
    if (!counts) return;
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if ((*counts)[p] < simple[p].triangles.size()) simple[p] = simplified(meshes_[p], (*counts)[p]);
    cutAroundEyes(simple);
    if (kFewer * static_cast<double>(trianglesOf(simple)) <=
        static_cast<double>(proxy_.levels.front().triangle_count))
      return;
    bundle::PatchSurface& patches = proxy_.patches;
    const std::vector<ProxyFace> faces =
        appendFaces(simple, patches.positions, patches.triangles, patches.error_m);
    const std::vector<FaceShine> shine =
        shineOf(faces, pointsOn(simple, kPointsPerPatch), geometry_, samples_);
    for (std::size_t f = 0; f < faces.size(); ++f)
      for (const bundle::ProxyEntry& entry : shine[f].entries)
        patches.triangles[f].albedo += entry.reflectance;
    patches.error_m = std::max(patches.error_m, allowed);
    setDetail(faces, patches);
    for (glm::vec3& position : patches.positions) position += geometry_.origin;
  }

  void cutAroundEyes(std::vector<SimpleMesh>& simple) const {
    std::size_t left =
        bundle::kMaxPatchTriangles - std::min<std::size_t>(trianglesOf(simple), bundle::kMaxPatchTriangles);
    for (std::size_t p = 0; p < simple.size(); ++p)
      left -= parts_[p].sides() * cutWide(simple[p], importance_, left / parts_[p].sides());
  }

  // Patches are to be as small as what they send matters where eyes look. Points a little in front of the
  // simplified surface stand for the one behind it.
  void setDetail(const std::vector<ProxyFace>& faces, bundle::PatchSurface& patches) const {
    std::vector<float> matters(faces.size(), 0.0f);
    float most = 0.0f;
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto& [a, b, c] = faces[f].corners;
      const glm::vec3 across = glm::cross(b - a, c - a);
      if (!(glm::length(across) > 0.0f)) continue;
      const glm::vec3 normal = glm::normalize(across), middle = (a + b + c) / 3.0f;
      for (const glm::vec3& toward : {middle, a, b, c}) {
        const glm::vec3 at = glm::mix(middle, toward, 0.5f) + patches.error_m * normal;
        const ImportanceAt here = importance_.at({at, normal});
        matters[f] += 0.25f * (here.seen + here.sent);
      }
      most = std::max(most, matters[f]);
    }
    for (std::size_t f = 0; f < faces.size() && most > 0.0f; ++f)
      patches.triangles[f].detail = bundle::detailOf(std::max(matters[f] / most, bundle::kLeastPatchDensity));
  }

  const GroupGeometry& geometry_;
  const SampleSet& samples_;
  const SurfaceColors& colors_;
  const Importance& importance_;
  std::vector<ProxyPart> parts_;
  std::vector<SimpleMesh> meshes_;  // one per part
  std::optional<Silhouette> outline_;
  PartPoints points_;
  bundle::CaptureProxy proxy_;
};

}  // namespace

bundle::CaptureProxy makeCaptureProxy(const GroupGeometry& geometry, const SampleSet& samples,
                                      const SurfaceColors& colors, const Importance& importance) {
  return ProxyMaker(geometry, samples, colors, importance).make();
}

}  // namespace lambent::baker
