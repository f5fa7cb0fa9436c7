// Bakes one rigid group of surfaces, from its decoded meshes to codes: samples, rays, bounces, coding.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "baker/bake/group_scene.hpp"
#include "baker/compress/cpca.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "baker/effects/neighborhood/bodies.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/effects/surface/bounces.hpp"
#include "baker/effects/surface/direct.hpp"
#include "baker/effects/surface/inside_faces.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/light_probes/light_probes.hpp"
#include "baker/plan/group_lights.hpp"
#include "baker/transport/group_geometry.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/bundle/container.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// Computes the light of a group's surfaces, diffuse and glossy together: direct light of both, its fit to the
// faces, and the bounces between them.

// SurfaceFigures measure the bake of one group's surfaces, whether it was done now or found in the cache.
struct SurfaceFigures {
  std::uint64_t filled_samples = 0, glossy_samples = 0;
  std::uint64_t hit_bytes = 0;  // memory of the hits kept for the bounces
  double worst_error = 0.0, worst_glossy_error = 0.0, left_out = 0.0;
  std::vector<double> pass_energy;
  struct Rays {
    std::uint64_t traced = 0,
                  kept = 0;  // in this run; saved by results of earlier runs
  };
  Rays diffuse, glossy;
  double ray_seconds = 0.0;  // of this run
  std::optional<bundle::PictureError> picture_error;
  float codes_bound = 0.0f, glossy_codes_bound = 0.0f;
};

template <>
inline constexpr bool kPlainBytes<bundle::PictureError> = true;

// Points of one part of a group's surfaces as eyes see them (baker/importance), to measure there how wrong
// pictures are.
struct ViewPoints {
  FacePoints points;                // in the order of the eyes
  std::vector<glm::vec3> weights;   // of the corners of each point's triangle
  std::vector<glm::vec3> to_eyes;   // unit directions
  std::vector<std::uint32_t> eyes;  // the eye that sees each point, rising
  std::uint32_t stands_for = 1;     // so many points that are seen
  // The same points, traced with as many rays as vertices, whose noise they tell, and with many. Null without
  // surfaces of the part in the group.
  std::unique_ptr<TracedPoints> noisy, exact;

  bool seen(std::size_t p) const {
    return noisy->direct.looks.valid[p] != 0 && exact->direct.looks.valid[p] != 0;
  }
  // Returns the share of the squared difference between few and many rays that the many make.
  double noiseOfExact() const {
    const std::size_t few = noisy->pass().settings().rays, many = exact->pass().settings().rays;
    return static_cast<double>(few) / static_cast<double>(few + many);
  }
};

struct TracedView {
  std::vector<float> eye_weights;   // shares of all pictures
  std::array<ViewPoints, 2> parts;  // by SurfacePart; glossy ones are a few hundred, as their rays are dear

  const ViewPoints& of(SurfacePart part) const { return parts[static_cast<std::size_t>(part)]; }
};

// Returns nothing if stopped. Without surfaces in sight, there are no points. No result is kept.
std::optional<TracedView> traceView(const DirectPass& vertices, const GroupScene& group,
                                    const BakeContext& context);

// Transfers of each sample cell: that of the environment (for a glossy cell visibility, then bounced light),
// followed by that of the group's lights if it has any.
using SurfaceCodes = std::vector<std::vector<CodedTransfer>>;

struct SurfaceTransport {
  DirectResult direct;
  std::optional<BounceResult> bounced;
  std::array<std::size_t, 2> inside = {};  // samples inside faces that gathered bounces too, by SurfacePart
  TracedView view;
  SurfaceFigures figures;  // without the errors of coding

  const GlossyField* glossy() const { return direct.glossy.visibility.empty() ? nullptr : &direct.glossy; }
};

// The group must be prepared for rays. Returns nothing if stopped. Checkpoints of the bounces stay
// (dropBounces).
std::optional<SurfaceTransport> transportLight(const GroupScene& group, const BakeContext& context);
// Measures how wrong pictures of the surfaces are (picture_error.cpp), as codes show them; without codes, if
// they are null. Returns nothing if too few points are seen for a figure.
std::optional<bundle::PictureError> measurePictureError(const GroupScene& group,
                                                        const SurfaceTransport& light,
                                                        const SurfaceCodes* cells);

