#include "baker/reference/surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_inverse.hpp>

namespace lambent::baker::reference {

namespace {

// Rays start this share of the coordinates and of the triangle's size off the surface: some thirty roundings
// of a float, and as much below anything that is seen.
constexpr float kOffset = 0x1p-19f;

float largest(const glm::vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

glm::vec3 unitOr(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double length = glm::length(v);
  return glm::vec3(length > 0.0 && std::isfinite(length) ? v / length : fallback);
}

template <typename T>
void append(std::vector<T>& all, const std::vector<T>& some, std::size_t count, const T& fallback) {
  if (some.size() == count)
    all.insert(all.end(), some.begin(), some.end());
  else
    all.resize(all.size() + count, fallback);
}

}  // namespace

Result<Surfaces> Surfaces::build(const Scene& scene) {
  Surfaces out;
  auto textures = Textures::load(scene);
  if (!textures) return failAgain(std::move(textures.error()));
  out.textures_ = std::move(*textures);
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh < 0) continue;
    const glm::dmat4 matrix(world[n]);
    const double determinant = glm::determinant(glm::dmat3(matrix));
    const bool mirrored = determinant < 0.0;
    // Up to its scale the inverse transpose; defined for flat matrices too.
    const glm::dmat3 linear(matrix);
    const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                               glm::cross(linear[0], linear[1]));
    for (const ScenePrimitive& primitive :
         scene.meshes[static_cast<std::size_t>(scene.nodes[n].mesh)].primitives) {
      const bundle::MeshData& mesh = primitive.mesh;
      const std::size_t count = mesh.positions.size();
      Surface surface;
      if (primitive.material >= 0)
        surface.material = scene.materials[static_cast<std::size_t>(primitive.material)];
      surface.first_vertex = static_cast<std::uint32_t>(out.positions_.size());
      surface.vertex_count = static_cast<std::uint32_t>(count);
      surface.first_triangle = static_cast<std::uint32_t>(out.triangles_.size());
      surface.triangle_count = static_cast<std::uint32_t>(mesh.indices.size() / 3);
      surface.handedness = mirrored ? -1.0f : 1.0f;
      for (std::size_t v = 0; v < count; ++v) {
        out.positions_.emplace_back(matrix * glm::dvec4(mesh.positions[v], 1.0));
        const glm::dvec3 normal = cofactors * glm::dvec3(mesh.normals[v]);
        out.normals_.push_back(unitOr(mirrored ? -normal : normal, glm::dvec3(0.0, 1.0, 0.0)));
        const bool has_tangent = mesh.tangents.size() == count;
        out.tangents_.push_back(
            has_tangent ? glm::vec4(unitOr(linear * glm::dvec3(mesh.tangents[v]), {}), mesh.tangents[v].w)
                        : glm::vec4(0.0f));
      }
      append(out.texcoords_[0], mesh.texcoords0, count, glm::vec2(0.0f));
      append(out.texcoords_[1], mesh.texcoords1, count, glm::vec2(0.0f));
      append(out.colors_, mesh.colors, count, glm::vec4(1.0f));
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        glm::uvec3 corners(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
        if (mirrored) std::swap(corners.y, corners.z);
        out.triangles_.push_back(corners + surface.first_vertex);
      }
      out.surfaces_.push_back(std::move(surface));
    }
  }
  return out;
}

template <typename T>
T Surfaces::interpolated(const std::vector<T>& values, const Hit& hit) const {
  const glm::uvec3 t = triangles_[hit.triangle];
  return (1.0f - hit.u - hit.v) * values[t.x] + hit.u * values[t.y] + hit.v * values[t.z];
}

glm::dvec3 Surfaces::areaVector(std::uint32_t triangle) const {
  const glm::uvec3 t = triangles_[triangle];
  const glm::dvec3 a(positions_[t.x]);
  return glm::cross(glm::dvec3(positions_[t.y]) - a, glm::dvec3(positions_[t.z]) - a);
}

glm::vec2 Surfaces::texcoord(const Hit& hit, std::uint32_t set) const {
  return interpolated(texcoords_[std::min(set, 1u)], hit);
}

