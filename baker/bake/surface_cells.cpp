#include "baker/bake/surface_cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "baker/bake/picture_budget.hpp"
#include "baker/brdf/kernel_power.hpp"
#include "baker/effects/diffuse/diffuse.hpp"
#include "baker/effects/glossy/glossy.hpp"
#include "baker/transport/face_points.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

namespace {

// The share of visibility in the bound on glossy light, where light bounces: halving the error costs
// visibility a dozen bytes a vertex, and bounced light of sharp metals a hundred
// (docs/design/compression.md, "Glossy matrices").
constexpr float kOfVisibility = 0.35f;
// Eyes may see other errors of codes than those of all samples, so codes are made again with a better bound.
constexpr int kMostCodings = 3;

class CellCoder {
 public:
  CellCoder(const GroupScene& group, const SurfaceTransport& light, CachedCoding& coding)
      : group_(group),
        light_(light),
        options_(group.bake.options),
        coding_(coding),
        grey_{.sky = group.colors().greyPanes(), .lights = group.colors().greyEmission()},
        weights_(weightsOf(*group.view().importance)),
        kernel_power_(group.brdfs()
                          ? kernelPower(group.geometry, *group.brdfs(), group.bake.options.glossy_order)
                          : BandPower(kLobePower)) {}

  std::vector<CodedTransfer> codeGlossy(const SampleCell& cell, SurfaceFigures& figures);
  std::vector<CodedTransfer> codeDiffuse(const SampleCell& cell, SurfaceFigures& figures);

 private:
  // Returns how much samples matter to pictures. Eyes may come to see any of them one day, so that none
  // counts for nothing, and none for all.
  static std::vector<float> weightsOf(const SampleImportance& importance) {
    constexpr float kLeast = 0.05f, kMost = 4.0f;
    const auto count = static_cast<float>(importance.shares.size());
    std::vector<float> weights;
    for (const float share : importance.shares) weights.push_back(std::clamp(count * share, kLeast, kMost));
    return weights;
  }
  std::span<const float> weightsOf(const SampleCell& cell) const {
    return std::span(weights_).subspan(cell.first, cell.count);
  }

  const GroupScene& group_;
  const SurfaceTransport& light_;
  const BakeOptions& options_;
  CachedCoding& coding_;
  GreyColumns grey_;
  std::vector<float> weights_;
  BandPower kernel_power_;
};

// Visibility and bounced light are shown together: errors of both are relative to both, and their squares add
// up to the square of the bound. A bound that was asked for is kept at any price.
std::vector<CodedTransfer> CellCoder::codeGlossy(const SampleCell& cell, SurfaceFigures& figures) {
  std::vector<CodedTransfer> coded;
  const std::vector<CellVectors> parts = glossyCellVectors(cell, light_.glossy->field, grey_.lights);
  double shown = 0.0;
  bool any_bounced = false;
  for (const CellVectors& part : parts) {
    if (part.shape.order == 0) continue;  // transfer of the group's lights
    shown += transferEnergy(part.vectors, part.shape, kernel_power_);
    any_bounced |= !part.shape.isVisibility();
  }
  double square = 0.0;
  for (const CellVectors& part : parts) {
    const bool environment = part.shape.order > 0;
    float bound = figures.glossy_codes_bound;
    if (environment && any_bounced)
      bound *= part.shape.isVisibility() ? kOfVisibility : std::sqrt(1.0f - kOfVisibility * kOfVisibility);
    coded.push_back(
        coding_.code(part.vectors, cell.count, part.shape,
                     {.bound = bound,
                      .most_components = options_.error_bound > 0.0f ? kAllComponents : kUsualComponents,
                      .loose_bound = options_.glossyLooseness() * bound,
                      .shown_energy = environment ? shown : 0.0,
                      .kernel_power = kernel_power_,
                      .weights = weightsOf(cell)}));
    const double error = coded.back().error;
    if (environment)
      square += error * error;
    else
      figures.worst_glossy_error = std::max(figures.worst_glossy_error, error);
  }
  figures.worst_glossy_error = std::max(figures.worst_glossy_error, std::sqrt(square));
  return coded;
}

std::vector<CodedTransfer> CellCoder::codeDiffuse(const SampleCell& cell, SurfaceFigures& figures) {
  std::vector<CodedTransfer> coded;
  for (const CellVectors& vectors :
       cellVectors(cell, group_.samples, light_.direct, light_.bounced ? &*light_.bounced : nullptr, grey_)) {
    coded.push_back(coding_.code(vectors.vectors, cell.count, vectors.shape,
                                 {.bound = figures.codes_bound, .weights = weightsOf(cell)}));
    figures.worst_error = std::max(figures.worst_error, double{coded.back().error});
  }
  return coded;
}

// Codes the importance of samples per area, relative to the mean.
std::vector<std::uint8_t> importanceCodes(const GroupScene& group) {
  const std::vector<float>& shares = group.view().importance->shares;
  const std::vector<float> areas = sampleAreas(group.geometry, group.samples);
  const double all_shares = std::reduce(shares.begin(), shares.end(), 0.0);
  const double all_areas = std::reduce(areas.begin(), areas.end(), 0.0);
  const auto mean = static_cast<float>(all_areas > 0.0 ? all_shares / all_areas : 0.0);
  std::vector<std::uint8_t> codes;
  for (std::size_t s = 0; s < shares.size(); ++s)
    codes.push_back(bundle::importanceCode(mean * areas[s] > 0.0f ? shares[s] / (mean * areas[s]) : 0.0f));
  return codes;
}

}  // namespace

