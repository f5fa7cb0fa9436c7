// Implements lambent plan SCENE.
#include <cmath>
#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.hpp"
#include "baker/bake/option_rows.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/output.hpp"
#include "baker/import/gltf.hpp"
#include "baker/pipeline/bake_estimate.hpp"
#include "baker/plan/counted.hpp"

namespace lambent::baker {

namespace {

struct PlanArguments {
  std::filesystem::path scene;
  BakeOptions options;
  bool json = false, allow_outside = false;
  bool estimate = false;
  std::string cache;  // as that of the bake
};

struct GroupSize {
  std::size_t vertices = 0, triangles = 0;
};

GroupSize sizeOf(const Scene& scene, const RigidGroup& group) {
  GroupSize size;
  for (const PlannedDraw& draw : group.draws) {
    const bundle::MeshData& mesh = scene.meshes[draw.mesh].primitives[draw.primitive].mesh;
    size.vertices += mesh.positions.size();
    size.triangles += mesh.indices.size() / 3;
  }
  return size;
}

nlohmann::json estimateJson(const BakeEstimate& estimate) {
  const auto figures = [](const auto& of) {
    return nlohmann::json{{"samples", std::llround(of.samples)},
                          {"rays", std::llround(of.rays)},
                          {"seconds", of.seconds},
                          {"memoryBytes", std::llround(of.memory_bytes)},
                          {"bytes", std::llround(of.bytes)}};
  };
  nlohmann::json json = figures(estimate);
  json["stages"] = estimate.stages;
  json["groups"] = nlohmann::json::array();
  for (const BakeEstimate::Group& group : estimate.groups) {
    json["groups"].push_back(figures(group));
    json["groups"].back()["name"] = group.name;
  }
  return json;
}

void printJson(const Scene& scene, const EffectPlan& plan, const std::optional<BakeEstimate>& estimate) {
  nlohmann::json groups = nlohmann::json::array(), effects = nlohmann::json::array();
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const RigidGroup& group = plan.groups[g];
    const GroupSize size = sizeOf(scene, group);
    const PlannedLightProbes& planned = plan.light_probes[g];
    groups.push_back(
        {{"name", group.name},
         {"volume", group.volume >= 0 ? scene.volumes[static_cast<std::size_t>(group.volume)].name : ""},
         {"within", group.within >= 0 ? plan.groups[static_cast<std::size_t>(group.within)].name : ""},
         {"lightSamples", planned.count.count},
         {"lightSamplesOf", planned.count.of_group ? "group" : "cell"},
         {"lightSamplesReason", planned.reason},
         {"neighborhood", plan.neighborhoods[g].baked},
         {"neighborhoodReason", plan.neighborhoods[g].reason},
         {"neighborhoodMatrices", plan.neighborhoods[g].matrices},
         {"draws", group.draws.size()},
         {"vertices", size.vertices},
         {"triangles", size.triangles}});
  }
  for (const EffectChoice& choice : plan.effects)
    effects.push_back({{"effect", choice.effect}, {"baked", choice.baked}, {"reason", choice.reason}});
  const nlohmann::json json = {{"scene", scene.source.string()},
                               {"groups", groups},
                               {"effects", effects},
                               {"nearLights", plan.shadowed_lights},
                               {"leftOut", plan.left_out},
                               {"estimate", estimate ? estimateJson(*estimate) : nlohmann::json()}};
  fmt::print("{}\n", json.dump(2));
}

void printNeighborhood(const EffectPlan& plan, std::size_t group) {
  const PlannedNeighborhood& around = plan.neighborhoods[group];
  if (around.baked) {
    std::vector<std::string> names;
    for (const std::uint32_t receiver : around.receivers) names.push_back(plan.groups[receiver].name);
    fmt::print("      neighborhood for {}{}: {}\n", fmt::join(names, ", "),
               around.matrices ? ", in all bands" : "", around.reason);
  } else if (!around.reason.empty()) {
    fmt::print("      no neighborhood: {}\n", around.reason);
  }
}

void printEstimate(const BakeEstimate& estimate) {
  const auto line = [](const std::string& name, const auto& of, const char* what) {
    fmt::print("    {}: {} samples, {} rays, {}, {} of memory, {} {}\n", name, std::llround(of.samples),
               countText(of.rays), durationText(of.seconds), bytesText(of.memory_bytes), bytesText(of.bytes),
               what);
  };
  fmt::print("  estimate\n");
  for (const BakeEstimate::Group& group : estimate.groups) line(group.name, group, "of transfer");
  line("all, with refinement and meshes", estimate, "of bundle");
}

void printText(const Scene& scene, const EffectPlan& plan, const std::optional<BakeEstimate>& estimate) {
  fmt::print("{}\n", scene.source.string());
  for (const EffectChoice& choice : plan.effects)
    fmt::print("  {:<10} {}: {}\n", choice.effect, choice.baked ? "baked" : "not baked", choice.reason);
  fmt::print("  rigid groups\n");
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const RigidGroup& group = plan.groups[g];
    const GroupSize size = sizeOf(scene, group);
    if (group.volume >= 0) {
      fmt::print("    {}: a volume{}\n", group.name,
                 group.within < 0
                     ? ""
                     : " among the surfaces of " + plan.groups[static_cast<std::size_t>(group.within)].name);
      printNeighborhood(plan, g);
      continue;
    }
    const auto& [count, reason] = plan.light_probes[g];
    fmt::print("    {}: {}, {} vertices, {} triangles\n", group.name, counted(group.draws.size(), "draw"),
               size.vertices, size.triangles);
    fmt::print("      {}{}: {}\n", counted(count.count, "light probe"), count.of_group ? "" : " in each cell",
               reason);
    printNeighborhood(plan, g);
  }
  if (!plan.shadowed_lights.empty()) fmt::print("  local lights\n");
  for (const std::string& sentence : plan.shadowed_lights) fmt::print("    {}\n", sentence);
  if (!plan.left_out.empty()) fmt::print("  left out\n");
  for (const std::string& sentence : plan.left_out) fmt::print("    {}\n", sentence);
  if (estimate) printEstimate(*estimate);
}

