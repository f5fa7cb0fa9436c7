// Holds the scene as triangles in world space, with what a path needs at a hit. The importer's Scene comes
// in, with all nodes in place. Each node and primitive becomes one Surface. For a hit it returns the point
// with both normals, its reflection (docs/conventions.md, "Materials") and its emitted radiance. Triangles of
// mirrored nodes are flipped, so that counter-clockwise is the front everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "baker/import/image.hpp"
#include "baker/import/scene.hpp"
#include "reference/brdf.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker::reference {

// Samples the decoded images of textures for rays (sampleImage).
class Textures {
 public:
  // Decodes the images that materials of `scene` use. Errors name the image.
  static Result<Textures> load(const Scene& scene);

  // Returns the sRGB colour converted to linear, with alpha, or white if there is no such texture.
  glm::vec4 color(const gltf::TextureRef& ref, const glm::vec2& uv) const;
  // Returns the values as stored, 0..1.
  glm::vec4 data(const gltf::TextureRef& ref, const glm::vec2& uv) const;

 private:
  const DecodedImage* imageOf(const gltf::TextureRef& ref) const {
    return ref.texture < 0 ? nullptr : images_[static_cast<std::size_t>(ref.texture)].get();
  }

  std::vector<gltf::Texture> textures_;
  std::vector<std::shared_ptr<const DecodedImage>> images_;  // by texture; null: none
};

inline float largest(const glm::vec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

struct Surface {
  gltf::Material material;
  std::shared_ptr<const MeasuredReflection> measured;  // null: GGX or diffuse
  std::uint32_t first_vertex = 0, vertex_count = 0;
  std::uint32_t first_triangle = 0, triangle_count = 0;
  float handedness = 1.0f;  // -1 in mirrored nodes; the bitangent is cross(n, t) * w * handedness
};

// A Hit is where a ray meets a triangle. The barycentric coordinates u and v belong to the triangle's second
// and third corner.
struct Hit {
  static constexpr std::uint32_t kNothing = ~0u;
  std::uint32_t surface = kNothing;
  std::uint32_t triangle = 0;  // index among the triangles of all surfaces
  float u = 0.0f, v = 0.0f, t = 0.0f;
  bool any() const { return surface != kNothing; }
};

// A SurfacePoint is a point on the side of a surface that the ray hit. On the back of a double-sided surface
// the normals are flipped. On the back of a single-sided one they are not, and `blocked` says that no light
// comes from there.
struct SurfacePoint {
  glm::vec3 position{0.0f};
  glm::vec3 geometric{0.0f};  // unit; directions below it are below the horizon
  glm::vec3 shading{0.0f};    // unit; used for the cosine only
  glm::vec3 smooth{0.0f};     // the shading normal before normal maps
  glm::vec3 albedo{0.0f};     // base colour; the whole reflectance of a diffuse surface
  bool glossy = false;        // reflects by `reflector` instead of `albedo`
  Reflector reflector;        // for the direction to the ray's origin
  glm::vec3 emitted{0.0f};    // radiance, equal in all directions
  float alpha = 1.0f;
  float offset = 0.0f;  // distance at which rays start off the surface
  bool unlit = false;   // shows `albedo` as its radiance
  bool blocked = false;

  glm::vec3 origin() const { return position + offset * geometric; }
  Horizons horizons() const { return {smooth, geometric}; }
};

class Surfaces {
 public:
  // Errors: a texture cannot be decoded.
  static Result<Surfaces> build(const Scene& scene);

  const std::vector<Surface>& surfaces() const { return surfaces_; }
  const std::vector<glm::vec3>& positions() const { return positions_; }
  const std::vector<glm::uvec3>& triangles() const { return triangles_; }

  SurfacePoint pointAt(const Hit& hit, const glm::vec3& dir) const;
  // Returns the alpha of the front side, for cut-outs (in the ray filter) and blended surfaces.
  float alphaAt(const Hit& hit) const;
  glm::vec3 emittedAt(const Hit& hit) const;
  // Returns what a pane's face passes of the light: that of a right angle, at all angles.
  glm::vec3 passedAt(const Hit& hit) const;
  // Returns the triangle's geometric normal on the front side, with twice its area as length.
  glm::dvec3 areaVector(std::uint32_t triangle) const;

 private:
  template <typename T>
  T interpolated(const std::vector<T>& values, const Hit& hit) const;
  glm::vec2 texcoord(const Hit& hit, std::uint32_t set) const;
  glm::vec4 baseColor(const Hit& hit) const;
  float transmission(const Hit& hit) const;  // 0 where the surface is no pane
  glm::vec3 mappedNormal(const Hit& hit, const glm::vec3& normal) const;
  glm::vec4 tangent(const Hit& hit, const glm::vec3& normal) const;
  Reflector reflectorAt(const Hit& hit, const SurfacePoint& point, const glm::vec3& normal,
                        const glm::vec3& to_eye) const;
  // Returns the direction of the longer lobe (unit, orthogonal to the shading normal) and the strength, 0..1.
  std::pair<glm::vec3, float> anisotropy(const Hit& hit, const glm::vec3& normal,
                                         const glm::vec3& shading) const;
  void buildTables();

  std::vector<Surface> surfaces_;
  std::vector<glm::vec3> positions_, normals_;
  std::vector<glm::vec2> texcoords_[2];
  std::vector<glm::vec4> colors_;
  std::vector<glm::vec4> tangents_;  // w = 0 if the file has none
  std::vector<glm::uvec3> triangles_;
  Textures textures_;
  AlbedoTable round_, anisotropic_;
};

}  // namespace lambent::baker::reference
