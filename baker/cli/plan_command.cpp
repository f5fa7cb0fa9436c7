// Implements lambent plan SCENE.
#include <cmath>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.hpp"
#include "baker/bake/option_rows.hpp"
#include "baker/cli/commands.hpp"
#include "baker/cli/output.hpp"
#include "baker/cli/plan_text.hpp"
#include "baker/import/gltf.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

namespace {

struct PlanArguments {
  std::filesystem::path scene;
  BakeOptions options;
  bool json = false, verbose = false, allow_outside = false;
};

nlohmann::json decisionsJson(const std::vector<Decision>& decisions) {
  nlohmann::json json = nlohmann::json::array();
  for (const Decision& d : decisions) {
    nlohmann::json figures = nlohmann::json::object();
    for (const Figure& figure : d.figures)
      figures[figure.name] = {{"value", figure.value}, {"unit", figure.unit}};
    json.push_back({{"effect", d.effect},
                    {"decision", choiceName(d.choice)},
                    {"reason", d.reason},
                    {"figures", figures}});
  }
  return json;
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

void printPlanJson(const PlanReport& report) {
  const auto& [scene, plan, decisions, guess] = report;
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
                               {"estimate",
                                {{"samples", std::llround(guess.samples)},
                                 {"rays", std::llround(guess.rays)},
                                 {"seconds", sumSeconds(guess.seconds)},
                                 {"processorSeconds", guess.processor_seconds},
                                 {"memoryBytes", std::llround(guess.memory_bytes)}}}};
  fmt::print("{}\n", json.dump(2));
}

int runPlan(const PlanArguments& a) {
  const auto scene = importScene(a.scene, {.allow_outside = a.allow_outside});
  if (!scene) return reportError(scene.error());
  const auto plan = planFor(*scene, a.options);
  if (!plan) return reportError(plan.error());
  if (const auto checked = checkOptions(a.options); !checked) return reportError(checked.error());
  const auto decisions = decisionsOf({*scene, a.options, *plan});
  const BakeGuess guess = guessBake(*scene, *plan, a.options);
  const PlanReport report{*scene, *plan, decisions, guess};
  if (a.json)
    printPlanJson(report);
  else
    printPlan(report, a.verbose);
  return 0;
}

}  // namespace

void addPlanCommand(CLI::App& app, Command& run) {
  auto a = std::make_shared<PlanArguments>();
  CLI::App* command = app.add_subcommand("plan", "Say what would be baked, what not, and why");
  command->add_option("SCENE", a->scene, "The scene, .gltf or .glb")->required();
  addBakeOptions(*command, a->options);
  command->add_flag("--allow-outside", a->allow_outside,
                    "Read buffers and images outside the scene's folder too");
  command->add_flag("--json", a->json, "Print as JSON");
  command->add_flag("-v,--verbose", a->verbose, "Print every warning, group and primitive");
  command_line::group(*command, "Files", {"--allow-outside"});
  command_line::group(*command, "Output", {"--json", "--verbose"});
  command_line::addExamples(*command, {{"lambent plan scene.gltf", "says what would be baked and why"},
                                       {"lambent plan scene.gltf --quality draft", "says so of a draft"}});
  command->callback([a, &run] { run = [a] { return runPlan(*a); }; });
}

}  // namespace lambent::baker