int runPlan(const PlanArguments& a) {
  const auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) return reportError(scene.error());
  const auto plan = planFor(*scene, a.options);
  if (!plan) return reportError(plan.error());
  std::optional<BakeEstimate> estimate;
  if (a.estimate) {
    if (const auto checked = checkOptions(a.options); !checked) return reportError(checked.error());
    const std::stop_source stop;
    const InterruptGuard interrupts(stop);
    Progress unused;
    auto made = estimateBake(*scene, a.options, {unused, stop.get_token()});
    if (!made) return reportError(made.error());
    if (auto cache = openCache(a.cache)) keepEstimate(*scene, a.options, *made, *cache);
    estimate = std::move(*made);
  }
  (a.json ? printJson : printText)(*scene, *plan, estimate);
  return 0;
}

}  // namespace

void addPlanCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<PlanArguments>();
  CLI::App* command = app.add_subcommand("plan", "Say what would be baked, what not, and why");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb")->required();
  addBakeOptions(*command, a->options);
  command
      ->add_option("--cache", a->cache,
                   "Folder where the estimate is kept for the bake, as that of `lambent bake`; off: none")
      ->type_name("DIR|off");
  command->add_flag("--allow-outside", a->allow_outside,
                    "Read buffers and images outside the scene's folder too");
  command->add_flag("--json", a->json, "Print as JSON");
  command->footer(
      "With an option of the bake beside --effects and --light-probes, such as --quality draft, the plan "
      "also "
      "estimates samples, rays, time, memory and bytes. It rehearses the bake with 128 rays, which takes "
      "about as long as a draft, and a third to a half of a bake of standard quality.");
  command->callback([a, command, &run] {
    for (const OptionRow& row : optionRows())
      a->estimate |= row.name != "effects" && row.name != "light-probes" &&
                     command->count("--" + std::string(row.name)) > 0;
    run = [a] { return runPlan(*a); };
  });
}

}  // namespace lambent::baker
