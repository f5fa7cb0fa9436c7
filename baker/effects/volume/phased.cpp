// Computes one more scattering in a medium whose phase function has g other than 0. Of the radiance that
// arrives at each sample, with coefficients x_i in bands, g^l x_i continues, so that
//   (K x)_i(p) = int y_i(s) int sigma(x_t) tau(p, x_t) sum_j g^l(j) y_j(s) x_j(x_t) dt ds
// arrives after one scattering without absorption (light from s travels along -s before and after, so the
// cosine of the phase function is s . s'). Rays are the same for all samples. So for each ray direction the
// radiance along it is first evaluated, one number per node, and then gathered. As in isotropic.cpp,
// stretches of depth e have the weight tau (1 - exp(-e)) and read coarser levels where rays are far apart.
//
// Everything is stored as differences from the state in which all light stays and continues: K x = g^l x +
// (the result of apply()). These are as small as what a free path changes, so that no precision is lost in
// thick media.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "baker/effects/volume/scattering.hpp"
#include "baker/jobs/parallel.hpp"
#include "baker/jobs/stage.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

// A RayStep stands for adjacent stretches of a ray: their mean distance in metres, and the share of the ray
// that they scatter.
struct RayStep {
  float t, share;
};
template <>
inline constexpr bool kPlainBytes<RayStep> = true;

namespace {

constexpr std::size_t kRaysPerOutput = 6;
// The number of the solver's vectors depends on the size of the system, not on the machine's memory, so that
// results do not either.
constexpr std::uint64_t kSolverBytes = std::uint64_t{1} << 30, kLeastKept = 6;
constexpr std::size_t kNodeGrain = 256;
using ColumnValues = std::array<float, kBlockColumns>;

// Adds factor * from to `to`.
void addScaled(float* to, const float* from, float factor) {
  for (std::size_t c = 0; c < kBlockColumns; ++c) to[c] += factor * from[c];
}

// Computes the radiance along a ray from coefficients [output][kBlockColumns].
void look(const float* coefficients, std::span<const float> as, float* out) {
  ColumnValues sum{};
  for (std::size_t i = 0; i < as.size(); ++i) addScaled(sum.data(), coefficients + i * kBlockColumns, as[i]);
  std::copy(sum.begin(), sum.end(), out);
}

class PhaseScattering {
 public:
  // `bands` are those of arriving light, `g` is the mean cosine of the phase function. `table` has as many
  // bands, and at least 2 bands² rays. Steps of rays that do not fit into the memory are traced again each
  // time, with the same result. Scene and table must outlive this.
  PhaseScattering(const VolumeScene& scene, const SphereTable& table, int bands, float g,
                  std::uint64_t memory)
      : scene_(scene),
        table_(table),
        steps_(scene.density, scene.grid, table.size()),
        away_(scene.grid.samples()),
        chunks_((scene.grid.samples() + kSamplesPerChunk - 1) / kSamplesPerChunk, memory) {
    const auto& [density, grid, occluders] = scene;
    double power = 1.0;
    for (int l = 0; l < bands; ++l, power *= double{g})
      for (int m = -l; m <= l; ++m) factors_.push_back(power);
    amiss_.resize(grid.samples() * outputs());
    resolved_.resize(grid.nodes());
    for (std::size_t p = 0; p < grid.samples(); ++p)
      resolved_[p] = density.atGrid(density.gridFromGroup(grid.place(p))) * grid.meanEdge();
    grid.raise(resolved_, 1);
    for (float& value : resolved_) value = 1.0f - glm::smoothstep(2.0f, 4.0f, value);
    findDuals();
  }

  // Traces all rays. `clear` is [sample][bands²], int tau y_i ds up to the outside or to surfaces, from many
  // rays (FirstLight); uniform light is corrected to agree with it. Returns the figures of the samples, or
  // nothing if stopped.
  std::optional<StageFigures> trace(std::span<const float> clear, const BakeContext& context) {
    const auto fitting = [&](const Chunk& chunk, std::size_t samples) { return fits(chunk, samples); };
    const auto compute = [&](std::size_t begin, std::size_t end) {
      Chunk chunk = trace(begin / kSamplesPerChunk, 0, table_.size());
      sumUp(clear, chunk, begin, end);
      chunks_.offer(begin / kSamplesPerChunk, std::move(chunk));
    };
    return runStage(
        {.name = "scattering",
         .count = samples(),
         .grain = kSamplesPerChunk,
         .writes = {rowsOf(away_), rowsOf(amiss_, outputs()), chunks_.output(kSamplesPerChunk, fitting)},
         .compute = compute},
        context);
  }

