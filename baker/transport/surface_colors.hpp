// What the surfaces of a group reflect and give off where a ray meets them: textured albedo and emission, as
// the pictures show them. Also which of the group's lights a triangle belongs to. Comes in: the scene, the
// group's geometry and its planned lights. Colours linear Rec.709.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/import/image.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

class SurfaceColors {
 public:
  // Errors: those of decodeImage.
  static Result<SurfaceColors> load(const Scene& scene, const GroupGeometry& geometry,
                                    std::span<const PlannedLight> lights, DecodedImages& images);

  // Base colour factor x texture x vertex colour, at most 1; 0 for unlit surfaces, which reflect nothing.
  glm::vec3 albedo(std::uint32_t triangle, float u, float v) const;
  // Emission at unit strength: the texture alone, 1 where there is none; 0 in the holes of cut-outs. Of
  // triangles with a light.
  glm::vec3 emission(std::uint32_t triangle, float u, float v) const;
  // How much of what lies behind is hidden: 1 where opaque, 0 or 1 where cut out, alpha where blended.
  float coverage(std::uint32_t triangle, float u, float v) const;
  // Column of the light that this triangle gives off; kNoLight where it gives off none.
  std::uint32_t lightOf(std::uint32_t triangle) const { return surfaceOf(triangle).light; }
  // Has glossy samples: reflects even where it is black.
  bool glossy(std::uint32_t triangle) const { return surfaceOf(triangle).glossy; }

  // Red, green and blue are the same wherever light is reflected or given off at unit strength: one channel
  // of transfer tells all.
  bool grey() const { return grey_; }
  bool greyEmission() const { return grey_emission_; }

 private:
  struct Texture {
    std::shared_ptr<const DecodedImage> image;  // null: white
    gltf::Sampler sampler;
  };
  struct Surface {
    std::uint32_t first_triangle = 0;
    glm::vec3 base_color{0.0f};
    Texture base_texture, emissive_texture;
    std::uint32_t light = kNoLight;
    bool colored_vertices = false, glossy = false;
    float base_alpha = 1.0f, alpha_cutoff = 0.0f;  // cutoff 0: not cut out
    gltf::AlphaMode alpha_mode = gltf::AlphaMode::Opaque;
  };
  const Surface& surfaceOf(std::uint32_t triangle) const { return surfaces_[surface_of_[triangle]]; }
  glm::vec4 lookUp(const Texture& texture, const std::vector<glm::vec2>& texcoords, std::uint32_t triangle,
                   float u, float v) const;
  float alpha(const Surface& surface, std::uint32_t triangle, float u, float v) const;
  glm::vec2 at(const std::vector<glm::vec2>& texcoords, std::uint32_t triangle, float u, float v) const;
  glm::vec4 vertexColor(std::uint32_t triangle, float u, float v) const;

  const GroupGeometry* geometry_ = nullptr;  // outlives this
  std::vector<Surface> surfaces_;            // one per draw
  std::vector<std::uint32_t> surface_of_;    // triangle -> draw
  bool grey_ = true, grey_emission_ = true;
};

}  // namespace lambent::baker