glm::vec4 Surfaces::baseColor(const Hit& hit) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  glm::vec4 color = material.base_color * interpolated(colors_, hit);
  if (material.base_color_texture.texture >= 0)
    color *=
        textures_.color(material.base_color_texture, texcoord(hit, material.base_color_texture.texcoord));
  return color;
}

float Surfaces::alphaAt(const Hit& hit) const {
  return baseColor(hit).a;
}

glm::vec3 Surfaces::emittedAt(const Hit& hit) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  if (material.unlit || material.emissive == glm::vec3(0.0f)) return glm::vec3(0.0f);
  const gltf::TextureRef& ref = material.emissive_texture;
  return material.emissive * glm::vec3(textures_.color(ref, texcoord(hit, ref.texcoord)));
}

// The file's, or by the texture coordinates over this triangle. glTF's textures have v pointing down and
// normals' +Y pointing up, so that a triangle's bitangent is -dp/dv.
glm::vec4 Surfaces::tangent(const Hit& hit, const glm::vec3& normal) const {
  const glm::vec4 given = interpolated(tangents_, hit);
  if (tangents_[triangles_[hit.triangle].x].w != 0.0f)
    return {glm::vec3(given), surfaces_[hit.surface].handedness * tangents_[triangles_[hit.triangle].x].w};
  const gltf::TextureRef& ref = surfaces_[hit.surface].material.normal_texture;
  const glm::uvec3 t = triangles_[hit.triangle];
  const auto& uvs = texcoords_[std::min(ref.texcoord, 1u)];
  const glm::vec2 a = ref.apply(uvs[t.x]), ab = ref.apply(uvs[t.y]) - a, ac = ref.apply(uvs[t.z]) - a;
  const glm::vec3 p = positions_[t.x], pb = positions_[t.y] - p, pc = positions_[t.z] - p;
  const float area = ab.x * ac.y - ac.x * ab.y;
  const float sign = area < 0.0f ? -1.0f : 1.0f;
  const glm::vec3 along_u = sign * (ac.y * pb - ab.y * pc), along_v = sign * (ab.x * pc - ac.x * pb);
  return {along_u, glm::dot(glm::cross(normal, along_u), along_v) < 0.0f ? 1.0f : -1.0f};
}

glm::vec3 Surfaces::mappedNormal(const Hit& hit, const glm::vec3& normal) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  const glm::vec4 along = tangent(hit, normal);
  const glm::vec3 t = glm::vec3(along) - glm::dot(glm::vec3(along), normal) * normal;
  const float length = glm::length(t);
  if (!(length > 0.0f)) return normal;
  const glm::vec3 unit = t / length;
  const glm::vec3 texel(
      textures_.data(material.normal_texture, texcoord(hit, material.normal_texture.texcoord)));
  const glm::vec3 local =
      (2.0f * texel - 1.0f) * glm::vec3(material.normal_scale, material.normal_scale, 1.0f);
  return unitOr(local.x * unit + local.y * along.w * glm::cross(normal, unit) + local.z * normal, normal);
}

SurfacePoint Surfaces::pointAt(const Hit& hit, const glm::vec3& dir) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  const glm::uvec3 t = triangles_[hit.triangle];
  SurfacePoint point;
  point.position = interpolated(positions_, hit);
  point.geometric = unitOr(areaVector(hit.triangle), glm::dvec3(0.0, 1.0, 0.0));
  point.offset = kOffset * (largest(point.position) + largest(positions_[t.y] - positions_[t.x]) +
                            largest(positions_[t.z] - positions_[t.x]));
  const bool back = glm::dot(point.geometric, dir) > 0.0f;
  point.blocked = back && !material.double_sided;
  point.unlit = material.unlit;
  if (point.blocked) return point;
  point.shading = unitOr(interpolated(normals_, hit), point.geometric);
  if (material.normal_texture.texture >= 0) point.shading = mappedNormal(hit, point.shading);
  const glm::vec4 color = baseColor(hit);
  point.albedo = glm::vec3(color);
  point.alpha = color.a;
  point.emitted = emittedAt(hit);
  if (back) {
    point.geometric = -point.geometric;
    point.shading = -point.shading;
  }
  return point;
}

}  // namespace lambent::baker::reference
