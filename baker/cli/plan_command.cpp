// Implements lambent plan SCENE.
#include <algorithm>
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
#include "baker/decisions/decisions.hpp"
#include "baker/import/gltf.hpp"
#include "baker/pipeline/bake_estimate.hpp"
#include "baker/plan/counted.hpp"
#include "runtime/command_line/help.hpp"

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
  json["processorSeconds"] = estimate.processor_seconds;
  json["stages"] = stageSeconds(estimate.parts);
  json["groups"] = nlohmann::json::array();
  for (const BakeEstimate::Group& group : estimate.groups) {
    json["groups"].push_back(figures(group));
    json["groups"].back()["name"] = group.name;
  }
  return json;
}

nlohmann::json savedJson(const Saved& saved) {
  const auto known = [](const std::optional<double>& value) {
    return value ? nlohmann::json(*value) : nlohmann::json();
  };
  return {{"seconds", known(saved.seconds)},
          {"memoryBytes", known(saved.memory_bytes)},
          {"bytes", known(saved.bytes)}};
}

nlohmann::json decisionsJson(const std::vector<Decision>& decisions) {
  nlohmann::json json = nlohmann::json::array();
  for (const Decision& d : decisions) {
    nlohmann::json figures = nlohmann::json::object();
    for (const Figure& figure : d.figures)
      figures[figure.name] = {{"value", figure.value}, {"unit", figure.unit}};
    json.push_back({{"effect", d.effect},
                    {"decision", choiceName(d.choice)},
                    {"reason", d.reason},
                    {"figures", figures},
                    {"saves", savedJson(d.saves)}});
  }
  return json;
}

std::string materialName(const Scene& scene, std::int32_t material) {
  return material < 0 ? "" : scene.materials[static_cast<std::size_t>(material)].name;
}

nlohmann::json primitivesJson(const Scene& scene, const RigidGroup& group, const GroupDecisions& of) {
  nlohmann::json json = nlohmann::json::array();
  for (const PrimitiveDecisions& primitive : of.primitives) {
    const PlannedDraw& draw = group.draws[primitive.draw];
    json.push_back(
        {{"node", scene.nodes[draw.node].name},
         {"mesh", scene.meshes[draw.mesh].name},
         {"primitive", draw.primitive},
         {"side", draw.back ? "back" : "front"},
         {"material", materialName(scene, scene.meshes[draw.mesh].primitives[draw.primitive].material)},
         {"decisions", decisionsJson(primitive.decisions)}});
  }
  return json;
}

// Told is a plan with all that is said about it.
struct Told {
  const Scene& scene;
  const EffectPlan& plan;
  const std::vector<GroupDecisions>& decisions;  // one per group
  const std::optional<BakeEstimate>& estimate;
  std::optional<Saved> saved;  // by all that is left out
};

void printPlanJson(const Told& told) {
  const auto& [scene, plan, decisions, estimate, saved] = told;
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
         {"triangles", size.triangles},
         {"decisions", decisionsJson(decisions[g].decisions)},
         {"primitives", primitivesJson(scene, group, decisions[g])}});
  }
  for (const EffectChoice& choice : plan.effects)
    effects.push_back({{"effect", choice.effect}, {"baked", choice.baked}, {"reason", choice.reason}});
  const nlohmann::json json = {{"scene", scene.source.string()},
                               {"groups", groups},
                               {"effects", effects},
                               {"nearLights", plan.shadowed_lights},
                               {"leftOut", plan.left_out},
                               {"estimate", estimate ? estimateJson(*estimate) : nlohmann::json()},
                               {"saves", saved ? savedJson(*saved) : nlohmann::json()}};
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

// Decisions about what a scene does not have are left to --json.
void printDecisions(const std::vector<Decision>& decisions, const char* indent) {
  for (const Decision& d : decisions) {
    if (d.choice == Choice::Absent || d.choice == Choice::AtRunTime) continue;
    fmt::print("{}{:<15} {}: {}", indent, d.effect, d.choice == Choice::Baked ? "baked" : "left out",
               d.reason);
    if (d.choice == Choice::LeftOut && d.saves.seconds)
      fmt::print("; saves {:.2f} s of processor time, {} of memory, {}", *d.saves.seconds,
                 bytesText(d.saves.memory_bytes.value_or(0.0)), bytesText(d.saves.bytes.value_or(0.0)));
    fmt::print("\n");
  }
}

