// Computes how the surfaces of a group reflect at hits: the exit kernel of a point towards a direction. The
// radiance that leaves the point is the dot product of the kernel with the light transferred to the point:
//   L_out(q -> v) = Σ_k c_k(v) l'_k,   c = specular lobe + diffuse, in the group's frame, per colour channel.
// The specular lobe is b(v) of the material's table, rotated; the diffuse part is albedo (1 - metallic) (1 -
// the largest channel of the specular lobe's directional albedo) A_l/pi y_lm(n), so that both together never
// reflect more than they receive. Textures and vertex colours are looked up at the point. Diffuse surfaces
// have only the diffuse part.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/brdf/brdf.hpp"
#include "baker/import/image.hpp"
#include "baker/transport/group_geometry.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// BrdfTables are the tables that a scene's glossy materials need.
struct BrdfTables {
  struct Entry {
    bundle::BrdfFamily family;
    std::string name;
    bundle::BrdfTable table;
  };
  std::vector<Entry> entries;
  std::vector<std::int32_t> of_material;  // index in `entries`; -1: diffuse

  // Makes tables of `order` bands, 4..9, of which the bundle will have the first `shipped` (4..6). Errors: a
  // measured BRDF with too few directions.
  static Result<BrdfTables> make(const Scene& scene, int order, int shipped);
};

// Returns the table with at most its first `order` bands.
bundle::BrdfTable firstBands(const bundle::BrdfTable& table, int order);

// A PointReflection describes the reflection at a point of a glossy surface whose BRDF is not measured, after
// textures. Paths use it to follow highlights that are sharper than a few bands can represent. Directions are
// in the group's frame.
struct PointReflection {
  glm::vec3 normal{0.0f, 0.0f, 1.0f}, tangent{1.0f, 0.0f, 0.0f};  // unit and orthogonal
  glm::vec3 geometric{0.0f, 0.0f, 1.0f};                          // of the triangle, unit
  float alpha_t = 1.0f, alpha_b = 1.0f;                           // GGX, along the tangent and across
  glm::vec3 f0{0.0f};
  float f90 = 0.0f;
  glm::vec3 diffuse{0.0f};  // base colour (1 - metallic) (1 - directional albedo of the specular lobe)
};

class SurfaceBrdfs {
 public:
  // `geometry` must outlive this. `tables` must have the same order and are copied. Errors: those of
  // decodeImage.
  static Result<SurfaceBrdfs> load(const Scene& scene, const GroupGeometry& geometry,
                                   const BrdfTables& tables, DecodedImages& images, int order);

  // Returns whether the triangle has glossy samples. It has none if its material is glossy but its samples
  // were planned as diffuse.
  bool glossy(std::uint32_t triangle) const;
  // Returns whether all kernels are the same in red, green and blue.
  bool grey() const;
  // Computes the kernel of a point towards the unit direction `to` (group frame, away from the surface):
  // out[channel * order² + k], with three channels, of at most as many bands as were loaded. u and v are
  // barycentric weights of the triangle's corners 1 and 2. The kernel is zero if `to` lies behind the
  // triangle; a view above it but below the plane of the interpolated normal counts as cos(theta_v) =
  // kLeastViewCosine. May be called from any thread; allocates nothing.
  void exitKernel(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) const;

  // Returns the perceptual roughness of a glossy point, or 1 if its BRDF is measured or it is diffuse.
  float roughness(std::uint32_t triangle, float u, float v) const;
  // Returns whether the triangle is a smooth dielectric: its samples are diffuse, under a specular layer.
  bool layered(std::uint32_t triangle) const;
  // Returns the largest channel of the directional albedo of that layer, seen at an angle with this cosine,
  // as if no texture made it smoother.
  float layerAlbedo(std::uint32_t triangle, float cosine) const;
  // Describes a point of a smooth dielectric, or a glossy one whose BRDF is not measured, seen from `to` as
  // in exitKernel.
  PointReflection reflection(std::uint32_t triangle, float u, float v, const glm::vec3& to) const;

 private:
  struct State;
  explicit SurfaceBrdfs(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  std::shared_ptr<const State> state_;
};

// Samples one step of a path through a GGX highlight. It samples visible normals (Heitz 2018; caps after
// Dupuy and Benyoub 2023), whose weight is F G2/G1; that of a mirror is its reflectance.

struct HighlightSample {
  glm::vec3 direction{0.0f};  // unit, group frame, above the plane of the normal: where light comes from
  // Light from `direction` is what a ray along `ray` meets: it is the same direction, or its mirror image if
  // the triangle hides it (docs/conventions.md, "Materials").
  glm::vec3 ray{0.0f};
  glm::vec3 weight{0.0f};  // f cos / pdf
};

// `to` is unit and points to where the light is wanted; `u` is in the unit square. The weight is 0 if there
// is no sample.
HighlightSample sampleHighlight(const PointReflection& at, const glm::vec3& to, const glm::vec2& u);

// Returns points that are evenly spread over the unit square for successive numbers: R2, the generalised
// golden ratio (Roberts 2018), shifted for each `step` of a path.
glm::vec2 choices(std::uint32_t number, std::uint32_t step);

// Measures how much of what a group's glossy surfaces reflect depends on each band of the transferred light:
// the squared coefficients of their exit kernels. They weight the errors of coded transfer.

// Returns for each band the mean of c_lm² over m, over places spread over the glossy triangles, over views
// from 25 to 80 degrees from the normal and over red, green and blue, relative to band 0. Bands from `order`
// on are 0.
std::array<double, 6> kernelPower(const GroupGeometry& geometry, const SurfaceBrdfs& brdfs, int order);

}  // namespace lambent::baker
