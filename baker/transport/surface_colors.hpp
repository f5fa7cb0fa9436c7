// Says what the surfaces of a group reflect and emit where a ray hits them (textured albedo and emission, as
// in the pictures), and which of the group's lights a triangle belongs to. The scene, the group's geometry
// and its planned lights come in. Colours are linear Rec.709.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/import/image.hpp"
#include "baker/import/scene.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

class SurfaceColors {
 public:
  // Errors: those of decodeImage.
  static Result<SurfaceColors> load(const Scene& scene, const GroupGeometry& geometry,
                                    std::span<const PlannedLight> lights, DecodedImages& images);

  // Returns base colour factor x texture x vertex colour, at most 1; 0 for unlit surfaces, which reflect
  // nothing, and less what passes through panes. Of smooth dielectrics it returns what the base and the layer
  // over it reflect together.
  glm::vec3 albedo(std::uint32_t triangle, float u, float v) const;
  // Returns the mean albedo of a smooth dielectric's layer, which is part of albedo(); 0 for other surfaces.
  glm::vec3 layer(std::uint32_t triangle) const { return surfaceOf(triangle).layer; }
  // Returns the emission at unit strength: the texture alone, 1 where there is none; 0 in the holes of
  // cut-outs. The triangle must belong to a light.
  glm::vec3 emission(std::uint32_t triangle, float u, float v) const;
  // Returns how much of the light that meets a pane passes its face: 1 - F0 of the layer, times the share
  // that is transmitted, times the base colour. It is that of a right angle at all angles, so that a window
  // of two faces passes 0.92 of the light, as people expect of it.
  glm::vec3 passed(std::uint32_t triangle, float u, float v) const;
  // Returns what the thickness of a pane passes of the light, over `length_m` inside (Beer's law).
  glm::vec3 passedInside(std::uint32_t triangle, float length_m) const;
  // Returns KHR_materials_volume's thickness of a pane, which counts where its other face is missing.
  float thickness(std::uint32_t triangle) const { return surfaceOf(triangle).thickness_m; }
  // Returns F0 of a pane; 0 for other surfaces.
  float paneReflectance(std::uint32_t triangle) const { return surfaceOf(triangle).pane_reflectance; }
  // Returns how much of what lies behind is hidden: 1 where opaque, 0 or 1 where cut out, alpha where
  // blended, and less what panes pass.
  float coverage(std::uint32_t triangle, float u, float v) const;
  // Returns the column of the light that this triangle belongs to, or kNoLight.
  std::uint32_t lightOf(std::uint32_t triangle) const { return surfaceOf(triangle).light; }
  // Returns whether the triangle has glossy samples: these reflect light even where it is black.
  bool glossy(std::uint32_t triangle) const { return surfaceOf(triangle).glossy; }

  // Returns whether red, green and blue are the same wherever light is reflected or emitted at unit strength,
  // so that one channel of transfer is enough.
  bool grey() const { return grey_; }
  // Returns whether all panes pass as much of red as of green and blue.
  bool greyPanes() const { return grey_panes_; }
  // Returns whether light that the group emits arrives without colour at surfaces that it meets first.
  bool greyEmission() const { return grey_emission_; }

 private:
  struct Texture {
    std::shared_ptr<const DecodedImage> image;  // null means white
    gltf::Sampler sampler;
  };
  struct Surface {
    std::uint32_t first_triangle = 0;
    glm::vec3 base_color{0.0f};
    glm::vec3 layer{0.0f};  // mean albedo of a smooth dielectric's layer
    Texture base_texture, emissive_texture, transmission_texture;
    std::uint32_t light = kNoLight;
    bool colored_vertices = false, glossy = false;
    float base_alpha = 1.0f, alpha_cutoff = 0.0f;  // cutoff 0 means not cut out
    gltf::AlphaMode alpha_mode = gltf::AlphaMode::Opaque;
    float transmission = 0.0f;  // of panes; 0 for other surfaces
    float pane_reflectance = 0.0f, thickness_m = 0.0f, attenuation_distance_m = 0.0f;
    glm::vec3 attenuation_color{1.0f};
  };
  const Surface& surfaceOf(std::uint32_t triangle) const { return surfaces_[surface_of_[triangle]]; }
  glm::vec4 lookUp(const Texture& texture, const std::vector<glm::vec2>& texcoords, std::uint32_t triangle,
                   float u, float v) const;
  glm::vec3 baseColor(const Surface& surface, std::uint32_t triangle, float u, float v) const;
  float transmission(const Surface& surface, std::uint32_t triangle, float u, float v) const;
  float alpha(const Surface& surface, std::uint32_t triangle, float u, float v) const;
  glm::vec2 at(const std::vector<glm::vec2>& texcoords, std::uint32_t triangle, float u, float v) const;
  glm::vec4 vertexColor(std::uint32_t triangle, float u, float v) const;

  const GroupGeometry* geometry_ = nullptr;  // must outlive this
  std::vector<Surface> surfaces_;            // one per draw
  std::vector<std::uint32_t> surface_of_;    // triangle -> draw
  bool grey_ = true, grey_emission_ = true, grey_panes_ = true;
};

}  // namespace lambent::baker
