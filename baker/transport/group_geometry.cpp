#include "baker/transport/group_geometry.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/plan/smooth_dielectrics.hpp"
#include "runtime/base/normal_matrix.hpp"

namespace lambent::baker {

namespace {

glm::vec3 unitOr(glm::vec3 v, glm::vec3 fallback) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : fallback;
}

glm::vec2 texcoordOf(const gltf::TextureRef& ref, const bundle::MeshData& mesh, std::size_t vertex) {
  const auto& set = ref.texcoord == 1 ? mesh.texcoords1 : mesh.texcoords0;
  return ref.texture < 0 || set.empty() ? glm::vec2(0.0f) : ref.apply(set[vertex]);
}

// A normal map without coordinates to look it up changes nothing.
bool isNormalMapped(const gltf::Material& material, const bundle::MeshData& mesh) {
  const gltf::TextureRef& map = material.normal_texture;
  return !material.unlit && map.texture >= 0 &&
         !(map.texcoord == 1 ? mesh.texcoords1 : mesh.texcoords0).empty();
}

SampleKind kindOf(const gltf::Material* material, const bundle::MeshData& mesh, bool with_glossy) {
  if (!material) return SampleKind::Diffuse;
  if (with_glossy && hasMatrices(*material)) return SampleKind::Glossy;
  return isNormalMapped(*material, mesh) ? SampleKind::NormalMapped : SampleKind::Diffuse;
}

// Appends what the textures of glossy surfaces need. A mirroring node flips the bitangent, and so does the
// back side, whose normal is negated, so both sides keep the direction in which they are brushed.
void appendGlossy(const bundle::MeshData& mesh, const glm::mat3& linear, float side, std::size_t first_vertex,
                  GroupGeometry& geometry) {
  const std::size_t end = first_vertex + mesh.positions.size();
  for (std::size_t set = 0; set < 2; ++set) {
    const auto& texcoords = set == 1 ? mesh.texcoords1 : mesh.texcoords0;
    geometry.texcoord_sets[set].resize(first_vertex, glm::vec2(0.0f));
    geometry.texcoord_sets[set].insert(geometry.texcoord_sets[set].end(), texcoords.begin(), texcoords.end());
    geometry.texcoord_sets[set].resize(end, glm::vec2(0.0f));
  }
  const float sign = (glm::determinant(linear) < 0.0f ? -1.0f : 1.0f) * side;
  geometry.tangents.resize(first_vertex, glm::vec4(0.0f));
  for (const glm::vec4& tangent : mesh.tangents)
    geometry.tangents.emplace_back(unitOr(linear * glm::vec3(tangent), glm::vec3(0.0f)), sign * tangent.w);
  geometry.tangents.resize(end, glm::vec4(0.0f));
}

// Texels take the place of vertices where these hold E/pi; normal maps and glossy surfaces keep theirs.
void appendCharts(const ScenePrimitive& primitive, const bundle::MeshData& mesh, DrawGeometry& draw,
                  GroupGeometry& geometry) {
  const auto& coordinates = primitive.texel_set == 1 ? mesh.texcoords1 : mesh.texcoords0;
  if (primitive.texels == 0 || draw.kind != SampleKind::Diffuse || coordinates.empty()) return;
  draw.texels = primitive.texels;
  geometry.chart_coordinates.resize(draw.first_vertex, glm::vec2(0.0f));
  for (const glm::vec2& at : coordinates)
    geometry.chart_coordinates.push_back(glm::clamp(at, glm::vec2(0.0f), glm::vec2(1.0f)));
}

void appendDraw(const PlannedDraw& draw, const ScenePrimitive& primitive, const bundle::MeshData& mesh,
                const gltf::Material* material, bool with_glossy, GroupGeometry& geometry) {
  DrawGeometry out{.first_vertex = static_cast<std::uint32_t>(geometry.positions.size()),
                   .vertex_count = static_cast<std::uint32_t>(mesh.positions.size()),
                   .first_triangle = static_cast<std::uint32_t>(geometry.triangles.size()),
                   .triangle_count = 0,
                   .material = primitive.material,
                   .back = draw.back,
                   .kind = kindOf(material, mesh, with_glossy),
                   .layered = with_glossy && material && isSmoothDielectric(*material)};
  const glm::dmat4 group_from_mesh(draw.group_from_mesh);
  const glm::mat3 linear(draw.group_from_mesh);
  const glm::mat3 normal_matrix = normalMatrix(linear);
  const float side = draw.back ? -1.0f : 1.0f;
  const gltf::TextureRef base = material ? material->base_color_texture : gltf::TextureRef{};
  const gltf::TextureRef emissive = material ? material->emissive_texture : gltf::TextureRef{};
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec3 placed = group_from_mesh * glm::dvec4(mesh.positions[v], 1.0);
    // Adding 0 turns -0 into 0, because samples are welded by their bits.
    geometry.positions.push_back(glm::vec3(placed - glm::dvec3(geometry.origin)) + 0.0f);
    geometry.normals.push_back(side * unitOr(normal_matrix * mesh.normals[v], {0.0f, 1.0f, 0.0f}) + 0.0f);
    geometry.normal_weights.push_back(mesh.normal_weights.empty() ? 1.0f : mesh.normal_weights[v]);
    geometry.texcoords.push_back(texcoordOf(base, mesh, v));
    geometry.emissive_texcoords.push_back(texcoordOf(emissive, mesh, v));
    geometry.colors.push_back(mesh.colors.empty() ? glm::vec4(1.0f) : mesh.colors[v]);
  }
  if (material && material->transmission_texture.texture >= 0) {
    geometry.pane_texcoords.resize(out.first_vertex, glm::vec2(0.0f));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      geometry.pane_texcoords.push_back(texcoordOf(material->transmission_texture, mesh, v));
  }
  if (out.kind == SampleKind::Glossy) appendGlossy(mesh, linear, side, out.first_vertex, geometry);
  appendCharts(primitive, mesh, out, geometry);
  const bool reversed = (glm::determinant(linear) < 0.0f) != draw.back;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    glm::uvec3 triangle(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
    if (reversed) std::swap(triangle.y, triangle.z);
    triangle += out.first_vertex;
    const glm::vec3 a = geometry.positions[triangle.x], b = geometry.positions[triangle.y],
                    c = geometry.positions[triangle.z];
    if (glm::cross(b - a, c - a) == glm::vec3(0.0f))
      continue;  // a triangle without area is no surface, and rays must not come to depend on it
    geometry.triangles.push_back(triangle);
    ++out.triangle_count;
  }
  geometry.draws.push_back(out);
}

