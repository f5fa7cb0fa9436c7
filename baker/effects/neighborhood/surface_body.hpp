// The surfaces of a rigid group as a body. What leaves a point that a ray met, towards where the ray came
// from: of diffuse surfaces their albedo times their baked transfer (all light, bounces included); of rough
// glossy ones and measured BRDFs the exit kernel times the transferred light of their baked matrices; of
// smoother ones, whose highlights few bands would blur, the light at the end of paths that follow the
// highlight until they leave the body or meet something rougher (caustics), plus their diffuse part as of
// diffuse ones. Backs of single-sided surfaces send nothing. Light of the group's own lamps is not part of
// it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "baker/brdf/surface_brdfs.hpp"
#include "baker/effects/diffuse/bounces.hpp"
#include "baker/effects/glossy/glossy_transport.hpp"
#include "baker/effects/neighborhood/body.hpp"

namespace lambent::baker {

// What was baked for the group.
struct BakedSurfaces {
  const TransferField& direct;   // of all samples, outputs 1
  const TransferField* bounced;  // null: without bounces nothing sends light
  const SurfaceBrdfs* brdfs;     // null: all is diffuse
  const GlossyField* glossy;     // as brdfs
};

class SurfaceBody : public Body {
 public:
  // `scene` and the BRDFs outlive this; transfer is copied.
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
  // scale * what leaves the hit against `along`, added to out: [channel][order²].
  void addDiffuse(const FirstHit& hit, const glm::vec3& scale, std::span<float> out) const;
  void addPlain(const FirstHit& hit, const glm::vec3& scale, std::span<float> out) const;
  // chance: from [0, 1), picks the corner whose matrix stands for the hit's.
  void addKernel(const FirstHit& hit, const glm::vec3& along, float chance, const glm::vec3& scale,
                 std::span<float> out) const;

  const TracedScene scene_;
  const SurfaceBrdfs* brdfs_;
  int order_;
  std::uint32_t channels_ = 0;
  glm::vec3 centre_{0.0f};
  float radius_ = 0.0f;
  std::vector<float> diffuse_;   // of all light: [sample][channel][order²]
  std::vector<float> matrices_;  // of glossy samples, where some are rough: [sample][channel][output][column]
  std::size_t matrix_outputs_ = 0, matrix_channels_ = 0;
};

}  // namespace lambent::baker
