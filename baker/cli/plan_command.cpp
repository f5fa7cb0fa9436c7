// Implements lambent plan SCENE.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "baker/bake/bake.hpp"
#include "baker/bake/options.hpp"
#include "baker/cli/commands.hpp"
#include "baker/decisions/decisions.hpp"
#include "baker/import/gltf.hpp"
#include "baker/import/scene.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "baker/plan/counted.hpp"
#include "baker/plan/effect_plan.hpp"
#include "runtime/command_line/help.hpp"

namespace lambent::baker {

namespace {

// Prints a plan as text that fits one screen: warnings first, then effects and the largest groups, whose
// primitives are summed up by decision. All of it is in --json.

// A plan with all that is reported about it.
struct PlanReport {
  const Scene& scene;
  const EffectPlan& plan;
  const std::vector<GroupDecisions>& decisions;  // one per group
  const BakeGuess& guess;
};

struct GroupSize {
  std::size_t vertices = 0, triangles = 0;
};

// Lines of a screen, and of these at most so many for warnings.
constexpr std::size_t kMostLines = 40, kMostWarnings = 6;
constexpr const char* kRest = "lambent plan --json lists them";

using PlanLines = std::vector<std::string>;

// Empty for the default material and for one without a name.
std::string materialName(const Scene& scene, std::int32_t material) {
  return material < 0 ? "" : scene.materials[static_cast<std::size_t>(material)].name;
}

std::string choiceText(Choice choice) {
  return choice == Choice::Baked ? "baked" : "left out";
}

// Returns "light probes" for lightProbes.
std::string wordsOf(const std::string& effect) {
  std::string words;
  for (const char letter : effect) {
    if (std::isupper(static_cast<unsigned char>(letter))) words += ' ';
    words += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return words;
}

GroupSize sizeOf(const Scene& scene, const RigidGroup& group) {
  GroupSize size;
  for (const PlannedDraw& draw : group.draws) {
    const bundle::MeshData& mesh = scene.meshes[draw.mesh].primitives[draw.primitive].mesh;
    size.vertices += mesh.positions.size();
    size.triangles += mesh.indices.size() / 3;
  }
  return size;
}

// Adds a line for each decision about draws of the group: for how many, and the first one's reason.
void addAlike(const GroupDecisions& of, PlanLines& lines) {
  struct Alike {
    const Decision* first;
    std::size_t draws;
  };
  std::vector<Alike> all;
  for (const PrimitiveDecisions& primitive : of.primitives)
    for (const Decision& d : primitive.decisions) {
      if (d.choice == Choice::Absent) continue;
      auto alike = std::ranges::find_if(all, [&](const Alike& known) {
        return known.first->effect == d.effect && known.first->choice == d.choice;
      });
      if (alike == all.end()) alike = all.insert(alike, {&d, 0});
      ++alike->draws;
    }
  for (const auto& [first, draws] : all)
    lines.push_back(fmt::format(
        "      {:<16} {}{}: {}", wordsOf(first->effect), choiceText(first->choice),
        of.primitives.size() > 1 ? fmt::format(" for {} of {} draws", draws, of.primitives.size()) : "",
        first->reason));
}

PlanLines groupLines(const PlanReport& report, std::size_t g) {
  const RigidGroup& group = report.plan.groups[g];
  PlanLines lines;
  if (group.volume >= 0) {
    const std::string within =
        group.within < 0 ? ""
                         : " among the surfaces of " + report.plan.groups[std::size_t(group.within)].name;
    lines.push_back(fmt::format("    {}: a volume{}", group.name, within));
  } else {
    const GroupSize size = sizeOf(report.scene, group);
    lines.push_back(fmt::format("    {}: {}, {} vertices, {} triangles", group.name,
                                counted(group.draws.size(), "draw"), size.vertices, size.triangles));
  }
  for (const Decision& d : report.decisions[g].decisions)
    if (d.choice != Choice::Absent)  // --json has those too
      lines.push_back(fmt::format("      {:<16} {}: {}", wordsOf(d.effect), choiceText(d.choice), d.reason));
  addAlike(report.decisions[g], lines);
  return lines;
}

void addWarnings(const std::vector<std::string>& warnings, PlanLines& lines) {
  if (warnings.empty()) return;
  lines.emplace_back("  warnings");
  const std::size_t shown = std::min(warnings.size(), kMostWarnings);
  for (std::size_t i = 0; i < shown; ++i) lines.push_back("    " + warnings[i]);
  if (shown < warnings.size())
    lines.push_back(fmt::format("    and {} more; {}", warnings.size() - shown, kRest));
}

// The largest groups come first.
void addGroups(const PlanReport& report, PlanLines& lines) {
  std::vector<std::size_t> order(report.plan.groups.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto triangles = [&](std::size_t g) { return sizeOf(report.scene, report.plan.groups[g]).triangles; };
  std::ranges::stable_sort(order, std::greater(), triangles);
  lines.emplace_back("  rigid groups");
  std::size_t shown = 0, rest = 0;
  for (; shown < order.size(); ++shown) {
    const PlanLines of = groupLines(report, order[shown]);
    if (shown > 0 && lines.size() + of.size() >= kMostLines) break;
    lines.insert(lines.end(), of.begin(), of.end());
  }
  for (std::size_t i = shown; i < order.size(); ++i) rest += triangles(order[i]);
  if (shown < order.size())
    lines.push_back(fmt::format("    and {} of {} triangles; {}", counted(order.size() - shown, "more group"),
                                rest, kRest));
}

void printPlan(const PlanReport& report) {
  const EffectPlan& plan = report.plan;
  PlanLines lines = {report.scene.source.string()};
  addWarnings(plan.left_out, lines);
  lines.emplace_back("  effects");
  for (const EffectChoice& choice : plan.effects)
    lines.push_back(
        fmt::format("    {:<12} {}: {}", choice.effect, choice.baked ? "baked" : "not baked", choice.reason));
  const BakeGuess& guess = report.guess;
  lines.push_back(fmt::format("  about {} samples, {} rays, {}, {} of memory for transfer",
                              countText(guess.samples), countText(guess.rays),
                              durationText(sumSeconds(guess.seconds)), bytesText(guess.memory_bytes)));
  addGroups(report, lines);
  for (const std::string& line : lines) fmt::print("{}\n", line);
}

struct PlanArguments {
  std::filesystem::path scene;
  BakeOptions options;
  bool json = false, allow_outside = false;
};

nlohmann::json decisionsJson(const std::vector<Decision>& decisions) {
  nlohmann::json json = nlohmann::json::array();
  for (const Decision& d : decisions)
    json.push_back({{"effect", d.effect}, {"decision", choiceName(d.choice)}, {"reason", d.reason}});
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
  (a.json ? printPlanJson : printPlan)(report);
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
  command->add_flag("--json", a->json, "Print as JSON, with every warning, group and primitive");
  command_line::group(*command, "Files", {"--allow-outside"});
  command_line::group(*command, "Output", {"--json"});
  command_line::addExamples(*command, {{"lambent plan scene.gltf", "says what would be baked and why"},
                                       {"lambent plan scene.gltf --quality draft", "says so of a draft"}});
  command->callback([a, &run] { run = [a] { return runPlan(*a); }; });
}

}  // namespace lambent::baker
