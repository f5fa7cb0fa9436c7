// How the surfaces of a group reflect where a ray meets them: the exit kernel of a point towards a direction,
// with which the radiance that leaves it is a dot product with the light that was transferred to it:
//   L_out(q -> v) = Σ_k c_k(v) l'_k,   c = specular lobe + diffuse, in the group's frame, per colour channel.
// The specular lobe is b(v) of the material's table, turned; the diffuse part is albedo (1 - metallic) (1 -
// the largest channel of the specular lobe's directional albedo) A_l/pi y_lm(n), so that both together never
// give more than they get. Textures and vertex colours are looked up at the point. Matte surfaces have only
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
  std::vector<std::int32_t> of_material;  // place in `entries`; -1: matte

  // order: bands of the transferred light, 4..6. Errors: a measured BRDF that has too few directions.
  static Result<BrdfTables> make(const Scene& scene, int order);
};

class SurfaceBrdfs {
 public:
  // `geometry` outlives this. `tables` are of the same order and may go. Errors: those of decodeImage.
  static Result<SurfaceBrdfs> load(const Scene& scene, const GroupGeometry& geometry,
                                   const BrdfTables& tables, DecodedImages& images, int order);

  // Not matte, and with glossy samples: a draw of a glossy material whose samples were planned as Lambert's
  // is matte.
  bool glossy(std::uint32_t triangle) const;
  // All kernels are the same in red, green and blue.
  bool grey() const;
  // Towards the unit direction `to` (group frame, away from the surface) of the point u, v on `triangle`
  // (barycentric weights of its corners 1 and 2): out[channel * order² + k], three channels. All zero where
  // `to` lies behind the triangle; a view above it but below the plane of the interpolated normal counts as
  // cos(theta_v) = kLeastViewCosine. From any thread; allocates nothing.
  void exitKernel(std::uint32_t triangle, float u, float v, const glm::vec3& to, std::span<float> out) const;

 private:
  struct State;
  explicit SurfaceBrdfs(std::shared_ptr<const State> state) : state_(std::move(state)) {}
  std::shared_ptr<const State> state_;
};

}  // namespace lambent::baker
