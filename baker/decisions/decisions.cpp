#include "baker/decisions/decisions.hpp"

#include <fmt/format.h>

#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"

namespace lambent::baker {

namespace {

Decision groupShadows(const PlannedTransport& planned) {
  Decision d{.effect = "shadows",
             .choice = planned.shadows ? Choice::Baked : Choice::LeftOut,
             .reason = planned.shadows_reason};
  if (planned.height >= 0.0) d.figures = {{"heightAboveFaces", 100.0 * planned.height, "% of the diagonal"}};
  return d;
}

Decision groupInterreflection(const BakeOptions& options, const PlannedTransport& planned) {
  const std::size_t most =
      options.bounces < 0 ? BakeOptions::kMostBounces : static_cast<std::size_t>(options.bounces);
  const bool baked = planned.bounces && most > 0;
  Decision d{.effect = "interreflection",
             .choice = baked ? Choice::Baked : Choice::LeftOut,
             .reason = !baked
                           ? planned.bounces ? "--bounces 0" : planned.bounces_reason
                           : fmt::format("{}: at most {}", planned.bounces_reason, counted(most, "bounce"))};
  d.figures = {{"mostReflected", 100.0 * planned.most_reflected, "%"}};
  if (baked) d.figures.push_back({"mostBounces", static_cast<double>(most), "bounces"});
  return d;
}

Decision lamps(const Scene& scene, const RigidGroup& group) {
  const auto lights = findGroupLights(scene, group);
  std::size_t punctual = 0, spheres = 0;
  for (const PlannedLight& light : lights) {
    punctual += light.kind == PlannedLight::Kind::Node;
    spheres += !light.spheres.empty();
  }
  Decision d{.effect = "lamps",
             .choice = lights.empty() ? Choice::Absent : Choice::Baked,
             .reason = lights.empty()
                           ? "0 materials and nodes of the group give off light"
                           : fmt::format(
                                 "{} in a column of transfer each: {} of nodes, {} of which shine as spheres",
                                 counted(lights.size(), "light"), punctual, spheres)};
  d.figures = {{"lights", static_cast<double>(lights.size()), "columns"}};
  return d;
}

Decision refinement(const Decided& decided, std::size_t group) {
  const double bound = double{decided.options.effectiveRefineBound()};
  const bool shadows = decided.plan.transport[group].shadows;
  Decision d{.effect = "refinement", .choice = Choice::Baked};
  if (bound > 0.0 && shadows) {
    d.reason = fmt::format("edges are split until interpolation errs by {} where shadows change",
                           percentText(bound));
  } else {
    d.choice = Choice::LeftOut;
    d.reason = shadows ? "--refine off: 0 edges are split" : "0 shadows change between its vertices";
  }
  d.figures = {{"bound", 100.0 * bound, "%"}};
  return d;
}

Decision lightProbes(const PlannedLightProbes& planned) {
  Decision d{.effect = "lightProbes",
             .choice = Choice::Baked,
             .reason = fmt::format("{}{}: {}", counted(planned.count.count, "light probe"),
                                   planned.count.of_group ? "" : " in each cell", planned.reason)};
  d.figures = {{"lightProbes", static_cast<double>(planned.count.count),
                planned.count.of_group ? "of the group" : "of each cell"}};
  return d;
}

Decision neighborhood(const PlannedNeighborhood& planned) {
  Decision d{.effect = "neighborhood",
             .choice = planned.baked            ? Choice::Baked
                       : planned.reason.empty() ? Choice::Absent
                                                : Choice::LeftOut,
             .reason = planned.baked
                           ? fmt::format("{} within reach: {}", counted(planned.receivers.size(), "receiver"),
                                         planned.reason)
                       : planned.reason.empty() ? "0 larger groups have it within their bounds"
                                                : planned.reason};
  d.figures = {{"receivers", static_cast<double>(planned.receivers.size()), "groups"}};
  return d;
}

std::vector<Decision> groupDecisions(const Decided& decided, std::size_t g) {
  const EffectPlan& plan = decided.plan;
  const RigidGroup& group = plan.groups[g];
  std::vector<Decision> all;
  Decision volume{.effect = "volume",
                  .choice = group.volume < 0 ? Choice::Absent : Choice::Baked,
                  .reason = group.volume < 0 ? "0 media: it is a group of surfaces" : "1 medium"};
  if (group.volume < 0) {
    all = {groupShadows(plan.transport[g]), groupInterreflection(decided.options, plan.transport[g]),
           lamps(decided.scene, group), refinement(decided, g)};
  }
  all.push_back(lightProbes(plan.light_probes[g]));
  all.push_back(neighborhood(plan.neighborhoods[g]));
  all.push_back(std::move(volume));
  return all;
}

}  // namespace

const char* choiceName(Choice choice) {
  switch (choice) {
    case Choice::Baked:
      return "baked";
    case Choice::LeftOut:
      return "leftOut";
    case Choice::Absent:
      break;
  }
  return "absent";
}

std::vector<GroupDecisions> decisionsOf(const Decided& decided) {
  std::vector<GroupDecisions> all;
  for (std::size_t g = 0; g < decided.plan.groups.size(); ++g) {
    GroupDecisions& of = all.emplace_back();
    of.decisions = groupDecisions(decided, g);
    for (std::size_t d = 0; d < decided.plan.groups[g].draws.size(); ++d)
      of.primitives.push_back({d, primitiveDecisions(decided, g, d)});
  }
  return all;
}

}  // namespace lambent::baker