void write(const SurfaceCells& cells, ByteWriter& out) {
  const SurfaceFigures& figures = cells.figures;
  write(cells.cells, out);
  out.addList(cells.importance);
  out.add(figures.filled_samples), out.add(figures.glossy_samples), out.add(figures.hit_bytes);
  out.add(figures.worst_error), out.add(figures.worst_glossy_error), out.add(figures.left_out);
  out.addList(figures.pass_energy);
  out.add(figures.diffuse.traced + figures.diffuse.kept);
  out.add(figures.glossy.traced + figures.glossy.kept);
  out.add(figures.picture_error.value_or(bundle::PictureError{}));
  out.add(figures.codes_bound), out.add(figures.glossy_codes_bound);
}

bool read(ByteReader& in, SurfaceCells& cells) {
  SurfaceFigures& figures = cells.figures;
  bundle::PictureError error;
  const bool whole =
      read(in, cells.cells) && in.readList(cells.importance) && in.read(figures.filled_samples) &&
      in.read(figures.glossy_samples) && in.read(figures.hit_bytes) && in.read(figures.worst_error) &&
      in.read(figures.worst_glossy_error) && in.read(figures.left_out) && in.readList(figures.pass_energy) &&
      in.read(figures.diffuse.kept) && in.read(figures.glossy.kept) && in.read(error) &&
      in.read(figures.codes_bound) && in.read(figures.glossy_codes_bound);
  if (whole && error.points > 0) figures.picture_error = error;
  return whole;
}

std::optional<SurfaceCells> codeSurfaces(const GroupScene& group, const SurfaceTransport& light,
                                         CachedCoding& coding, Progress& progress) {
  const BakeOptions& options = group.bake.options;
  SurfaceCells out{{}, importanceCodes(group), light.figures};
  out.cells.resize(group.samples.cells.size());
  CellCoder coder(group, light, coding);
  // Returns false if stopped.
  const auto code = [&](bool glossy) {
    progress.begin("coding", glossy ? group.samples.glossy.size() : group.samples.glossy.begin, "samples");
    for (std::size_t c = 0; c < out.cells.size(); ++c) {
      const SampleCell& cell = group.samples.cells[c];
      if ((cell.kind == SampleKind::Glossy) != glossy) continue;
      out.cells[c] = glossy ? coder.codeGlossy(cell, out.figures) : coder.codeDiffuse(cell, out.figures);
      if (coding.stopped()) return false;
      progress.add(cell.count);
    }
    return true;
  };
  const bool chooses = options.picture_bound > 0.0f && options.error_bound == 0.0f;
  std::optional<float> bound = options.effectiveErrorBound();
  if (chooses)
    if (const auto shown = shownBy(group, light, nullptr)) bound = codesBound(*shown, options.picture_bound);
  for (int codings = 1; bound; ++codings) {
    out.figures.codes_bound = *bound;
    out.figures.glossy_codes_bound = chooses ? glossyCodesBound(*bound) : options.effectiveGlossyErrorBound();
    out.figures.worst_error = light.figures.worst_error;
    out.figures.worst_glossy_error = light.figures.worst_glossy_error;
    if (group.anyGlossy() && !code(/*glossy=*/true)) return std::nullopt;
    if (!code(/*glossy=*/false)) return std::nullopt;
    auto& shown = out.figures.picture_error = shownBy(group, light, &out.cells);
    bound.reset();
    if (chooses && shown && codings < kMostCodings)
      bound = nextCodesBound(out.figures.codes_bound, *shown, options.picture_bound);
  }
  return out;
}

}  // namespace lambent::baker