  std::size_t samples() const { return scene_.grid.samples(); }
  std::size_t outputs() const { return factors_.size(); }
  // Returns g^l of output i.
  double factor(std::size_t i) const { return factors_[i]; }
  // Returns the share of the light leaving a sample that does not come back to it: it reaches other samples,
  // the outside or a surface.
  double away(std::size_t p) const { return away_[p]; }
  std::uint64_t bytes() const { return chunks_.bytes(); }

  // Computes out = K x - g^l x. `x` and `out` are [sample][outputs][kBlockColumns]. Returns false if stopped.
  bool apply(std::span<const float> x, std::span<float> out, const std::stop_token& stop) {
    const std::size_t n = outputs(), nodes = scene_.grid.nodes(), above = nodes - samples();
    std::vector<float> values(nodes * n * kBlockColumns), bent(above * n * kBlockColumns);
    std::array<Seen, kRays> seen;
    for (Seen& by : seen)
      by.near.resize(samples() * kNear * kBlockColumns), by.far.resize(above * kBlockColumns);
    std::copy(x.begin(), x.end(), values.begin());
    scene_.grid.raise(values, n * kBlockColumns);
    bend(values, bent);
    // Uniform light is corrected to the result of many rays.
    for (std::size_t p = 0; p < samples(); ++p)
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < kBlockColumns; ++c)
          out[(p * n + i) * kBlockColumns + c] = -amiss_[p * n + i] * x[p * n * kBlockColumns + c];
    for (std::size_t first = 0; first < table_.size(); first += kRays) {
      const std::size_t count = std::min(kRays, table_.size() - first);
      for (std::size_t r = 0; r < count; ++r)
        if (!see(first + r, x, bent, seen[r].near, seen[r].far, stop)) return false;
      if (!parallelRanges(samples(), kSamplesPerChunk, stop, [&](std::size_t begin, std::size_t) {
            gather(begin / kSamplesPerChunk, first, std::span(seen).first(count), out);
          }))
        return false;
    }
    return true;
  }

 private:
  // Seen is the radiance along one ray direction at the samples and at the nodes above them.
  struct Seen {
    std::vector<float> near, far;
  };
  static constexpr std::size_t kNear = 4;
  static constexpr std::size_t kRays = 2;  // rays that are handled at a time
  struct Chunk {
    std::vector<std::uint32_t> begins;  // [sample][ray], then the number of steps
    std::vector<RayStep> steps;
    std::vector<float> left;  // [sample][ray]: share that reaches the outside or a surface
    std::uint64_t bytes() const { return 4 * (begins.size() + left.size()) + 8 * steps.size(); }
    void shrink() { steps.shrink_to_fit(); }
    friend void write(const Chunk& chunk, ByteWriter& out) {
      out.addList(chunk.begins), out.addList(chunk.steps), out.addList(chunk.left);
    }
    friend bool read(ByteReader& in, Chunk& chunk) {
      return in.readList(chunk.begins) && in.readList(chunk.steps) && in.readList(chunk.left);
    }
  };

  // Sums over rays are not quite integrals, since y_i and y_j are not quite orthogonal on them. With the dual
  // basis, light that stays where it is comes out unchanged.
  void findDuals() {
    const auto n = static_cast<Eigen::Index>(outputs()), rays = static_cast<Eigen::Index>(table_.size());
    Eigen::MatrixXd y(n, rays);
    for (Eigen::Index r = 0; r < rays; ++r)
      for (Eigen::Index i = 0; i < n; ++i)
        y(i, r) = double{table_.harmonics(static_cast<std::size_t>(r))[static_cast<std::size_t>(i)]};
    const Eigen::MatrixXd duals = (y * y.transpose()).ldlt().solve(y);
    for (Eigen::Index r = 0; r < rays; ++r)
      for (Eigen::Index i = 0; i < n; ++i) {
        duals_.push_back(static_cast<float>(duals(i, r)));
        seen_as_.push_back(static_cast<float>(factors_[static_cast<std::size_t>(i)] * y(i, r)));
      }
  }

