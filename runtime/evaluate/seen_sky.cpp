#include "runtime/evaluate/seen_sky.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>
#include <utility>

#include <glm/geometric.hpp>

#include "runtime/bundle/brdf_table.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::evaluate {

namespace {

using sh::kPi;
constexpr int kSeenKernelBands = static_cast<int>(transfer::kSeenBands);
constexpr std::size_t kCount = transfer::kSeenWeights;
using Vector = std::array<double, kCount>;
using Matrix = std::array<Vector, kCount>;

// Narrower lobes than this are beyond what the bands can tell apart.
constexpr float kLeastRoughness = 0.3f;
// Adds this share of the mean of the diagonal to it, so that errors of the coding do not grow too much.
constexpr double kDamping = 1e-2;

// A direction of the quadrature over half of the hemisphere, whose other half is its mirror image.
struct Node {
  glm::dvec3 direction;
  double solid_angle;
  Vector functions;  // y_k max(n·s, 0)/pi for m >= 0, at l(l+1)/2 + m
};

std::vector<Node> quadrature() {
  constexpr int kHeights = 40, kAzimuths = 48;
  std::vector<Node> nodes;
  for (int i = 0; i < kHeights; ++i)
    for (int j = 0; j < kAzimuths; ++j) {
      const double z = (i + 0.5) / kHeights, phi = kPi * (j + 0.5) / kAzimuths, r = std::sqrt(1.0 - z * z);
      Node node{.direction = {r * std::cos(phi), r * std::sin(phi), z},
                .solid_angle = 2.0 * kPi / (kHeights * kAzimuths),
                .functions = {}};
      std::array<double, transfer::kSeenCoefficients> y;
      sh::evaluate(kSeenKernelBands, node.direction, y);
      for (int l = 0; l < kSeenKernelBands; ++l)
        for (int m = 0; m <= l; ++m)
          node.functions[static_cast<std::size_t>(l * (l + 1) / 2 + m)] =
              y[static_cast<std::size_t>(l * (l + 1) + m)] * z / kPi;
      nodes.push_back(node);
    }
  return nodes;
}

// Returns the lower factor of Cholesky's decomposition.
Matrix factorOf(Matrix a) {
  for (std::size_t j = 0; j < kCount; ++j)
    for (std::size_t i = j; i < kCount; ++i) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= a[i][k] * a[j][k];
      a[i][j] = i == j ? std::sqrt(sum) : sum / a[j][j];
    }
  return a;
}

Vector solve(const Matrix& factor, Vector right) {
  for (std::size_t i = 0; i < kCount; ++i) {
    for (std::size_t k = 0; k < i; ++k) right[i] -= factor[i][k] * right[k];
    right[i] /= factor[i][i];
  }
  for (std::size_t i = kCount; i-- > 0;) {
    for (std::size_t k = i + 1; k < kCount; ++k) right[i] -= factor[k][i] * right[k];
    right[i] /= factor[i][i];
  }
  return right;
}

Matrix normalMatrix(const std::vector<Node>& nodes) {
  Matrix sums{};
  for (const Node& node : nodes)
    for (std::size_t i = 0; i < kCount; ++i)
      for (std::size_t k = 0; k < kCount; ++k)
        sums[i][k] += node.solid_angle * node.functions[i] * node.functions[k];
  double trace = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) trace += sums[i][i];
  for (std::size_t i = 0; i < kCount; ++i) sums[i][i] += kDamping * trace / kCount;
  return sums;
}

// Returns the weights b for a direction at this cosine, with m >= 0.
Vector weightsFor(const std::vector<Node>& nodes, const Matrix& factor, const lighting::ReflectedLobe& lobe,
                  double cosine) {
  const glm::dvec3 mirrored(std::sqrt(1.0 - cosine * cosine), 0.0, cosine);
  Vector right{}, open{};
  for (const Node& node : nodes) {
    const double density = lobe.density(static_cast<float>(glm::dot(node.direction, mirrored)));
    for (std::size_t i = 0; i < kCount; ++i) {
      right[i] += node.solid_angle * density * node.functions[i];
      open[i] += node.solid_angle * node.functions[i];
    }
  }
  Vector b = solve(factor, right);
  double all = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) all += b[i] * open[i];
  for (double& value : b) value /= all;
  return b;
}

// Returns the inverse of bundle::angleAxis.
double cosineAt(double axis) {
  const double root = 1.0 - axis * axis;
  return 1.0 - root * root;
}

}  // namespace

