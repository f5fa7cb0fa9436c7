#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "baker/import/convert.hpp"
#include "baker/import/mesh_edits.hpp"
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

void dropUnusedVertices(MeshData& mesh) {
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

}  // namespace lambent::baker