  // Traces rays [first, end) of the samples of a chunk.
  Chunk trace(std::size_t chunk, std::size_t first, std::size_t end) const {
    Chunk out;
    std::vector<float> reach(end - first);
    out.begins.push_back(0);
    for (std::size_t p = chunk * kSamplesPerChunk; p < std::min((chunk + 1) * kSamplesPerChunk, samples());
         ++p) {
      const glm::vec3 origin = scene_.grid.place(p);
      scene_.occluders.reach(origin, table_.directions().subspan(first, end - first), reach);
      for (std::size_t r = first; r < end; ++r) {
        const double left =
            steps_.gather(origin, table_.direction(r), reach[r - first], [&](double t, double share) {
              out.steps.push_back({static_cast<float>(t), static_cast<float>(share)});
            });
        out.left.push_back(static_cast<float>(left));
        out.begins.push_back(static_cast<std::uint32_t>(out.steps.size()));
      }
    }
    return out;
  }

  // Computes away_ and amiss_ for the samples of one chunk from its rays.
  void sumUp(std::span<const float> clear, const Chunk& chunk, std::size_t begin, std::size_t end) {
    const std::size_t rays = table_.size(), n = outputs();
    std::vector<double> out(n);
    for (std::size_t p = begin; p < end; ++p) {
      const glm::dvec3 from = scene_.grid.gridFromGroup(glm::dvec3(scene_.grid.place(p)));
      const bool beyond = resolved_[p] > 0.5f;
      double away = 0.0;
      std::fill(out.begin(), out.end(), 0.0);
      for (std::size_t r = 0; r < rays; ++r) {
        const std::size_t ray = (p - begin) * rays + r;
        const glm::dvec3 along = scene_.grid.gridDirection(glm::dvec3(table_.direction(r)));
        for (std::uint32_t s = chunk.begins[ray]; s < chunk.begins[ray + 1]; ++s) {
          const RayStep& step = chunk.steps[s];
          const double t = double{step.t};
          const TransferGrid::Stencil at = scene_.grid.stencil(from + t * along, steps_.levelAt(t), beyond);
          for (std::size_t k = 0; k < static_cast<std::size_t>(at.count); ++k)
            if (at.node[k] != p) away += double{step.share} * at.weight[k];
        }
        const double left = double{chunk.left[ray]};
        away += left;
        for (std::size_t i = 0; i < n; ++i) out[i] += left * double{duals_[r * n + i]};
      }
      away_[p] = away / static_cast<double>(rays);
      for (std::size_t i = 0; i < n; ++i)
        amiss_[p * n + i] = static_cast<float>(kMeanOfBandZero * (double{clear[p * n + i]} - out[i]));
    }
  }

  // Returns whether the chunk has the form that trace() gives it, or is empty.
  bool fits(const Chunk& chunk, std::size_t samples) const {
    if (chunk.begins.empty()) return chunk.steps.empty() && chunk.left.empty();
    const std::size_t rays = samples * table_.size();
    return chunk.begins.size() == rays + 1 && chunk.left.size() == rays && chunk.begins.front() == 0 &&
           chunk.begins.back() == chunk.steps.size() &&
           std::is_sorted(chunk.begins.begin(), chunk.begins.end());
  }