SeenKernel makeSeenKernel() {
  const std::vector<Node> nodes = quadrature();
  const Matrix factor = factorOf(normalMatrix(nodes));
  const sh::ZonalFactors factors(kSeenKernelBands, /*isotropic=*/true);
  SeenKernel kernel;
  kernel.texels.assign(std::size_t{kSeenLayers} * kSeenRoughnesses * kSeenCosines, glm::vec4(0.0f));
  for (std::uint32_t r = 0; r < kSeenRoughnesses; ++r) {
    const lighting::ReflectedLobe lobe = lighting::makeReflectedLobe(
        std::max(static_cast<float>(r) / static_cast<float>(kSeenRoughnesses - 1), kLeastRoughness));
    for (std::uint32_t c = 0; c < kSeenCosines; ++c) {
      const Vector b = weightsFor(nodes, factor, lobe, cosineAt(static_cast<double>(c) / (kSeenCosines - 1)));
      std::array<float, kCount> coefficients, weights;
      std::ranges::transform(b, coefficients.begin(), [](double value) { return static_cast<float>(value); });
      factors.factor(coefficients, weights);
      for (std::size_t i = 0; i < kCount; ++i)
        kernel.texels[((i / 4) * kSeenRoughnesses + r) * kSeenCosines + c][static_cast<int>(i % 4)] =
            weights[i];
    }
  }
  return kernel;
}

namespace {

// Returns how much of a group's transfer has arrived, as a number that changes when it pays to look again:
// when a cell becomes usable, and when it is complete.
std::uint64_t arrivedOf(const streaming::Residency& residency, const streaming::ResidentGroup& group) {
  std::uint64_t arrived = 0;
  for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c) {
    const streaming::ResidentCell& cell = residency.cells()[c];
    if (cell.domain != transfer::Domain::Vertex || cell.matrices() || !cell.usable()) continue;
    const bool whole = std::ranges::all_of(cell.transfers, [](const streaming::ResidentTransfer& transfer) {
      return transfer.planes_resident == transfer.planes.size();
    });
    arrived += whole ? 2 : 1;
  }
  return arrived;
}

gpu::Texture kernelTexture() {
  const SeenKernel kernel = makeSeenKernel();
  gpu::Texture texture(
      "seen sky kernel",
      {.format = GL_RGBA32F, .width = kSeenCosines, .height = kSeenRoughnesses, .layers = kSeenLayers});
  glTextureSubImage3D(texture.id(), 0, 0, 0, 0, kSeenCosines, kSeenRoughnesses, kSeenLayers, GL_RGBA,
                      GL_FLOAT, kernel.texels.data());
  texture.interpolate();
  return texture;
}

std::uint32_t wordsOf(std::uint32_t outputs) {
  return transfer::kSeenWords * outputs;
}

// Returns the record of a draw whose group's samples begin at word 0.
transfer::SeenDraw recordOf(const streaming::ResidentDraw& draw, const streaming::ResidentGroup& group,
                            const streaming::ResidentMesh& mesh) {
  const streaming::SampleStretch stretch = group.stretchOf(draw.form());
  transfer::SeenDraw record{.group_from_mesh_normal = {},
                            .vertex_count = mesh.vertex_count,
                            .normals_word = mesh.normals_word,
                            .rows_word = draw.rows.word(),
                            .row_entries = draw.row_entries,
                            .first_sample = stretch.first_sample,
                            .samples_word = wordsOf(1) * stretch.first_sample,
                            .seen_word = draw.seenWord(mesh),
                            .pad = 0};
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      record.group_from_mesh_normal[4 * column + row] = draw.group_from_mesh_normal[column][row];
  return record;
}

}  // namespace

// The tables that the kernels read. Samples of all groups with draws to write lie one after the other: those
// with one output, then the normal-mapped ones.
struct SeenSky::Tables {
  TransferTable transfers;
  std::vector<transfer::SeenCell> cells;
  std::vector<transfer::SeenDraw> draws;
  std::uint64_t words = 0;  // of all samples
};

SeenSky::SeenSky()
    : cells_("seen sky cells"),
      transfers_("seen sky transfers"),
      places_("seen sky places"),
      draws_("seen sky draws"),
      samples_work_("seen sky samples work"),
      vertices_work_("seen sky vertices work") {}

void SeenSky::bindKernel(GLuint unit) const {
  kernel_.bind(unit);
  glBindSampler(unit, 0);  // the texture's own sampling is used
}