void printPrimitives(const Scene& scene, const RigidGroup& group, const GroupDecisions& of) {
  for (const PrimitiveDecisions& primitive : of.primitives) {
    const PlannedDraw& draw = group.draws[primitive.draw];
    const std::string material =
        materialName(scene, scene.meshes[draw.mesh].primitives[draw.primitive].material);
    fmt::print("      {}, primitive {}{}{}\n",
               scene.meshes[draw.mesh].name.empty() ? fmt::format("mesh {}", draw.mesh)
                                                    : scene.meshes[draw.mesh].name,
               draw.primitive, material.empty() ? "" : " of " + material, draw.back ? ", back" : "");
    printDecisions(primitive.decisions, "        ");
  }
}

void printPlan(const Told& told) {
  const auto& [scene, plan, decisions, estimate, saved] = told;
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
    fmt::print("    {}: {}, {} vertices, {} triangles\n", group.name, counted(group.draws.size(), "draw"),
               size.vertices, size.triangles);
    printDecisions(decisions[g].decisions, "      ");
    printPrimitives(scene, group, decisions[g]);
  }
  if (!plan.shadowed_lights.empty()) fmt::print("  local lights\n");
  for (const std::string& sentence : plan.shadowed_lights) fmt::print("    {}\n", sentence);
  if (!plan.left_out.empty()) fmt::print("  left out\n");
  for (const std::string& sentence : plan.left_out) fmt::print("    {}\n", sentence);
  if (estimate) printEstimate(*estimate);
}

// Returns whether a bake that leaves nothing out would do more.
bool leavesOut(const EffectPlan& plan) {
  return std::ranges::any_of(plan.transport,
                             [](const PlannedTransport& of) { return !of.shadows || !of.bounces; });
}

Result<std::vector<GroupLook>> lookAtAll(const Scene& scene, const EffectPlan& plan) {
  DecodedImages images(scene);
  const auto alpha_maps = loadAlphaMaps(scene, images);
  if (!alpha_maps) return failAgain(alpha_maps.error());
  return lookAt(scene, plan.groups, *alpha_maps, images);
}

int runPlan(const PlanArguments& a) {
  const auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) return reportError(scene.error());
  const auto plan = planFor(*scene, a.options);
  if (!plan) return reportError(plan.error());
  const auto looks = lookAtAll(*scene, *plan);
  if (!looks) return reportError(looks.error());
  std::optional<BakeEstimate> estimate, all;
  if (a.estimate) {
    if (const auto checked = checkOptions(a.options); !checked) return reportError(checked.error());
    const std::stop_source stop;
    const InterruptGuard interrupts(stop);
    Progress unused;
    auto made = estimateBake(*scene, a.options, {unused, stop.get_token()});
    if (!made) return reportError(made.error());
    BakeOptions forced = a.options;
    forced.effects = "all";
    auto made_all = leavesOut(*plan) && a.options.effects == "auto"
                        ? estimateBake(*scene, forced, {unused, stop.get_token()})
                        : made;
    if (!made_all) return reportError(made_all.error());
    all = std::move(*made_all);
    if (auto cache = openCache(a.cache)) keepEstimate(*scene, a.options, *made, *cache);
    estimate = std::move(*made);
  }
  const Estimates estimates{estimate ? &*estimate : nullptr, all ? &*all : nullptr};
  const auto decisions = decisionsOf({*scene, a.options, *plan, *looks, estimates});
  (a.json ? printPlanJson : printPlan)({*scene, *plan, decisions, estimate, savedByAll(estimates)});
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
  command_line::group(*command, "Machine", {"--cache"});
  command_line::group(*command, "Files", {"--allow-outside"});
  command_line::group(*command, "Output", {"--json"});
  command_line::addExamples(
      *command,
      {{"lambent plan scene.gltf", "says what would be baked and why"},
       {"lambent plan scene.gltf --quality standard", "says also what that takes"}},
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
