// The whole bake as one call: a scene in, a bundle out. The command line, the editor and tests all call this.
// Stages report to a Progress and can be stopped; nothing is written before everything is known, so a bake
// that stops or fails leaves the old bundle as it was.
#pragma once

#include <cstdint>
#include <filesystem>
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

// How much of an effect's work on a group was done again.
enum class Reuse : std::uint8_t {
  Baked,       // rays were traced, at least some
  Regathered,  // what rays had met was found; light was gathered over it anew, and coded
  Found,       // nothing was left to do
};
const char* reuseName(Reuse reuse);  // "baked", "re-gathered", "found"

struct BakeReport {
  std::uint64_t vertices = 0, triangles = 0, samples = 0, filled_samples = 0;
  std::uint64_t rays = 0;       // traced in this run
  std::uint64_t rays_kept = 0;  // that results of earlier runs stand for
  std::uint64_t file_bytes = 0, mesh_bytes = 0, transfer_bytes = 0, proxy_bytes = 0, image_bytes = 0;
  double ray_seconds = 0.0;         // of the passes that trace
  double worst_error = 0.0;         // of coded transfer, over cells; relative RMS
  double worst_glossy_error = 0.0;  // of glossy cells: of all that they show together
  std::uint64_t glossy_samples = 0;
  std::uint64_t lights = 0;     // of the groups' own
  std::uint64_t hit_bytes = 0;  // kept for the bounces
  // Energy of each pass relative to direct light (bounces.hpp), of the group that took most of them.
  std::vector<double> pass_energy;
  struct Group {
    std::string name;
    std::uint64_t light_probes = 0;
    std::vector<std::uint32_t> proxy_triangles;  // of each level, the finest first; empty: no proxy
    struct Effect {
      std::string name;
      Reuse reuse = Reuse::Baked;
      std::uint64_t rays = 0, rays_kept = 0;
    };
    std::vector<Effect> effects;
  };
  std::vector<Group> groups;
  struct Neighborhood {
    std::string name;  // of the group
    glm::uvec3 size{0};
    glm::vec3 bounds_min{0.0f}, bounds_max{0.0f};  // group frame, m
    std::uint64_t inside_points = 0;               // inside the body, continued from outside
    double error = 0.0;         // of its codes, RMS, relative to irradiance without the body
    double change_error = 0.0;  // relative to the change, which 99 % of the points with a change keep
  };
  std::vector<Neighborhood> neighborhoods;
  RefineReport refinement;
  struct Volume {
    std::string name;
    std::uint64_t voxels = 0, samples = 0;
    std::uint32_t density_bits = 8;
    double density_error = 0.0;  // of quantizing, relative RMS
    int iterations = 0;          // of the solver for all scatterings, and what it left
    double residual = 0.0;
    std::uint64_t row_bytes = 0;  // that it held in memory
  };
  std::vector<Volume> volumes;
  double left_out = 0.0;  // estimate of the light that further bounces would add, relative to all
  std::vector<Progress::Stage> stages;
  CacheFigures cache;                // what was read and written; zeros without a cache
  std::vector<std::string> notices;  // what came out other than the plan says, a sentence each
};

// Results are looked up in the cache of the context and kept there, for later bakes and for this one if it is
// cut short. The bundle is the same, byte for byte, whatever was found. Errors: options out of range, an
// effect that is not known, a scene that cannot be coded, an output that cannot be written, "stopped" if a
// stop was requested.
Result<BakeReport> bake(const Scene& scene, const BakeOptions& options, const std::filesystem::path& output,
                        const BakeContext& context);

// What can be told wrong before the scene is read and rays are traced: options out of range, an effect that
// is not known, a place that cannot be written. bake() begins with it.
Result<void> checkRequest(const BakeOptions& options, const std::filesystem::path& output);

// The plan that bake() follows under these options.
Result<EffectPlan> planFor(const Scene& scene, const BakeOptions& options);

// A digest of everything in the scene that a bake reads.
std::uint64_t sceneDigest(const Scene& scene);

// What a bundle of this scene under these options records of its making.
bundle::Generator generatorOf(const Scene& scene, const BakeOptions& options);

// Is `output` what bake() would write: same scene, same options, same program?
bool isUpToDate(const Scene& scene, const BakeOptions& options, const std::filesystem::path& output);

}  // namespace lambent::baker