Result<void> SeenSky::update(streaming::Residency& residency, const lighting::GroupLights& lights,
                             gpu::Counters& counters) {
  if (!residency_changed_.renew(residency.version())) return {};
  if (draws_changed_.follow(residency.draws(), &streaming::ResidentDraw::id)) ++version_;
  if (!collect(residency)) return {};
  if (!kernel_) kernel_ = kernelTexture();
  const Tables tables = describe(residency, lights);
  cells_.assign(std::span<const transfer::SeenCell>(tables.cells));
  transfers_.assign(std::span<const transfer::TransferRecord>(tables.transfers.transfers));
  places_.assign(std::span<const std::uint32_t>(tables.transfers.places));
  draws_.assign(std::span<const transfer::SeenDraw>(tables.draws));
  const gpu::Buffer samples("seen sky samples", 4 * tables.words, gpu::WrittenBy::Gpu);
  glClearNamedBufferData(samples.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  samples.bindStorage(transfer::kBindSeenSamples);
  ++version_;
  return run(residency, counters);
}

bool SeenSky::collect(const streaming::Residency& residency) {
  due_.clear();
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    if (!draw.layered || !draw.radiance || !draw.rows) continue;
    const std::uint64_t arrived = arrivedOf(residency, residency.groups()[draw.group]);
    if (arrived > 0 && draws_changed_[i].renew(draw.version, arrived)) due_.push_back(i);
  }
  return !due_.empty();
}

SeenSky::Tables SeenSky::describe(const streaming::Residency& residency,
                                  const lighting::GroupLights& lights) {
  Tables tables;
  samples_work_.clear();
  vertices_work_.clear();
  std::set<std::uint32_t> groups;
  for (const std::uint32_t i : due_) groups.insert(residency.draws()[i].group);
  std::map<std::uint32_t, std::uint32_t> word_of;  // of each group's first sample
  for (const std::uint32_t g : groups) {
    const streaming::ResidentGroup& group = residency.groups()[g];
    word_of[g] = static_cast<std::uint32_t>(tables.words);
    for (std::uint32_t c = group.first_cell; c < group.first_cell + group.cell_count; ++c) {
      const streaming::ResidentCell& cell = residency.cells()[c];
      if (cell.domain != transfer::Domain::Vertex || cell.matrices()) continue;
      const auto first_word = static_cast<std::uint32_t>(tables.words);
      tables.words += std::uint64_t{wordsOf(cell.outputs)} * cell.sample_count;
      tables.transfers.add(cell, lights, TransferMode::Shadowed);
      const TransferTable::Cell range = tables.transfers.cells.back();
      for (std::uint32_t t = range.first; cell.usable() && t < range.first + range.count; ++t) {
        if (tables.transfers.transfers[t].order == 0) continue;  // the group's own lights
        samples_work_.add({cell.outputs, cell.block.page}, static_cast<std::uint32_t>(tables.cells.size()),
                          cell.sample_count, transfer::kWorkGroupSize);
        tables.cells.push_back({.transfer = t, .first_word = first_word});
      }
    }
  }
  for (const std::uint32_t i : due_) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    const streaming::ResidentGroup& group = residency.groups()[draw.group];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    transfer::SeenDraw record = recordOf(draw, group, mesh);
    record.samples_word += word_of[draw.group];
    vertices_work_.add({draw.outputs, draw.rows.page, mesh.block.page, draw.radiance.page},
                       static_cast<std::uint32_t>(tables.draws.size()), mesh.vertex_count,
                       transfer::kWorkGroupSize);
    tables.draws.push_back(record);
  }
  return tables;
}

Result<void> SeenSky::run(streaming::Residency& residency, gpu::Counters& counters) {
  cells_.bindStorage(transfer::kBindSeenCells);
  transfers_.bindStorage(transfer::kBindTransfers);
  places_.bindStorage(transfer::kBindPlaces);
  Result<void> done = evaluate::run(samples_work_, counters, [&](const gpu::BatchKey& key) {
    residency.transfer().page(key[1]).bindStorage(transfer::kBindTransfer);
    return kernels_.use("seen_sky.comp",
                        {{"LAMBENT_SAMPLES", "1"}, {"LAMBENT_OUTPUTS", std::to_string(key[0])}});
  });
  if (!done) return done;
  draws_.bindStorage(transfer::kBindSeenDraws);
  return evaluate::run(vertices_work_, counters, [&](const gpu::BatchKey& key) {
    residency.rows().page(key[1]).bindStorage(transfer::kBindSeenRows);
    residency.geometry().page(key[2]).bindStorage(transfer::kBindSeenGeometry);
    residency.radiance().page(key[3]).bindStorage(transfer::kBindSeenVertices);
    return kernels_.use("seen_sky.comp", {{"LAMBENT_OUTPUTS", std::to_string(key[0])}});
  });
}

}  // namespace lambent::evaluate
