// How the surfaces of a group reflect where a ray meets them: the exit kernel of a point towards a direction,
// with which the radiance that leaves it is a dot product with the light that was transferred to it:
//   L_out(q -> v) = Σ_k c_k(v) l'_k,   c = specular lobe + diffuse, in the group's frame, per colour channel.
// The specular lobe is b(v) of the material's table, turned; the diffuse part is albedo (1 - metallic) (1 -
// the largest channel of the specular lobe's directional albedo) A_l/pi y_lm(n), so that both together never
// give more than they get. Textures and vertex colours are looked up at the point. Diffuse surfaces have only
// the diffuse part.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "baker/brdf/brdf.hpp"
#include "baker/import/image.hpp"
#include "baker/transport/group_geometry.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// The tables that a scene's glossy materials need.
struct BrdfTables {
  struct Entry {
    bundle::BrdfFamily family;
    std::string name;
    bundle::BrdfTable table;
  };
  std::vector<Entry> entries;
  std::vector<std::int32_t> of_material;  // place in `entries`; -1: diffuse

  // order: bands, 4..9, the first `shipped` of which (4..6) will be in the bundle. Errors: a measured BRDF
  // that has too few directions.
  static Result<BrdfTables> make(const Scene& scene, int order, int shipped);
};

// Of at most as many bands as the table has.
bundle::BrdfTable firstBands(const bundle::BrdfTable& table, int order);

// What a point of a glossy surface that is not measured reflects, after textures: for paths that follow a
// highlight which is sharper than few bands carry. Directions in the group's frame.
struct PointReflection {
  glm::vec3 normal{0.0f, 0.0f, 1.0f}, tangent{1.0f, 0.0f, 0.0f};  // unit, across each other
  glm::vec3 geometric{0.0f, 0.0f, 1.0f};                          // of the triangle, unit
  float alpha_t = 1.0f, alpha_b = 1.0f;                           // GGX, along the tangent and across
  glm::vec3 f0{0.0f};
  float f90 = 0.0f;
  glm::vec3 diffuse{0.0f};  // base colour (1 - metallic) (1 - directional albedo of the specular lobe)
};

class SurfaceBrdfs {
 public:
  // `geometry` outlives this. `tables` are of the same order and may go. Errors: those of decodeImage.
  static Result<SurfaceBrdfs> load(const Scene& scene, const GroupGeometry& geometry,
                                   const BrdfTables& tables, DecodedImages& images, int order);

  // The same surfaces, of whose kernels only so many bands are given; at most as many as were loaded.
  SurfaceBrdfs firstBands(int order) const { return {state_, order}; }

  // Not diffuse, and with glossy samples: a draw of a glossy material whose samples were planned as Lambert's
  // is diffuse.
  bool glossy(std::uint32_t triangle) const;
  // All kernels are the same in red, green and blue.
  bool grey() const;
  // Towards the unit direction `to` (group frame, away from the surface) of the point u, v on `triangle`
  // (barycentric weights of its corners 1 and 2): out[channel * order² + k], three channels. All zero where
  // `to` lies behind the triangle; a view above it but below the plane of the interpolated normal counts as
  // cos(theta_v) = kLeastViewCosine. From any thread; allocates nothing.
  void exitKernel(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) const;

  // Perceptual roughness of a glossy point; 1 where its BRDF is measured, or where it is diffuse.
  float roughness(std::uint32_t triangle, float u, float v) const;
  // Of a glossy point that is not measured, seen from `to` as in exitKernel.
  PointReflection reflection(std::uint32_t triangle, float u, float v, const glm::vec3& to) const;

 private:
  struct State;
  SurfaceBrdfs(std::shared_ptr<const State> state, int order) : state_(std::move(state)), order_(order) {}
  std::shared_ptr<const State> state_;
  int order_;
};

}  // namespace lambent::baker
