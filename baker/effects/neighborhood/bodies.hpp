// Presents the surfaces of a rigid group as a body. The light that leaves a hit towards the ray's origin is,
// for diffuse surfaces, their albedo times their baked transfer (all light, bounces included); for rough
// glossy surfaces and measured BRDFs, the exit kernel times the light transferred by their baked matrices.
// Few bands would blur the highlights of smoother surfaces; there it is the light at the end of paths that
// follow the highlight until they leave the body or hit something rougher (caustics), plus the diffuse part.
// Backs of single-sided surfaces send nothing, and light of the group's own lamps is not included.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/effects/neighborhood/light_change.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/direct.hpp"

namespace lambent::baker {

// BakedSurfaces are the results of the group's bake.
struct BakedSurfaces {
  const TransferField& direct;   // of all samples, with 1 output
  const TransferField* bounced;  // null: none of the group's light comes back to it
  bool sends;                    // false: the body takes light away and sends none, as without bounces
  const SurfaceBrdfs* brdfs;     // null: all surfaces are diffuse
  const GlossyField* glossy;     // null if `brdfs` is
};

class SurfaceBody : public Body {
 public:
  // `scene` and the BRDFs must outlive this; transfer is copied.
  SurfaceBody(const TracedScene& scene, const BakedSurfaces& baked);

  int order() const override { return order_; }
  std::uint32_t channels() const override { return channels_; }
  glm::vec3 centre() const override { return centre_; }
  float radius() const override { return radius_; }
  void look(const glm::vec3& from, const DirectionPacket& along, std::size_t first_ray, bool with_light,
            BodyLook& out) const override;

 private:
  class Paths;
  enum class Way : std::uint8_t { Matte, Kernel, Path };
  Way wayOf(const FirstHit& hit) const;
  // Adds scale * the light that leaves the hit against `along` to `out`, [channel][order²].
  void addDiffuse(const FirstHit& hit, const glm::vec3& scale, std::span<float> out) const;
  void addPlain(const FirstHit& hit, const glm::vec3& scale, std::span<float> out) const;
  // `chance` in [0, 1) picks the corner whose matrix stands for the hit's.
  void addKernel(const FirstHit& hit, const glm::vec3& along, float chance, const glm::vec3& scale,
                 std::span<float> out) const;

  const TracedScene scene_;
  const SurfaceBrdfs* brdfs_;
  int order_;
  std::uint32_t channels_ = 0;
  glm::vec3 centre_{0.0f};
  float radius_ = 0.0f;
  std::vector<float> diffuse_;   // [sample][channel][order²], of all light
  std::vector<float> matrices_;  // [sample][channel][output][column], of glossy samples
  std::size_t matrix_outputs_ = 0, matrix_channels_ = 0;
};

// Presents a volume as a body: the light that it lets through, and the light that it scatters.
class VolumeBody : public Body {
 public:
  // Does what marchVolume() does with a baked volume (baker/effects/volume/volume.hpp).
  using March = std::function<float(const glm::vec3& origin, const glm::vec3& direction, float t_max,
                                    std::span<float> scattered)>;
  // `order` is that of incident light. The bounds are those of the volume, in its group's frame.
  VolumeBody(March march, int order, const glm::vec3& bounds_min, const glm::vec3& bounds_max)
      : march_(std::move(march)),
        order_(order),
        centre_(0.5f * (bounds_min + bounds_max)),
        radius_(0.5f * glm::distance(bounds_min, bounds_max)) {}

  int order() const override { return order_; }
  std::uint32_t channels() const override { return 3; }
  glm::vec3 centre() const override { return centre_; }
  float radius() const override { return radius_; }
  void look(const glm::vec3& from, const DirectionPacket& along, std::size_t first_ray, bool with_light,
            BodyLook& out) const override;

 private:
  March march_;
  int order_;
  glm::vec3 centre_;
  float radius_;
};

}  // namespace lambent::baker