// Returns the centre of a group that stands much farther from its frame's origin than it is large, else 0.
glm::vec3 originOf(const RigidGroup& group, const std::vector<std::vector<bundle::MeshData>>& decoded) {
  constexpr double kFar = 16.0;
  glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
  for (const PlannedDraw& draw : group.draws) {
    const glm::dmat4 group_from_mesh(draw.group_from_mesh);
    for (const glm::vec3& position : decoded[draw.mesh][draw.primitive].positions) {
      const glm::dvec3 placed = group_from_mesh * glm::dvec4(position, 1.0);
      low = glm::min(low, placed), high = glm::max(high, placed);
    }
  }
  const glm::dvec3 centre = 0.5 * (low + high);
  return glm::length(centre) > kFar * glm::length(high - low) ? glm::vec3(centre) : glm::vec3(0.0f);
}

}  // namespace

glm::vec3 areaNormal(const GroupGeometry& geometry, const glm::uvec3& corners) {
  const glm::vec3 a = geometry.positions[corners.x];
  return glm::cross(geometry.positions[corners.y] - a, geometry.positions[corners.z] - a);
}

double triangleArea(const GroupGeometry& geometry, const glm::uvec3& corners) {
  return 0.5 * double{glm::length(areaNormal(geometry, corners))};
}

float longestEdge(const GroupGeometry& geometry, const glm::uvec3& corners) {
  const glm::vec3 &a = geometry.positions[corners.x], &b = geometry.positions[corners.y],
                  &c = geometry.positions[corners.z];
  return std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
}

glm::vec3 interpolatedNormal(const GroupGeometry& geometry, const glm::uvec3& corners,
                             const glm::vec3& shares) {
  glm::vec3 sum(0.0f);
  for (int c = 0; c < 3; ++c)
    sum += shares[c] * geometry.normal_weights[corners[c]] * geometry.normals[corners[c]];
  return unitOr(sum, glm::vec3(0.0f));
}

GroupGeometry buildGroupGeometry(const RigidGroup& group, const Scene& scene,
                                 const std::vector<std::vector<bundle::MeshData>>& decoded,
                                 bool with_glossy) {
  GroupGeometry geometry;
  geometry.origin = originOf(group, decoded);
  for (const PlannedDraw& draw : group.draws) {
    const ScenePrimitive& primitive = scene.meshes[draw.mesh].primitives[draw.primitive];
    const std::int32_t index = primitive.material;
    const gltf::Material* material = index < 0 ? nullptr : &scene.materials[static_cast<std::size_t>(index)];
    appendDraw(draw, primitive, decoded[draw.mesh][draw.primitive], material, with_glossy, geometry);
  }
  if (!geometry.positions.empty()) geometry.bounds_min = geometry.bounds_max = geometry.positions.front();
  for (const glm::vec3& p : geometry.positions) {
    geometry.bounds_min = glm::min(geometry.bounds_min, p);
    geometry.bounds_max = glm::max(geometry.bounds_max, p);
  }
  return geometry;
}

namespace {

constexpr double kMostFolded = 0.01;  // share of a draw's area

}  // namespace

std::vector<std::uint8_t> findFlippedFaces(const GroupGeometry& geometry) {
  std::vector<std::uint8_t> flipped_faces(geometry.triangles.size(), 0);
  for (std::size_t d = 0; d < geometry.draws.size(); ++d) {
    const DrawGeometry& draw = geometry.draws[d];
    const bool two_sided = draw.back || (d + 1 < geometry.draws.size() && geometry.draws[d + 1].back);
    if (two_sided) continue;
    double area = 0.0, folded = 0.0;
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
      const glm::uvec3& corners = geometry.triangles[t];
      const glm::vec3 normal = areaNormal(geometry, corners);
      int against = 0;
      for (int c = 0; c < 3; ++c) against += glm::dot(normal, geometry.normals[corners[c]]) < 0.0f;
      flipped_faces[t] = against >= 2;
      area += double{glm::length(normal)};
      if (flipped_faces[t] != 0) folded += double{glm::length(normal)};
    }
    if (folded > kMostFolded * area)
      std::fill_n(flipped_faces.begin() + draw.first_triangle, draw.triangle_count, std::uint8_t{0});
  }
  return flipped_faces;
}

}  // namespace lambent::baker
