#include "baker/pipeline/whole_progress.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "baker/plan/local_light.hpp"
#include "baker/plan/smooth_dielectrics.hpp"

namespace lambent::baker {

namespace {

// The share of a job that is not done is at most this: what was expected may be over before the job is.
constexpr double kMostBeforeTheEnd = 0.99;

double shareOf(const Progress::Stage& stage) {
  return stage.total > 0 ? std::min(1.0, static_cast<double>(stage.done) / static_cast<double>(stage.total))
                         : 0.0;
}

}  // namespace

double sumSeconds(const PartSeconds& parts) {
  double sum = 0.0;
  for (const StageSeconds& part : parts)
    for (const auto& [stage, seconds] : part) sum += seconds;
  return sum;
}

JobSeconds jobSeconds(const PartSeconds& expected, std::vector<Progress::Stage> stages) {
  // Measured times count against this share of all that was expected, so that the first short stages say
  // little.
  constexpr double kPaceBegins = 0.05;
  const Progress::Stage& now = stages.back();
  JobSeconds job;
  double took = 0.0, expected_of_these = 0.0;
  for (std::size_t part = 0; part < expected.size(); ++part)
    for (const auto& [name, seconds] : expected[part]) {
      // Bounces that turn out not to be needed are over with their part.
      double share = part < now.part ? 1.0 : 0.0, spent = 0.0;
      bool computed = false;
      for (const Progress::Stage& stage : stages) {
        if (stage.part != part || stage.name != name) continue;
        share = std::max(share, &stage == &now ? shareOf(now) : 1.0);
        if (stage.found) continue;  // says nothing of the machine
        computed = true;
        spent += stage.seconds;
      }
      job.done += share * seconds;
      job.left += (1.0 - share) * seconds;
      if (!computed) continue;
      took += spent;
      expected_of_these += share * seconds;
    }
  const double begins = kPaceBegins * (job.done + job.left);
  if (begins > 0.0) job.pace = (took + begins) / (expected_of_these + begins);
  return job;
}

WholeProgress::Seen WholeProgress::look(const Progress& progress) {
  Seen seen;
  seen.stage = progress.now();
  std::vector<Progress::Stage> stages = progress.finished();
  stages.push_back(seen.stage);
  const JobSeconds job = jobSeconds(expected_, std::move(stages));
  if (seen.stage.seconds > 0.0)
    seen.units_per_s =
        static_cast<double>(seen.stage.done - std::min(seen.stage.done, seen.stage.found_units)) /
        seen.stage.seconds;
  // A share that falls would say that work was lost.
  const double done = before_s_ + job.done, left = job.left + after_s_;
  if (done > 0.0) share_ = std::max(share_, std::min(kMostBeforeTheEnd, done / (done + left)));
  seen.share = share_;
  seen.seconds_left = job.pace * left;
  return seen;
}

std::jthread watchProgress(const Progress& progress, WholeProgress whole, std::chrono::duration<double> every,
                           std::function<void(const WholeProgress::Seen&)> say, bool at_end) {
  return std::jthread([&progress, whole = std::move(whole), every, say = std::move(say),
                       at_end](const std::stop_token& stop) mutable {
    std::mutex lock;
    std::condition_variable_any ended;  // lets the end come before the next turn
    std::unique_lock hold(lock);
    while (!ended.wait_for(hold, stop, every, [&] { return stop.stop_requested(); }))
      say(whole.look(progress));
    if (at_end) say(whole.look(progress));
  });
}

namespace {

// A sample takes so much processor time for each ray and for what is done whatever its rays, bounces and
// codes included. In a room nearly all rays of diffuse samples meet something that sends light on, around an
// open body hardly any. Figures are rounded from bakes of docs/design/bakes.md, "Beforehand".
constexpr double kRoomRay_s = 1.5e-6, kRoomSample_s = 2.4e-4;
constexpr double kOpenRay_s = 1e-7, kOpenSample_s = 1e-4;
constexpr double kGlossyRay_s = 2.5e-6, kGlossySample_s = 2.6e-4;
// Refinement is expected to double the vertices where it may.
constexpr double kGrowth = 2.0;
constexpr const char* kRefinement = "refinement";
// Stages of a group share that so, roughly. Of diffuse and of glossy samples, codes take these shares of all.
constexpr double kProbing = 1.0, kDirect = 1.0, kBounce = 0.3, kPatches = 0.09;
// So many passes gather light; the rest passes between patches (effects/surface/bounces.hpp).
constexpr int kMostGathered = 2;
constexpr double kDiffuseCoding = 0.05, kGlossyCoding = 0.5;
// A point of a neighborhood's grid takes so much with drafts' 256 rays, and its codes without matrices and
// with.
constexpr double kPoint_s = 1e-4, kPointCoding_s = 2e-4, kMatricesCoding_s = 4.5e-4;
constexpr double kFewPoints = 8192.0, kPoints = 32768.0;
constexpr double kVoxel_s = 1.2e-4;  // of each voxel of a volume's grid, empty ones included
constexpr double kDraftRays = 256.0;
// Bakes of which more processor time is guessed are announced. They may take over a minute, since guesses
// err.
constexpr double kLongBake_s = 40.0;

double cellsOf(const glm::uvec3& grid) {
  return std::max(1.0, double(grid.x) * double(grid.y) * double(grid.z));
}

struct Vertices {
  double diffuse = 0.0, glossy = 0.0;
  double room = 0.0;  // 0: an open body; 1: a room
};

// Returns twice the share of the area that faces the middle of the group, as walls do, and 1 at most.
double roomOf(const Scene& scene, const RigidGroup& group, const std::vector<glm::mat4>& world) {
  using Triangle = std::array<glm::vec3, 3>;
  const auto meshOf = [&](const PlannedDraw& draw) -> const bundle::MeshData& {
    return scene.meshes[draw.mesh].primitives[draw.primitive].mesh;
  };
  Box box;
  for (const PlannedDraw& draw : group.draws)
    eachTriangle(meshOf(draw), world[draw.node], [&](const Triangle& triangle) {
      for (const glm::vec3& corner : triangle) box.add(corner);
    });
  double inward = 0.0, all = 0.0;
  for (const PlannedDraw& draw : group.draws) {
    const bool flipped = draw.back != (glm::determinant(glm::mat3(world[draw.node])) < 0.0f);
    eachTriangle(meshOf(draw), world[draw.node], [&](const Triangle& t) {
      const glm::vec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
      const double area = double{glm::length(normal)};
      if (!std::isfinite(area)) return;
      all += area;
      if ((glm::dot(normal, box.centre() - t[0]) > 0.0f) != flipped) inward += area;
    });
  }
  return all > 0.0 ? std::min(1.0, 2.0 * inward / all) : 0.0;
}

Vertices verticesOf(const Scene& scene, const RigidGroup& group, bool with_glossy) {
  Vertices vertices;
  for (const PlannedDraw& draw : group.draws) {
    const ScenePrimitive& primitive = scene.meshes[draw.mesh].primitives[draw.primitive];
    const bool matrices = with_glossy && primitive.material >= 0 &&
                          hasMatrices(scene.materials[static_cast<std::size_t>(primitive.material)]);
    (matrices ? vertices.glossy : vertices.diffuse) += static_cast<double>(primitive.mesh.positions.size());
  }
  return vertices;
}

// Returns the shares of what rays take that stages have, refinement included.
StageSeconds sharesOfRays(const BakeOptions& options) {
  StageSeconds shares = {{"direct light", kDirect}};
  if (options.effectiveRefineBound() > 0.0f) shares[kRefinement] = kProbing;
  if (options.fitsDiffuse()) shares["inside faces"] = kDirect;
  const int gathered = options.bounces < 0 ? kMostGathered : std::min(options.bounces, kMostGathered);
  for (int bounce = 1; bounce <= gathered; ++bounce) shares[fmt::format("bounce {}", bounce)] = kBounce;
  if (gathered > 1) shares["bounce between patches"] = kPatches;
  double sum = 0.0;
  for (const auto& [stage, share] : shares) sum += share;
  for (auto& [stage, share] : shares) share /= sum;
  return shares;
}

void addNeighborhood(const PlannedNeighborhood& planned, const BakeOptions& options, StageSeconds& part) {
  const bool few = !planned.asked && !planned.matrices;
  double points = few ? kFewPoints : kPoints;
  for (const glm::uvec3& asked : {options.neighborhood_grid, planned.size})
    if (asked != glm::uvec3(0u)) points = cellsOf(asked);
  part["neighborhood"] = points * kPoint_s * static_cast<double>(options.effectiveRays()) / kDraftRays;
  part["coding the neighborhood"] = points * (planned.matrices ? kMatricesCoding_s : kPointCoding_s);
}

}  // namespace

BakeGuess guessBake(const Scene& scene, const EffectPlan& plan, const BakeOptions& options) {
  const std::vector<glm::mat4> world = gltf::worldTransforms(scene.nodes);
  std::vector<Vertices> groups(plan.groups.size());
  Vertices all;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if (!plan.transport[g].shadows) continue;
    groups[g] = verticesOf(scene, plan.groups[g], plan.bakes("glossy"));
    groups[g].room = roomOf(scene, plan.groups[g], world);
    all.diffuse += groups[g].diffuse, all.glossy += groups[g].glossy;
  }
  const auto growth = [&](double vertices) {
    if (vertices == 0.0) return 1.0;
    return std::min(kGrowth, options.refineGrowth() + static_cast<double>(options.refineAdded()) / vertices);
  };
  const bool refines = options.effectiveRefineBound() > 0.0f;
  const double diffuse_growth = refines ? growth(all.diffuse) : 1.0;
  const double glossy_growth = refines && options.refinesGlossy() ? growth(all.glossy) : 1.0;
  const auto rays = static_cast<double>(options.effectiveRays());
  const StageSeconds shares = sharesOfRays(options);
  BakeGuess guess{.seconds = PartSeconds(2)};
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double sample_s = std::lerp(kOpenSample_s, kRoomSample_s, groups[g].room),
                 ray_s = std::lerp(kOpenRay_s, kRoomRay_s, groups[g].room);
    const double diffuse = diffuse_growth * groups[g].diffuse, glossy = glossy_growth * groups[g].glossy;
    guess.samples += diffuse + glossy;
    guess.memory_bytes = std::max(guess.memory_bytes, diffuse * options.bytesOfTransfer(false) +
                                                          glossy * options.bytesOfTransfer(true));
    const double diffuse_s = diffuse * (sample_s + rays * ray_s);
    const double glossy_s = glossy * (kGlossySample_s + rays * kGlossyRay_s);
    const double coding = kDiffuseCoding * diffuse_s + kGlossyCoding * glossy_s;
    StageSeconds& part = guess.seconds.emplace_back();
    part["coding"] = coding;
    for (const auto& [stage, share] : shares)
      (stage == kRefinement ? guess.seconds[1] : part)[stage] += share * (diffuse_s + glossy_s - coding);
    if (plan.groups[g].volume >= 0)
      part["scattering"] = cellsOf(options.volume_grid) * kVoxel_s * rays / kDraftRays;
    if (plan.neighborhoods[g].baked) addNeighborhood(plan.neighborhoods[g], options, part);
  }
  guess.rays = guess.samples * rays;
  guess.processor_seconds = sumSeconds(guess.seconds);
  const unsigned processors = std::max(1u, std::thread::hardware_concurrency());
  const double used = options.threads > 0 ? std::min(options.threads, processors) : processors;
  for (StageSeconds& part : guess.seconds)
    for (auto& [stage, seconds] : part) seconds /= used;
  return guess;
}

std::optional<std::string> longBakeNotice(double processor_seconds) {
  if (processor_seconds <= kLongBake_s) return std::nullopt;
  const double minutes = processor_seconds / 60.0;
  const std::string time = minutes < 120.0 ? fmt::format("{:.0f} min", std::ceil(minutes))
                                           : fmt::format("{:.0f} hours", std::ceil(minutes / 60.0));
  return fmt::format(
      "takes about {} of processor time, less what the cache holds of it; fewer rays (--rays) take less",
      time);
}

}  // namespace lambent::baker