  // Linear interpolation of a curve lies above it (isotropic.cpp, Row::add): by 1/12 of the second difference
  // on average over the places that are read. A node of level l, as a mean of 2^l voxels, does so by (1 -
  // 4^-l) / 24, taken as 1/24. The nodes above the samples are corrected by both. Samples themselves are not,
  // since rays read them from near, at a few places only.
  void bend(std::span<const float> nodes, std::span<float> bent) const {
    const std::size_t width = outputs() * kBlockColumns, above = scene_.grid.nodes() - samples();
    parallelRanges(above, kNodeGrain, {}, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t node = samples() + i;
        float* to = &bent[i * width];
        std::copy_n(&nodes[node * width], width, to);
        const float amount = resolved_[node] * (1.0f / 12.0f + 1.0f / 24.0f);
        if (amount == 0.0f) continue;
        for (int axis = 0; axis < 3; ++axis) {
          const auto around = curveAt(node, axis);
          if (!around) continue;
          const float* a = &nodes[(*around)[0] * width];
          const float* b = &nodes[(*around)[1] * width];
          const float* c = &nodes[(*around)[2] * width];
          for (std::size_t k = 0; k < width; ++k) to[k] -= amount * ((a[k] - b[k]) + (c[k] - b[k]));
        }
      }
    });
  }

  // Returns the three adjacent nodes whose second difference counts at a node. At the rim, these are the ones
  // one node further in.
  std::optional<std::array<std::size_t, 3>> curveAt(std::size_t node, int axis) const {
    auto middle = static_cast<std::uint32_t>(node);
    const auto beside = scene_.grid.neighbors(middle, axis);
    if (beside.first < 0 && beside.second >= 0) middle = static_cast<std::uint32_t>(beside.second);
    if (beside.first >= 0 && beside.second < 0) middle = static_cast<std::uint32_t>(beside.first);
    const auto [before, after] = scene_.grid.neighbors(middle, axis);
    if (before < 0 || after < 0) return std::nullopt;
    return std::array{static_cast<std::size_t>(before), std::size_t{middle}, static_cast<std::size_t>(after)};
  }

  // Evaluates one ray direction. `near` is [sample][kNear][kBlockColumns]: the radiance at the samples, then
  // its second differences along the axes. `far` is [node above the samples][kBlockColumns].
  bool see(std::size_t ray, std::span<const float> x, std::span<const float> bent, std::span<float> near,
           std::span<float> far, const std::stop_token& stop) const {
    const std::size_t n = outputs();
    const auto as = std::span(seen_as_).subspan(ray * n, n);
    return parallelRanges(samples(), kNodeGrain, stop,
                          [&](std::size_t begin, std::size_t end) {
                            for (std::size_t p = begin; p < end; ++p)
                              look(&x[p * n * kBlockColumns], as, &near[p * kNear * kBlockColumns]);
                          }) &&
           parallelRanges(samples(), kNodeGrain, stop,
                          [&](std::size_t begin, std::size_t end) {
                            for (std::size_t p = begin; p < end; ++p)
                              for (int axis = 0; axis < 3; ++axis) {
                                float* to =
                                    &near[(p * kNear + 1 + static_cast<std::size_t>(axis)) * kBlockColumns];
                                const auto around = curveAt(p, axis);
                                if (!around) {
                                  std::fill_n(to, kBlockColumns, 0.0f);
                                  continue;
                                }
                                const float* a = &near[(*around)[0] * kNear * kBlockColumns];
                                const float* b = &near[(*around)[1] * kNear * kBlockColumns];
                                const float* c = &near[(*around)[2] * kNear * kBlockColumns];
                                for (std::size_t k = 0; k < kBlockColumns; ++k)
                                  to[k] = (a[k] - b[k]) + (c[k] - b[k]);
                              }
                          }) &&
           parallelRanges(far.size() / kBlockColumns, kNodeGrain, stop,
                          [&](std::size_t begin, std::size_t end) {
                            for (std::size_t i = begin; i < end; ++i)
                              look(&bent[i * n * kBlockColumns], as, &far[i * kBlockColumns]);
                          });
  }

  void gather(std::size_t index, std::size_t first_ray, std::span<const Seen> seen,
              std::span<float> out) const {
    const std::size_t rays = table_.size(), n = outputs();
    const std::size_t end_ray = first_ray + seen.size();
    const Chunk& kept = chunks_[index];
    const bool has = !kept.begins.empty();
    const Chunk traced = has ? Chunk{} : trace(index, first_ray, end_ray);
    const Chunk& chunk = has ? kept : traced;
    const std::size_t stride = has ? rays : end_ray - first_ray, offset = has ? first_ray : 0;
    ColumnValues sum;
    const std::size_t begin = index * kSamplesPerChunk, end = std::min(begin + kSamplesPerChunk, samples());
    for (std::size_t p = begin; p < end; ++p) {
      const glm::dvec3 from = scene_.grid.gridFromGroup(glm::dvec3(scene_.grid.place(p)));
      const double resolved = double{resolved_[p]};
      for (std::size_t r = first_ray; r < end_ray; ++r) {
        const std::size_t ray = (p - begin) * stride + offset + (r - first_ray);
        const glm::dvec3 along = scene_.grid.gridDirection(glm::dvec3(table_.direction(r)));
        const Seen& by = seen[r - first_ray];
        const float* const own = &by.near[p * kNear * kBlockColumns];
        for (std::size_t c = 0; c < kBlockColumns; ++c) sum[c] = -chunk.left[ray] * own[c];
        for (std::uint32_t s = chunk.begins[ray]; s < chunk.begins[ray + 1]; ++s) {
          const RayStep& step = chunk.steps[s];
          const double t = double{step.t};
          const int level = steps_.levelAt(t);
          const TransferGrid::Stencil at = scene_.grid.stencil(from + t * along, level, resolved > 0.5);
          const glm::vec3 bend(resolved * 0.5 * at.fraction * (1.0 - at.fraction));
          for (std::size_t k = 0; k < static_cast<std::size_t>(at.count); ++k) {
            const float weight = step.share * static_cast<float>(at.weight[k]);
            if (level > 0) {
              const float* node = &by.far[(at.node[k] - samples()) * kBlockColumns];
              for (std::size_t c = 0; c < kBlockColumns; ++c) sum[c] += weight * (node[c] - own[c]);
              continue;
            }
            const float* node = &by.near[at.node[k] * kNear * kBlockColumns];
            for (std::size_t c = 0; c < kBlockColumns; ++c)
              sum[c] +=
                  weight * ((node[c] - own[c]) - bend.x * node[kBlockColumns + c] -
                            bend.y * node[2 * kBlockColumns + c] - bend.z * node[3 * kBlockColumns + c]);
          }
        }
        for (std::size_t i = 0; i < n; ++i)
          addScaled(&out[(p * n + i) * kBlockColumns], sum.data(), duals_[r * n + i]);
      }
    }
  }

  const VolumeScene& scene_;
  const SphereTable& table_;
  RaySteps steps_;
  std::vector<double> factors_;
  // For each ray these hold g^l y_i, and the dual basis, which turns sums over rays into coefficients: it is
  // orthonormal to y_i on these rays.
  std::vector<float> seen_as_, duals_;
  std::vector<float> resolved_;  // 1 where a free path is at least a voxel, 0 where it is much shorter
  std::vector<double> away_;
  std::vector<float> amiss_;  // [sample][outputs]: error of few rays against `clear`, times y_0
  KeptChunks<Chunk> chunks_;
};

}  // namespace

