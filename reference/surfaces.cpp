#include "reference/surfaces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "reference/sampler.hpp"
#include "runtime/base/normal_matrix.hpp"
#include "runtime/bundle/material_fields.hpp"

namespace lambent::baker::reference {

Result<Textures> Textures::load(const Scene& scene) {
  Textures out;
  out.textures_ = scene.textures;
  out.images_.resize(scene.textures.size());
  DecodedImages images(scene);
  std::optional<Error> error;
  const auto load = [&](const gltf::TextureRef& ref) {
    if (ref.texture < 0 || error) return;
    auto image = images.ofTexture(ref.texture);
    if (image)
      out.images_[static_cast<std::size_t>(ref.texture)] = std::move(*image);
    else
      error = std::move(image.error());
  };
  for (const gltf::Material& material : scene.materials)
    gltf::forEachMaterialTexture([&](const auto& field) { load(material.*field.member); });
  if (error) return failAgain(std::move(*error));
  return out;
}

glm::vec4 Textures::color(const gltf::TextureRef& ref, const glm::vec2& uv) const {
  const auto image = imageOf(ref);
  return image ? sampleImage(*image, textures_[static_cast<std::size_t>(ref.texture)].sampler, ref.apply(uv))
               : glm::vec4(1.0f);
}

glm::vec4 Textures::data(const gltf::TextureRef& ref, const glm::vec2& uv) const {
  const auto image = imageOf(ref);
  return image ? sampleData(*image, textures_[static_cast<std::size_t>(ref.texture)].sampler, ref.apply(uv))
               : glm::vec4(1.0f);
}

namespace {

// Rays start off the surface by this fraction of the coordinates and of the triangle's size: some thirty
// float roundings, which is still invisible.
constexpr float kOffset = 0x1p-19f;

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
  std::vector<std::shared_ptr<const MeasuredReflection>> measured(scene.brdfs.size());
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    if (scene.nodes[n].mesh < 0) continue;
    const glm::dmat4 matrix(world[n]);
    const glm::dmat3 linear(matrix), normal_matrix = normalMatrix(linear);
    const bool mirrored = glm::determinant(linear) < 0.0;
    for (const ScenePrimitive& primitive :
         scene.meshes[static_cast<std::size_t>(scene.nodes[n].mesh)].primitives) {
      const bundle::MeshData& mesh = primitive.mesh;
      const std::size_t count = mesh.positions.size();
      Surface surface;
      if (primitive.material >= 0) {
        surface.material = scene.materials[static_cast<std::size_t>(primitive.material)];
        if (const std::int32_t brdf = surface.material.brdf; brdf >= 0 && !surface.material.isDiffuse()) {
          const auto index = static_cast<std::size_t>(brdf);
          if (!measured[index]) measured[index] = std::make_shared<MeasuredReflection>(scene.brdfs[index]);
          surface.measured = measured[index];
        }
      } else {
        surface.material.metallic = 0.0f;  // diffuse white
      }
      surface.first_vertex = static_cast<std::uint32_t>(out.positions_.size());
      surface.vertex_count = static_cast<std::uint32_t>(count);
      surface.first_triangle = static_cast<std::uint32_t>(out.triangles_.size());
      surface.triangle_count = static_cast<std::uint32_t>(mesh.indices.size() / 3);
      surface.handedness = mirrored ? -1.0f : 1.0f;
      for (std::size_t v = 0; v < count; ++v) {
        out.positions_.emplace_back(matrix * glm::dvec4(mesh.positions[v], 1.0));
        const glm::dvec3 normal = normal_matrix * glm::dvec3(mesh.normals[v]);
        const float weight = mesh.normal_weights.size() == count ? mesh.normal_weights[v] : 1.0f;
        out.normals_.push_back(weight * unitOr(normal, glm::dvec3(0.0, 1.0, 0.0)));
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
  out.buildTables();
  return out;
}

void Surfaces::buildTables() {
  for (const Surface& surface : surfaces_) {
    const gltf::Material& material = surface.material;
    const bool bare = material.metallic >= 1.0f && material.metallic_roughness_texture.texture < 0;
    if (material.isDiffuse() || surface.measured || bare) continue;
    if (round_.empty()) round_ = AlbedoTable::build(/*anisotropic=*/false);
    if (material.anisotropy > 0.0f && anisotropic_.empty())
      anisotropic_ = AlbedoTable::build(/*anisotropic=*/true);
  }
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

float Surfaces::transmission(const Hit& hit) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  if (!material.transmits()) return 0.0f;
  const gltf::TextureRef& ref = material.transmission_texture;
  return (1.0f - material.metallic) * material.transmission *
         textures_.data(ref, texcoord(hit, ref.texcoord)).r;
}

glm::vec3 Surfaces::passedAt(const Hit& hit) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  const float step = material.ior > 0.0f ? (material.ior - 1.0f) / (material.ior + 1.0f) : 1.0f;
  const float reflected = material.specular * std::min(step * step * largest(material.specular_color), 1.0f);
  return (1.0f - reflected) * transmission(hit) * glm::vec3(baseColor(hit));
}

// Returns the file's tangent, or one computed from the texture coordinates of this triangle. In glTF the
// texture coordinate v points down and +Y of normal maps points up, so the bitangent is -dp/dv.
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

std::pair<glm::vec3, float> Surfaces::anisotropy(const Hit& hit, const glm::vec3& normal,
                                                 const glm::vec3& shading) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  const glm::vec3 any = frameAbout(shading)[0];
  if (!(material.anisotropy > 0.0f)) return {any, 0.0f};
  float strength = material.anisotropy;
  glm::vec2 lean(1.0f, 0.0f);
  if (const gltf::TextureRef& ref = material.anisotropy_texture; ref.texture >= 0) {
    const glm::vec4 texel = textures_.data(ref, texcoord(hit, ref.texcoord));
    lean = 2.0f * glm::vec2(texel) - 1.0f;
    strength *= texel.b;
  }
  const float c = std::cos(material.anisotropy_rotation_rad), s = std::sin(material.anisotropy_rotation_rad);
  lean = {c * lean.x - s * lean.y, s * lean.x + c * lean.y};
  const glm::vec4 along = tangent(hit, normal);
  const glm::vec3 t = unitOr(glm::vec3(along) - glm::dot(glm::vec3(along), normal) * normal, any);
  const glm::vec3 dir = lean.x * t + lean.y * along.w * glm::cross(normal, t);
  return {unitOr(dir - glm::dot(dir, shading) * shading, any), strength};
}

Reflector Surfaces::reflectorAt(const Hit& hit, const SurfacePoint& point, const glm::vec3& normal,
                                const glm::vec3& to_eye) const {
  const gltf::Material& material = surfaces_[hit.surface].material;
  const auto texel = [&](const gltf::TextureRef& ref) {
    return textures_.data(ref, texcoord(hit, ref.texcoord));
  };
  Reflector out;
  const auto [t, strength] = anisotropy(hit, normal, point.shading);
  out.world_from_local = {t, glm::cross(point.shading, t), point.shading};
  out.view = liftedView(out.toLocal(glm::normalize(to_eye)));
  if ((out.measured = surfaces_[hit.surface].measured.get())) {
    out.alpha = glm::vec2(out.measured->alpha());
    out.specular_share = 0.5f;
    return out;
  }
  const glm::vec4 rough_metal = texel(material.metallic_roughness_texture);
  const float roughness = std::clamp(material.roughness * rough_metal.g, 0.0f, 1.0f);
  const float metal = std::clamp(material.metallic * rough_metal.b, 0.0f, 1.0f);
  out.alpha = ggxAlpha(roughness, strength);
  const float step = material.ior > 0.0f ? (material.ior - 1.0f) / (material.ior + 1.0f) : 1.0f;
  const float specular = material.specular * texel(material.specular_texture).a;
  const glm::vec3 tint(textures_.color(material.specular_color_texture,
                                       texcoord(hit, material.specular_color_texture.texcoord)));
  const glm::vec3 dielectric =
      specular * glm::min(step * step * material.specular_color * tint, glm::vec3(1.0f));
  out.f0 = glm::mix(dielectric, point.albedo, metal);
  out.f90 = glm::mix(specular, 1.0f, metal);
  if (metal >= 1.0f) return out;  // a metal has no diffuse part
  const glm::vec2 parts = (strength > 0.0f ? anisotropic_ : round_).at(out.view, roughness, strength);
  const glm::vec3 reflected = out.f0 * parts.x + out.f90 * parts.y;
  const float most = std::max({reflected.r, reflected.g, reflected.b});
  out.diffuse = (1.0f - metal) * std::max(1.0f - most, 0.0f) * point.albedo;
  const float rest = std::max({out.diffuse.r, out.diffuse.g, out.diffuse.b});
  out.specular_share = rest > 0.0f ? std::clamp(most / (most + rest), 0.1f, 0.9f) : 1.0f;
  return out;
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
  const glm::vec3 normal = point.shading;
  point.smooth = normal;
  if (material.normal_texture.texture >= 0) point.shading = mappedNormal(hit, point.shading);
  const glm::vec4 color = baseColor(hit);
  point.albedo = glm::vec3(color);
  point.alpha = color.a;
  point.emitted = emittedAt(hit);
  if (back) {
    point.geometric = -point.geometric;
    point.shading = -point.shading;
    point.smooth = -point.smooth;
  }
  point.glossy = !material.isDiffuse();
  if (point.glossy) point.reflector = reflectorAt(hit, point, normal, -dir);
  const float kept = 1.0f - transmission(hit);
  point.albedo *= kept;
  point.reflector.diffuse *= kept;
  return point;
}

}  // namespace lambent::baker::reference
