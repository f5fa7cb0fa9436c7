#include "baker/import/mesh_edits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "baker/import/convert.hpp"
#include "runtime/base/finite.hpp"

namespace lambent::baker {

void gatherVertices(bundle::MeshData& mesh, std::span<const std::uint32_t> sources) {
  const auto gather = [&](auto& values) {
    if (values.empty()) return;
    std::remove_reference_t<decltype(values)> gathered;
    gathered.reserve(sources.size());
    for (const std::uint32_t v : sources) gathered.push_back(values[v]);
    values = std::move(gathered);
  };
  gather(mesh.positions);
  gather(mesh.normals);
  gather(mesh.normal_weights);
  gather(mesh.texcoords0);
  gather(mesh.texcoords1);
  gather(mesh.colors);
  gather(mesh.tangents);
}

void dropUnusedVertices(bundle::MeshData& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const std::uint32_t v : mesh.indices) used[v] = true;
  std::vector<std::uint32_t> sources, number(mesh.positions.size(), 0);
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    number[v] = static_cast<std::uint32_t>(sources.size());
    sources.push_back(v);
  }
  if (sources.size() == used.size()) return;
  gatherVertices(mesh, sources);
  for (std::uint32_t& v : mesh.indices) v = number[v];
}

template <std::size_t N>
void appendMean(bundle::MeshData& mesh, const std::array<std::uint32_t, N>& of,
                const std::array<float, N>& weights) {
  const auto meanOf = [&](const auto& value) {
    auto mean = value(of[0]) * weights[0] + value(of[1]) * weights[1];
    for (std::size_t i = 2; i < N; ++i) mean += value(of[i]) * weights[i];
    return mean;
  };
  const auto append = [&](auto& values) {
    if (values.empty()) return;
    const auto mean = meanOf([&](std::uint32_t v) { return values[v]; });
    values.push_back(mean);
  };
  const std::size_t next = mesh.positions.size();
  append(mesh.positions), append(mesh.texcoords0), append(mesh.texcoords1), append(mesh.colors);
  if (!mesh.normals.empty()) {
    mesh.normal_weights.resize(next, 1.0f);
    const glm::vec3 mean = meanOf([&](std::uint32_t v) { return mesh.normal_weights[v] * mesh.normals[v]; });
    const float length = glm::length(mean);
    const bool any = length > 1e-6f;  // opposite normals have no mean
    mesh.normals.push_back(any ? mean / length : mesh.normals[of[0]]);
    mesh.normal_weights.push_back(any ? length : mesh.normal_weights[of[0]]);
  }
  if (!mesh.tangents.empty()) {
    const glm::vec4 first = mesh.tangents[of[0]];
    const glm::vec3 mean = meanOf([&](std::uint32_t v) { return glm::vec3(mesh.tangents[v]); });
    const float length = glm::length(mean);
    mesh.tangents.emplace_back(length > 1e-6f ? mean / length : glm::vec3(first), first.w);
  }
}
template void appendMean(bundle::MeshData&, const std::array<std::uint32_t, 2>&, const std::array<float, 2>&);
template void appendMean(bundle::MeshData&, const std::array<std::uint32_t, 3>&, const std::array<float, 3>&);

namespace {

using bundle::MeshData;

// A triangle is without area if it is thinner than this share of its longest edge, or than what rounding its
// own coordinates to floats moves them by, so that its normal is noise: ray tracers report false hits on
// such, and they carry no light. The rest of the mesh does not count, since a large one may have small parts.
constexpr double kThinnest = 1e-12, kRounding = 0x1p-25;

// Returns twice the area along the geometric normal, in double because of small triangles far from the
// origin.
glm::dvec3 areaVector(const MeshData& mesh, std::size_t first_corner) {
  const glm::dvec3 a = mesh.positions[mesh.indices[first_corner]];
  const glm::dvec3 b = mesh.positions[mesh.indices[first_corner + 1]];
  const glm::dvec3 c = mesh.positions[mesh.indices[first_corner + 2]];
  return glm::cross(b - a, c - a);
}

template <typename Keep>
std::size_t dropTriangles(MeshData& mesh, Keep keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    if (!keep(i)) continue;
    std::copy_n(mesh.indices.begin() + static_cast<std::ptrdiff_t>(i), 3,
                mesh.indices.begin() + static_cast<std::ptrdiff_t>(kept));
    kept += 3;
  }
  const std::size_t dropped = (mesh.indices.size() - kept) / 3;
  mesh.indices.resize(kept);
  return dropped;
}

