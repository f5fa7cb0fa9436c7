#include <algorithm>

#include <fmt/format.h>

#include "baker/decisions/decisions.hpp"
#include "baker/pipeline/job_estimate.hpp"
#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"

namespace lambent::baker {

namespace {

// Stages of a bake that trace what is hidden, and that serve refinement.
bool isShadows(std::string_view stage) {
  return stage == "direct light" || stage == "glossy shadows" || stage == "inside faces" ||
         stage == "hierarchy";
}

double secondsOf(const BakeEstimate::Group& group, bool (*is)(std::string_view)) {
  double seconds = 0.0;
  for (const auto& [stage, spent] : group.processor_stages)
    if (is(stage)) seconds += spent;
  return seconds;
}

double refinementOf(const BakeEstimate& estimate) {
  const auto found = estimate.processor_stages.find(kRefinement);
  return found == estimate.processor_stages.end() ? 0.0 : found->second;
}

// Savings reads from the estimates of a group how much each effect costs.
class Savings {
 public:
  Savings(const Estimates& estimates, std::size_t group) {
    const auto& [planned, all] = estimates;
    if (planned && group < planned->groups.size()) planned_ = &planned->groups[group];
    if (all && group < all->groups.size()) all_ = &all->groups[group];
    if (planned && all) refinement_ = std::max(0.0, refinementOf(*all) - refinementOf(*planned));
  }

  Saved shadows(bool baked) const {
    if (baked)
      return planned_ ? Saved{.seconds = secondsOf(*planned_, isShadows), .memory_bytes = {}, .bytes = {}}
                      : Saved{};
    Saved saved = between(isShadows);
    if (saved.bytes) saved.bytes = 0.0;  // light that bounces would take them
    return saved;
  }

  // Hits are kept for bounces alone, and closest hits take longer than any hits.
  Saved bounces(bool baked, bool shadows) const {
    if (baked)
      return planned_ ? Saved{.seconds = secondsOf(*planned_, isBounce),
                              .memory_bytes = planned_->hit_bytes,
                              .bytes = {}}
                      : Saved{};
    Saved saved = between(isBounce);
    if (shadows && planned_ && all_)
      *saved.seconds += std::max(0.0, secondsOf(*all_, isShadows) - secondsOf(*planned_, isShadows));
    if (all_ && planned_) saved.memory_bytes = std::max(0.0, all_->hit_bytes - planned_->hit_bytes);
    return saved;
  }

  std::optional<double> refinement() const { return refinement_; }

 private:
  Saved between(bool (*is)(std::string_view)) const {
    if (!planned_ || !all_) return {};
    return {.seconds = std::max(0.0, secondsOf(*all_, is) - secondsOf(*planned_, is)),
            .memory_bytes = 0.0,
            .bytes = std::max(0.0, all_->bytes - planned_->bytes)};
  }

  const BakeEstimate::Group *planned_ = nullptr, *all_ = nullptr;
  std::optional<double> refinement_;
};

Decision groupShadows(const PlannedTransport& planned, const Savings& savings) {
  Decision d{.effect = "shadows",
             .choice = planned.shadows ? Choice::Baked : Choice::LeftOut,
             .reason = planned.shadows_reason};
  if (planned.height >= 0.0) d.figures = {{"heightAboveFaces", 100.0 * planned.height, "% of the diagonal"}};
  d.saves = savings.shadows(planned.shadows);
  return d;
}

Decision groupInterreflection(const BakeOptions& options, const PlannedTransport& planned,
                              const Savings& savings) {
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
  d.saves = savings.bounces(baked, planned.shadows);
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
  if (lights.empty()) d.saves = kSavesNothing;
  return d;
}

Decision refinement(const Decided& decided, std::size_t group, const Savings& savings) {
  const double bound = double{decided.options.effectiveRefineBound()};
  const bool shadows = decided.plan.transport[group].shadows;
  Decision d{.effect = "refinement", .choice = Choice::Baked};
  if (bound > 0.0 && shadows) {
    d.reason = fmt::format("edges are split until interpolation errs by {} where shadows change",
                           percentText(bound));
  } else {
    d.choice = Choice::LeftOut;
    d.reason = shadows ? "--refine off: 0 edges are split" : "0 shadows change between its vertices";
    d.saves.seconds = savings.refinement();
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
  if (d.choice == Choice::Absent) d.saves = kSavesNothing;
  return d;
}

}  // namespace

std::vector<Decision> groupDecisions(const Decided& decided, std::size_t g) {
  const EffectPlan& plan = decided.plan;
  const RigidGroup& group = plan.groups[g];
  std::vector<Decision> all;
  Decision volume{.effect = "volume",
                  .choice = group.volume < 0 ? Choice::Absent : Choice::Baked,
                  .reason = group.volume < 0 ? "0 media: it is a group of surfaces" : "1 medium"};
  if (group.volume < 0) {
    const Savings savings(decided.estimates, g);
    all = {groupShadows(plan.transport[g], savings),
           groupInterreflection(decided.options, plan.transport[g], savings), lamps(decided.scene, group),
           refinement(decided, g, savings)};
    volume.saves = kSavesNothing;
  }
  all.push_back(lightProbes(plan.light_probes[g]));
  all.push_back(neighborhood(plan.neighborhoods[g]));
  all.push_back(std::move(volume));
  return all;
}

}  // namespace lambent::baker