bool bakePhasedTransfer(const Medium& medium, const VolumeSettings& settings, const Occluders& occluders,
                        VolumeTransfer& out, const BakeContext& context) {
  const std::size_t samples = out.grid.samples(), outputs = out.outputs();
  const VolumeScene scene{*medium.density, out.grid, occluders};
  const SphereTable table(settings.rays, out.order + out.bands - 1);
  auto light = lightIn(scene, table, outputs, context.part("light"));
  if (!light) return false;
  out.rays = light->samples_traced * table.size();
  out.rays_kept = (samples - light->samples_traced) * table.size();
  const sh::GauntTable products = sh::makeGauntTable(out.order, out.bands);
  const std::size_t visibility = out.visibilitySize();
  parallelRanges(samples, kSamplesPerChunk, {}, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      sh::addVisibilityMatrix(products, std::span(light->transfer).subspan(p * visibility, visibility),
                              std::span(out.vectors).subspan(p * out.vectorSize(), outputs * out.columns()));
  });
  if (out.bands > 3) out.visibility = std::move(light->transfer);
  if (out.full_channels == 0) return true;

  const SphereTable few(
      std::max({kLeastScatteringRays, kRaysPerOutput * outputs, settings.rays / kRaysPerScatteringRay}),
      out.bands);
  PhaseScattering scattering(scene, few, out.bands, out.g, settings.memory);
  const auto traced = scattering.trace(light->clear, context.part("rows"));
  if (!traced) return false;
  out.rays += traced->computed * few.size();
  out.rays_kept += traced->found * few.size();
  out.row_bytes = scattering.bytes();
  const std::uint64_t vector = 4 * samples * outputs * kBlockColumns;
  const auto kept_vectors =
      static_cast<int>(std::clamp(kSolverBytes / vector, kLeastKept, std::uint64_t{kMostKeptVectors}));
  const auto rows = [&](double albedo) {
    std::vector<ScatteringSystem::Row> own;
    for (std::size_t p = 0; p < samples; ++p)
      for (std::size_t i = 0; i < outputs; ++i) {
        // This computes 1 - w g^l k_pp without subtracting two numbers near 1.
        const double factor = scattering.factor(i), away = scattering.away(p), stays = albedo * factor;
        own.push_back({.scale = 1.0 / std::max(1.0 - stays + stays * away, 1e-30),
                       .rest = factor * away,
                       .stays = factor});
      }
    return own;
  };
  const auto apply = [&](std::span<const float> x, std::span<float> y) {
    return scattering.apply(x, y, context.stop);
  };
  return scatterLight({.apply = apply, .rows = rows, .kept_vectors = kept_vectors}, settings, out, context);
}

}  // namespace lambent::baker