std::size_t dropNonFinite(MeshData& mesh) {
  return dropTriangles(mesh, [&](std::size_t i) {
    return isFinite(mesh.positions[mesh.indices[i]]) && isFinite(mesh.positions[mesh.indices[i + 1]]) &&
           isFinite(mesh.positions[mesh.indices[i + 2]]);
  });
}

std::size_t dropDegenerate(MeshData& mesh) {
  return dropTriangles(mesh, [&](std::size_t i) {
    double longest = 0.0, largest = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::dvec3 a = mesh.positions[mesh.indices[i + c]],
                       b = mesh.positions[mesh.indices[i + (c + 1) % 3]];
      longest = std::max(longest, glm::distance(a, b));
      largest = std::max({largest, std::abs(a.x), std::abs(a.y), std::abs(a.z)});
    }
    // Twice the area is the height over the longest edge times its length.
    return glm::length(areaVector(mesh, i)) > longest * std::max(kThinnest * longest, kRounding * largest);
  });
}

// Makes flat normals, as glTF asks if there are none. Each corner becomes a vertex of its own.
void makeFlat(MeshData& mesh) {
  const std::vector<std::uint32_t> sources = mesh.indices;
  gatherVertices(mesh, sources);
  mesh.normals.resize(sources.size());
  for (std::size_t i = 0; i < sources.size(); ++i) mesh.indices[i] = static_cast<std::uint32_t>(i);
  for (std::size_t i = 0; i < sources.size(); i += 3) {
    const glm::vec3 normal(glm::normalize(areaVector(mesh, i)));
    std::fill_n(mesh.normals.begin() + static_cast<std::ptrdiff_t>(i), 3, normal);
  }
}

// Makes normals unit; one without direction becomes the area-weighted mean of the faces around its vertex.
std::size_t repairNormals(MeshData& mesh) {
  constexpr float kShortest = 1e-6f;
  std::vector<std::uint8_t> broken(mesh.normals.size(), 0);
  std::size_t count = 0;
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    const float length = glm::length(mesh.normals[v]);
    if (isFinite(mesh.normals[v]) && std::isfinite(length) && length > kShortest) {
      mesh.normals[v] /= length;
    } else {
      broken[v] = 1;
      ++count;
    }
  }
  if (count == 0) return 0;
  std::vector<glm::dvec3> sums(mesh.normals.size(), glm::dvec3(0.0));
  std::vector<glm::dvec3> one_face(mesh.normals.size(), glm::dvec3(0.0, 1.0, 0.0));
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const glm::dvec3 area = areaVector(mesh, i / 3 * 3);
    sums[mesh.indices[i]] += area;
    one_face[mesh.indices[i]] = area;  // used if the faces around a vertex cancel out
  }
  for (std::size_t v = 0; v < broken.size(); ++v) {
    if (broken[v] == 0) continue;
    const double least = 1e-9 * glm::length(one_face[v]);
    mesh.normals[v] = glm::vec3(glm::normalize(glm::length(sums[v]) > least ? sums[v] : one_face[v]));
  }
  return count;
}

// Returns some direction in the surface, for tangents that have none.
glm::vec3 someTangent(const glm::vec3& normal) {
  const glm::vec3 axis = std::abs(normal.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  return glm::normalize(glm::cross(normal, axis));
}

std::size_t repairTangents(MeshData& mesh) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < mesh.tangents.size(); ++v) {
    glm::vec4& tangent = mesh.tangents[v];
    const float length = glm::length(glm::vec3(tangent));
    const bool good = isFinite(glm::vec3(tangent)) && std::isfinite(length) && length > 1e-6f;
    if (!good) ++count;
    const glm::vec3 direction = good ? glm::vec3(tangent) / length : someTangent(mesh.normals[v]);
    tangent = glm::vec4(direction, tangent.w < 0.0f ? -1.0f : 1.0f);
  }
  return count;
}

template <typename Vector>
std::size_t repairValues(std::vector<Vector>& values, const Vector& replacement) {
  std::size_t count = 0;
  for (Vector& value : values) {
    if (isFinite(value)) continue;
    value = replacement;
    ++count;
  }
  return count;
}

}  // namespace

