// Runs a whole bake as one call: a scene comes in, and a bundle goes out. The command line, the editor and
// tests all call this. Stages report to a Progress and can be stopped. Nothing is written before everything
// is known, so a bake that stops or fails leaves the old bundle as it was.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/plan/effect_plan.hpp"
#include "baker/refine/refine.hpp"
#include "runtime/base/result.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

// Says how much of an effect's work on a group was done again.
enum class Reuse : std::uint8_t {
  Baked,       // at least some rays were traced
  Regathered,  // hits were found in the cache; light was gathered over them again, and coded
  Found,       // the coded result was found; nothing was left to do
};
const char* reuseName(Reuse reuse);  // "baked", "re-gathered", "found"

struct BakeReport {
  std::uint64_t vertices = 0, triangles = 0, samples = 0, filled_samples = 0;
  std::uint64_t texel_samples = 0;  // of the samples, those of texels
  std::uint64_t rays = 0;           // traced in this run
  std::uint64_t rays_kept = 0;      // rays that results of earlier runs saved
  std::uint64_t file_bytes = 0, mesh_bytes = 0, transfer_bytes = 0, proxy_bytes = 0, image_bytes = 0;
  double ray_seconds = 0.0;         // time of the passes that trace rays
  double worst_error = 0.0;         // of the worst cell of coded transfer, relative RMS
  double worst_glossy_error = 0.0;  // of the worst glossy cell: relative RMS of all light that it shows
  std::uint64_t glossy_samples = 0;
  std::uint64_t lights = 0;     // lights that belong to groups, over all groups
  std::uint64_t hit_bytes = 0;  // memory of the hits kept for the bounces, in the group with most
  // Energy of each pass of bounces relative to direct light (bounces.hpp), of the group with most passes.
  std::vector<double> pass_energy;
  struct Group {
    std::string name;
    std::uint64_t light_probes = 0;
    std::vector<std::uint32_t> proxy_triangles;  // of each level, finest first; empty: no proxy
    struct Effect {
      std::string name;
      Reuse reuse = Reuse::Baked;
      std::uint64_t rays = 0, rays_kept = 0;
    };
    std::vector<Effect> effects;
    std::optional<bundle::PictureError> picture_error = {};
    float codes_bound = 0.0f, glossy_codes_bound = 0.0f;
  };
  std::vector<Group> groups;
  struct Neighborhood {
    std::string name;  // of the group
    glm::uvec3 size{0};
    glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame, m
    std::uint64_t inside_points = 0;  // points inside the body, whose values are continued from outside
    double error = 0.0;               // RMS error of the codes, relative to irradiance without the body
    double change_error = 0.0;  // relative to the change; 99 % of the points with a change stay below it
  };
  std::vector<Neighborhood> neighborhoods;
  RefineReport refinement;
  struct Volume {
    std::string name;
    std::uint64_t voxels = 0, samples = 0;
    std::uint32_t density_bits = 8;
    double density_error = 0.0;  // error of quantization, relative RMS
    int iterations = 0;          // of the solver for multiple scattering, which stopped at `residual`
    double residual = 0.0;
    std::uint64_t row_bytes = 0;  // memory that the solver's rows took
  };
  std::vector<Volume> volumes;
  double left_out = 0.0;  // estimated share of all light that further bounces would add, in the worst group
  std::vector<Progress::Stage> stages;
  CacheFigures cache;                // what was read and written; zeros without a cache
  std::vector<std::string> notices;  // sentences about results that differ from the plan
};

// Bakes the scene into a bundle at `output`. Results are looked up in the cache of the context and kept
// there, for later bakes and for this one if it is cut short. The bundle is the same, byte for byte, whatever
// was found. Errors: options out of range, an effect that is not known, a scene that cannot be coded, an
// output that cannot be written, "stopped" if a stop was requested.
Result<BakeReport> bake(const Scene& scene, const BakeOptions& options, const std::filesystem::path& output,
                        const BakeContext& context);

// Checks what can be checked before the scene is read and rays are traced; bake() begins with it. Errors:
// options out of range, an effect that is not known, an output that cannot be written.
Result<void> checkRequest(const BakeOptions& options, const std::filesystem::path& output);

// Returns the plan that bake() follows under these options.
Result<EffectPlan> planFor(const Scene& scene, const BakeOptions& options);

// Returns what a bundle of this scene under these options records about how it was made.
bundle::Generator generatorOf(const Scene& scene, const BakeOptions& options);

// Returns whether `output` is what bake() would write: it has the same scene, options and program.
bool isUpToDate(const Scene& scene, const BakeOptions& options, const std::filesystem::path& output);

// Makes the first preview of a scene: a bundle without transfer, made without tracing rays, in about the time
// that it takes to encode the meshes. The runtime shows it lit without shadows and bounces: vertices without
// a sample show A_l y(n), and volumes have one sample that sees everything. Glossy surfaces are shown as
// diffuse, since their BRDF tables take seconds to make, and lamps of the scene shine as lights from outside.
// The bundle has the ordinary format; only its settings say "transfer": "none", so that no bake takes it for
// up to date.

// Uses only the order, the effects and the longest edge of the options. Errors: those of bake().
Result<BakeReport> bakeUnshadowed(const Scene& scene, const BakeOptions& options,
                                  const std::filesystem::path& output, const BakeContext& context);

}  // namespace lambent::baker