// The coded transfer of a group's surfaces: all that the group hands to the bundle of it.
struct SurfaceCells {
  SurfaceCodes cells;
  std::vector<std::uint8_t> importance;  // of each sample (description.hpp)
  SurfaceFigures figures;
};

// A capture proxy as its payload.
struct BakedProxy {
  bundle::Blob bytes;                    // empty without levels
  std::vector<std::uint32_t> triangles;  // of each level, finest first
};

struct BakedGroup {
  GroupGeometry geometry;  // of which draws and bounds are used
  SampleSet samples;
  std::vector<PlannedLight> lights;
  SurfaceCells surfaces;
  LightProbes light_probes;  // in the frame of SampleSet::positions
  BakedProxy proxy;
  std::optional<BakedVolume> volume;  // if set, the members above are empty but for light_probes
  std::optional<BakedNeighborhood> neighborhood;
};

// Bakes group `index` of the plan, which is one of surfaces. Results of earlier runs with the same inputs are
// taken from the cache. Errors: no memory for the ray hierarchy, images that cannot be decoded, "stopped".
// Adds to the report.
Result<BakedGroup> bakeGroup(const SceneBake& bake, const SurfaceInputs& inputs, std::size_t index,
                             const BakeContext& context, BakeReport& report);

// A neighborhood, of surfaces or of a volume, beside what the plan and the options ask for.
struct Around {
  const SceneBake& bake;
  std::size_t group = 0;   // index in the plan
  glm::vec3 origin{0.0f};  // of the body's points, in the group's frame
  Box3 bounds;             // of the body, relative to `origin`
  std::size_t rays = 0;    // from each grid point
};

// Finds the neighborhood in the cache, or bakes it with the body that `make` returns. The key of `light` must
// cover all that the body's answers depend on. Adds to the report, at least a notice if there is none.
// Errors: those of `make`, "stopped".
Result<void> bakeAround(const Around& around, const BakeContext& light,
                        const std::function<Result<std::unique_ptr<Body>>()>& make, BakedGroup& out,
                        BakeReport& report);

// Bakes one volume, from its density to codes: quantization, rays, scattering, coding.

// Checks whether the volume can be baked. Errors: a phase function that needs matrices with more than 6 bands
// of light, or shaded samples that do not fit into one page of the runtime.
Result<void> checkVolume(const Scene& scene, const SceneVolume& volume, const BakeOptions& options);

// Bakes group `index` of the plan, which is a volume. `baked` holds the groups before it, among them all
// those of surfaces. Errors: no memory for the ray hierarchy, "stopped".
Result<BakedGroup> bakeVolume(const SceneBake& bake, DecodedImages& images, std::size_t index,
                              const std::vector<BakedGroup>& baked, const BakeContext& context,
                              BakeReport& report);

// A QuantizedDensity is the density as the bundle stores it.
struct QuantizedDensity {
  std::uint32_t bits = 8;
  float largest = 0.0f;          // m^-1, density of the largest code
  std::vector<std::byte> codes;  // as in bundle::VolumeGrid
  std::vector<float> values;     // m^-1, densities that the codes stand for
  double error = 0.0;            // RMS over voxels with density, relative to their RMS
};
// Uses 8 bits if that keeps the error under 0.5 %, else 16 (2e-5 of the largest density).
QuantizedDensity quantizeDensity(std::span<const float> density);

// Returns the volume of a group as the bundle stores it, without its transfer.
BakedVolume placeVolume(const Scene& scene, const RigidGroup& group, const QuantizedDensity& density);

// Puts a bundle together from what the bake found. Its views lie in the order in which a runtime wants them:
// meshes and rows, images, then the codebook and cluster ids of each cell, BRDF tables, light weights and
// proxies, then the weight planes of all cells by falling variance.

struct AssembledBundle {
  bundle::Description description;
  std::vector<bundle::Blob> blobs;
};

// `baked` has one entry per plan group. Adds sizes by kind to the report.
AssembledBundle assemble(const SceneBake& bake, ShippedMeshes meshes, const std::vector<BakedGroup>& baked,
                         BakeReport& report);

}  // namespace lambent::baker