void cleanMesh(MeshData& mesh, const std::string& name, std::vector<std::string>& warnings) {
  const auto warn = [&](std::size_t count, const char* what) {
    if (count > 0) warnings.push_back(fmt::format("{}: {} {}", name, count, what));
  };
  warn(dropNonFinite(mesh), "triangles with positions that are not finite dropped");
  warn(dropDegenerate(mesh), "triangles without area dropped");
  if (mesh.indices.empty()) return;
  dropUnusedVertices(mesh);
  if (mesh.normals.empty()) {
    makeFlat(mesh);
  } else {
    warn(repairNormals(mesh), "normals without direction made from the faces around them");
  }
  warn(repairTangents(mesh), "tangents without direction made up");
  warn(repairValues(mesh.texcoords0, glm::vec2(0.0f)) + repairValues(mesh.texcoords1, glm::vec2(0.0f)),
       "texture coordinates that are not finite set to 0");
  warn(repairValues(mesh.colors, glm::vec4(1.0f)), "colors that are not finite set to white");
}

namespace {

constexpr std::uint32_t kNone = ~0u;

glm::vec3 unitOrZero(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f && std::isfinite(length) ? v / length : glm::vec3(0.0f);
}

glm::vec3 across(const glm::vec3& v, const glm::vec3& normal) {
  return unitOrZero(v - glm::dot(normal, v) * normal);
}

// MikkTSpace has one tangent for all corners at a point that have the same normal and texture coordinates,
// whose faces hang together there by edges, and on whose faces the picture is not mirrored or is mirrored.
// The corners of a face count with their angles there.
class TangentMaker {
 public:
  TangentMaker(bundle::MeshData& mesh, const gltf::TextureRef& map)
      : mesh_(mesh), uvs_(map.texcoord == 0 ? mesh.texcoords0 : mesh.texcoords1) {
    for (glm::vec2& uv : uvs_) uv = map.apply(uv);
  }

  void make() {
    joinEqualVertices();
    lookAtFaces();
    joinFaces();
    group_of_.assign(mesh_.indices.size(), kNone);
    for (std::uint32_t corner = 0; corner < group_of_.size(); ++corner)
      if (group_of_[corner] == kNone && !faces_[corner / 3].flat) grow(corner);
    writeTangents();
  }

 private:
  struct Face {
    glm::vec3 along{0.0f};  // unit, the way in which u grows
    bool mirrored = false;  // the picture is
    bool flat = false;      // it has no area in the picture, so that it goes with any group
    bool taken = false;     // a flat one that has a group
    std::array<std::uint32_t, 3> beyond{kNone, kNone, kNone};  // the face beyond the edge after each corner
  };
  struct Group {
    bool mirrored = false;
    glm::vec3 sum{0.0f};
  };

  std::uint32_t point(std::uint32_t corner) const { return point_of_[mesh_.indices[corner]]; }
  static std::uint32_t cornerAfter(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

  // Gives vertices with equal position, normal and texture coordinates one number.
  void joinEqualVertices() {
    std::map<std::array<float, 8>, std::uint32_t> numbers;
    point_of_.resize(mesh_.positions.size());
    for (std::size_t v = 0; v < point_of_.size(); ++v) {
      const glm::vec3 &p = mesh_.positions[v], &n = mesh_.normals[v];
      const std::array<float, 8> key{p.x, p.y, p.z, n.x, n.y, n.z, uvs_[v].x, uvs_[v].y};
      point_of_[v] = numbers.try_emplace(key, static_cast<std::uint32_t>(v)).first->second;
    }
  }

  void lookAtFaces() {
    faces_.resize(mesh_.indices.size() / 3);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const std::uint32_t a = mesh_.indices[3 * f], b = mesh_.indices[3 * f + 1],
                          c = mesh_.indices[3 * f + 2];
      const glm::vec3 ab = mesh_.positions[b] - mesh_.positions[a],
                      ac = mesh_.positions[c] - mesh_.positions[a];
      const glm::vec2 uv_ab = uvs_[b] - uvs_[a], uv_ac = uvs_[c] - uvs_[a];
      const float area = uv_ab.x * uv_ac.y - uv_ab.y * uv_ac.x;
      Face& face = faces_[f];
      face.mirrored = area <= 0.0f;
      face.along = unitOrZero((face.mirrored ? -1.0f : 1.0f) * (uv_ac.y * ab - uv_ab.y * ac));
      const glm::vec3 along_v = uv_ab.x * ac - uv_ac.x * ab;
      face.flat = area == 0.0f || face.along == glm::vec3(0.0f) || along_v == glm::vec3(0.0f);
    }
  }

