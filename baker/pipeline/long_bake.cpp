#include "baker/pipeline/long_bake.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "baker/plan/smooth_dielectrics.hpp"

namespace lambent::baker {

namespace {

// Processor time of a sample, bounces and codes included: of its rays, and of what is done whatever they are.
// Rounded from drafts of docs/measurements/bakes.md, "Beforehand".
constexpr double kDiffuseRay_s = 1.5e-6, kDiffuseSample_s = 2.4e-4;
constexpr double kGlossyRay_s = 2.5e-6, kGlossySample_s = 2.6e-4;
// Refinement is expected to double the vertices where it may.
constexpr double kGrowth = 2.0;

}  // namespace

double guessProcessorSeconds(const Scene& scene, const EffectPlan& plan, const BakeOptions& options) {
  double diffuse = 0.0, glossy = 0.0;
  const bool with_glossy = plan.bakes("glossy");
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    if (!plan.transport[g].shadows) continue;
    for (const PlannedDraw& draw : plan.groups[g].draws) {
      const ScenePrimitive& primitive = scene.meshes[draw.mesh].primitives[draw.primitive];
      const auto vertices = static_cast<double>(primitive.mesh.positions.size());
      const bool matrices = with_glossy && primitive.material >= 0 &&
                            hasMatrices(scene.materials[static_cast<std::size_t>(primitive.material)]);
      (matrices ? glossy : diffuse) += vertices;
    }
  }
  if (options.effectiveRefineBound() > 0.0f) {
    const auto grown = [&](double vertices) {
      const double most = options.refineGrowth() * vertices + static_cast<double>(options.refineAdded());
      return std::min(kGrowth * vertices, most);
    };
    diffuse = grown(diffuse);
    if (options.refinesGlossy()) glossy = grown(glossy);
  }
  const auto rays = static_cast<double>(options.effectiveRays());
  return diffuse * (kDiffuseSample_s + rays * kDiffuseRay_s) +
         glossy * (kGlossySample_s + rays * kGlossyRay_s);
}

std::optional<std::string> longBakeNotice(double processor_seconds) {
  if (processor_seconds <= kLongBake_s) return std::nullopt;
  const double minutes = processor_seconds / 60.0;
  const std::string time = minutes < 120.0 ? fmt::format("{:.0f} min", std::ceil(minutes))
                                           : fmt::format("{:.0f} hours", std::ceil(minutes / 60.0));
  return fmt::format(
      "takes about {} of processor time, less what the cache holds of it; fewer rays (--rays) take less, and "
      "lambent plan says it closer",
      time);
}

}  // namespace lambent::baker