  // Finds the faces beyond edges, which run along them the other way. Of more than two the first ones are
  // neighbors.
  void joinFaces() {
    std::multimap<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> open;  // corners before edges
    for (std::uint32_t corner = 0; corner < mesh_.indices.size(); ++corner) {
      const std::uint32_t from = point(corner), to = point(cornerAfter(corner));
      if (const auto other = open.find({to, from}); other != open.end()) {
        faces_[corner / 3].beyond[corner % 3] = other->second / 3;
        faces_[other->second / 3].beyond[other->second % 3] = corner / 3;
        open.erase(other);
      } else {
        open.emplace(std::pair(from, to), corner);
      }
    }
  }

  // Begins a group at this corner and takes in the faces around its point.
  void grow(std::uint32_t first) {
    const auto number = static_cast<std::uint32_t>(groups_.size());
    groups_.push_back({.mirrored = faces_[first / 3].mirrored});
    std::vector<std::uint32_t> ahead{first};
    while (!ahead.empty()) {
      const std::uint32_t corner = ahead.back();
      ahead.pop_back();
      Face& face = faces_[corner / 3];
      if (group_of_[corner] != kNone) continue;
      if (face.flat && !std::exchange(face.taken, true)) face.mirrored = groups_[number].mirrored;
      if (face.mirrored != groups_[number].mirrored) continue;
      group_of_[corner] = number;
      add(corner);
      const std::uint32_t before = cornerAfter(cornerAfter(corner));
      for (const std::uint32_t edge : {corner, before})
        if (const std::uint32_t next = face.beyond[edge % 3]; next != kNone)
          for (std::uint32_t other = 3 * next; other < 3 * next + 3; ++other)
            if (point(other) == point(corner)) ahead.push_back(other);
    }
  }

  void add(std::uint32_t corner) {
    const Face& face = faces_[corner / 3];
    if (face.flat) return;
    const auto at = [&](std::uint32_t c) { return mesh_.positions[mesh_.indices[c]]; };
    const glm::vec3& normal = mesh_.normals[mesh_.indices[corner]];
    const std::uint32_t after = cornerAfter(corner), before = cornerAfter(after);
    const float cosine =
        glm::dot(across(at(after) - at(corner), normal), across(at(before) - at(corner), normal));
    groups_[group_of_[corner]].sum += std::acos(std::clamp(cosine, -1.0f, 1.0f)) * across(face.along, normal);
  }

  // Each vertex keeps its first group. Its corners in others get a copy of it.
  void writeTangents() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> copies;  // of vertex and group
    std::vector<std::uint32_t> sources(mesh_.positions.size()), groups(sources.size(), kNone);
    std::vector<bool> used(sources.size(), false);
    std::iota(sources.begin(), sources.end(), 0u);
    for (std::uint32_t corner = 0; corner < mesh_.indices.size(); ++corner) {
      std::uint32_t& vertex = mesh_.indices[corner];
      const std::uint32_t group = group_of_[corner];
      if (!used[vertex]) {
        used[vertex] = true;
        groups[vertex] = group;
      } else if (groups[vertex] != group) {
        const auto [copy, added] =
            copies.try_emplace({vertex, group}, static_cast<std::uint32_t>(sources.size()));
        if (added) {
          sources.push_back(vertex);
          groups.push_back(group);
        }
        vertex = copy->second;
      }
    }
    gatherVertices(mesh_, sources);
    for (std::size_t v = 0; v < groups.size(); ++v)
      mesh_.tangents.push_back(tangentOf(groups[v], mesh_.normals[v]));
  }

  // In glTF v points down and +Y of normal maps up, so that bitangents are the other way than MikkTSpace's.
  glm::vec4 tangentOf(std::uint32_t group, const glm::vec3& normal) const {
    glm::vec3 along(0.0f);
    if (group != kNone) along = across(groups_[group].sum, normal);
    if (along == glm::vec3(0.0f))  // the picture shows no direction, so that any is right
      along = across(std::abs(normal.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0), normal);
    return {along, group != kNone && groups_[group].mirrored ? 1.0f : -1.0f};
  }

  bundle::MeshData& mesh_;
  std::vector<glm::vec2> uvs_;
  std::vector<std::uint32_t> point_of_;  // by vertex
  std::vector<Face> faces_;
  std::vector<Group> groups_;
  std::vector<std::uint32_t> group_of_;  // by corner
};

}  // namespace

void makeTangents(bundle::MeshData& mesh, const gltf::TextureRef& map) {
  mesh.tangents.clear();
  if ((map.texcoord == 0 ? mesh.texcoords0 : mesh.texcoords1).empty()) return;
  TangentMaker(mesh, map).make();
}

}  // namespace lambent::baker
