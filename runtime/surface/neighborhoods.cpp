#include "runtime/surface/neighborhoods.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/draws/surface_shared.h"
#include "runtime/scene/bounds.hpp"

namespace lambent::frame {

using effects::neighborhood::Arrival;
using effects::neighborhood::Grid;
using effects::neighborhood::Receiver;

namespace {

constexpr SurfaceFunction kPixelChange[] = {
    {SurfaceHook::Received, CalledBy::Diffuse, "neighborhood_surface.glsl", "addNeighborhoods"},
    {SurfaceHook::Received, CalledBy::Glossy, "neighborhood_surface.glsl", "addReflectedNeighborhoods"}};
constexpr SurfaceFunction kVertexChange[] = {
    {SurfaceHook::Vertex, CalledBy::Diffuse, "neighborhood_vertex.glsl", "addVertexChange"}};

double scaleOf(const glm::mat4& matrix) {
  return std::cbrt(std::abs(glm::determinant(glm::dmat3(glm::mat3(matrix)))));
}

// Returns whether a draw receives from the grid at its vertices, by the rule at the head of
// neighborhoods.hpp. Between the vertices of coarser meshes the grid's detail would be lost.
bool byTransfer(const World& world, std::uint32_t draw, const Grid& grid) {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  const std::uint32_t order = world.residency().groups()[resident.group].order;
  if (grid.place.outputs != order * order ||
      !effects::neighborhood::hasTransfer(world.residency(), draw, order))
    return false;
  const glm::dvec3 spacing =
      glm::dvec3(grid.points.bounds_max - grid.points.bounds_min) / glm::dvec3(grid.points.size - 1u);
  const double apart = (spacing.x + spacing.y + spacing.z) / 3.0 * scaleOf(world.worldFromGroup(grid.group));
  const double edge =
      double{world.residency().meshes()[resident.mesh].mean_edge} * scaleOf(world.worldFromMesh(draw));
  return edge <= apart;
}

// Returns the matrix from the position that the surface pass has per pixel of this draw (surface.vert). This
// is the mesh's own position or, with normal maps, the one turned by the matrix that surface_record.cpp
// makes.
glm::dmat4 worldFromPosition(const World& world, std::size_t draw, const SurfaceDraw& record) {
  const glm::dmat4 world_from_mesh(world.worldFromMesh(draw));
  if (!normalMapped(world, draw)) return world_from_mesh;
  return world_from_mesh * glm::dmat4(glm::inverse(glm::dmat3(glm::mat3(record.group_from_mesh))));
}

}  // namespace

Neighborhoods::Neighborhoods() : receivers_table_("neighborhood receivers"), arrivals_table_("arrivals") {}

void Neighborhoods::noticeGrids(const World& world) {
  if (!structure_changed_.renew(world.residency().structureVersion())) return;
  const auto& groups = world.residency().groups();
  std::map<std::uint64_t, std::uint32_t> now;  // keyed by group key
  std::vector<Grid> grids;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    now[world.keyOf(g)] = g;
    if (const auto& points = world.describedGroup(g).neighborhood)
      grids.push_back({.group = g, .id = groups[g].id, .key = world.keyOf(g), .points = *points});
  }
  effect_.setGrids(std::move(grids), world.residency());
  GridPairs pairs;
  for (const auto& [body, receiver] : pairs_) {
    const auto body_now = now.find(group_keys_[body]), receiver_now = now.find(group_keys_[receiver]);
    if (body_now != now.end() && receiver_now != now.end())
      pairs.insert({body_now->second, receiver_now->second});
  }
  pairs_ = std::move(pairs);
  receivers_changed_.forget();
  group_keys_.clear();
  for (std::uint32_t g = 0; g < groups.size(); ++g) group_keys_.push_back(world.keyOf(g));
}

std::size_t Neighborhoods::readyGrids() const {
  return static_cast<std::size_t>(std::ranges::count_if(effect_.grids(), &Grid::ready));
}

PlannedGrids Neighborhoods::gridsNow(const World& world, bool on) {
  noticeGrids(world);
  // Changes of carriers that result from motion fade. Those that result from what arrives, or from a setting,
  // are immediate.
  const bool fades = ready_when_chosen_ == readyGrids() && on == on_;
  on_ = on;
  ready_when_chosen_ = readyGrids();
  return {.grids = effect_.grids(), .before = &pairs_, .on = on, .fades = fades};
}

void Neighborhoods::takePairs(const LightPlan& plan) {
  grids_ready_ = plan.grids_ready;
  if (plan.grid_pairs != pairs_) receivers_changed_.forget();
  pairs_ = plan.grid_pairs;
}

Result<void> Neighborhoods::update(World& world, const lighting::GroupLights& lights,
                                   const evaluate::Samples& samples, evaluate::TransferMode mode,
                                   gpu::Counters& counters) {
  if (Result<void> done = effect_.update(world.residency(), lights, samples, counters); !done) return done;
  const bool changed = receivers_changed_.renew(world.residency().version(), world.transformsVersion(),
                                                effect_.version(), mode, lights.hasKeys());
  if (changed) findReceivers(world, mode, lights.hasKeys());
  if (Result<void> done =
          vertex_receivers_.update(world.residency(), lights, mode, effect_, vertex_draws_, counters);
      !done)
    return done;
  if (changed) {
    takeReceivers();
    receivers_table_.assign(receivers_, counters);
    arrivals_table_.assign(arrivals_, counters);
  }
  return {};
}

std::array<NamedCount, 9> Neighborhoods::counts() const {
  const auto receivers = static_cast<std::size_t>(
      std::ranges::count_if(receivers_, [](const Receiver& receiver) { return receiver.count > 0; }));
  return {{{"neighborhood_grids", effect_.grids().size()},
           {"neighborhood_grids_ready", grids_ready_},
           {"neighborhood_grids_written", effect_.gridsWrittenLast()},
           {"neighborhood_pairs", pairs_.size()},
           {"neighborhood_receivers", receivers},
           {"neighborhood_arrivals", arrivals_.size()},
           {"neighborhood_vertex_receivers", vertex_draws_.size()},
           {"neighborhood_vertex_receivers_shaded", vertex_receivers_.drawsShadedLast()},
           {"neighborhood_arrivals_left_out", left_out_}}};
}

// Finds which draws receive from which grids, and how. Draws that receive at their vertices have no memory
// for it yet.
void Neighborhoods::findReceivers(const World& world, evaluate::TransferMode mode, bool keys) {
  const auto& draws = world.residency().draws();
  found_.assign(draws.size(),
                {.first = 0, .count = 0, .change_word = effects::neighborhood::kNoChange, .pad = 0});
  vertex_draws_.clear();
  arrivals_.clear();
  left_out_ = 0;
  struct Found {
    double distance = 0.0;
    Arrival arrival{};
  };
  for (std::uint32_t d = 0; d < draws.size() && !pairs_.empty(); ++d) {
    const streaming::ResidentDraw& draw = draws[d];
    if (!world.residency().meshes()[draw.mesh].block) continue;
    const bundle::Draw& described = world.description(draw.bundle).draws[draw.index];
    const bundle::Primitive& primitive =
        world.description(draw.bundle).meshes[described.mesh].primitives[described.primitive];
    const scene::Box bounds{primitive.bounds_min, primitive.bounds_max};
    std::vector<Found> found;
    effects::neighborhood::VertexDraw at_vertices{.draw = d, .from = {}};
    std::optional<glm::dmat4> world_from_position;
    for (std::uint32_t g = 0; g < effect_.grids().size(); ++g) {
      const Grid& grid = effect_.grids()[g];
      if (!grid.ready || !pairs_.contains({grid.group, draw.group})) continue;
      const glm::mat4 world_from_body = world.worldFromGroup(grid.group),
                      world_from_mesh = world.worldFromMesh(d);
      if (!meet({grid.points.bounds_min, grid.points.bounds_max}, world_from_body, bounds, world_from_mesh))
        continue;
      const glm::dvec3 low(grid.points.bounds_min), size = glm::dvec3(grid.points.bounds_max) - low;
      glm::dmat4 grid_from_body(1.0);
      for (int axis = 0; axis < 3; ++axis) {
        grid_from_body[axis][axis] = (static_cast<double>(grid.points.size[axis]) - 1.0) / size[axis];
        grid_from_body[3][axis] = -low[axis] * grid_from_body[axis][axis];
      }
      if (!world_from_position) world_from_position = worldFromPosition(world, d, describe(world, d));
      const glm::dmat4 grid_from_position =
          grid_from_body * glm::inverse(glm::dmat4(world_from_body)) * *world_from_position;
      if (!isFinite(grid_from_position)) continue;  // something is flattened
      const glm::quat body_from_group =
          glm::conjugate(world.rotationOf(grid.group)) * world.rotationOf(draw.group);
      const glm::mat3x4 to_grid(glm::mat4(glm::transpose(grid_from_position)));
      // Volumes have no shadow maps, so key lights behind them are scaled per pixel, where they are known.
      const bool whole = keys && world.residency().groups()[grid.group].volume >= 0;
      if (!whole && mode != evaluate::TransferMode::Unshadowed && byTransfer(world, d, grid)) {
        at_vertices.from.push_back(
            {.grid = g, .grid_from_position = to_grid, .group_from_body = glm::conjugate(body_from_group)});
        continue;
      }
      const glm::dvec3 middle(world_from_body *
                              glm::vec4(0.5f * (grid.points.bounds_min + grid.points.bounds_max), 1.0f));
      const glm::dvec3 receiver(world_from_mesh * glm::vec4(bounds.center(), 1.0f));
      found.push_back(
          {.distance = glm::distance(middle, receiver),
           .arrival = {.grid_from_position = to_grid,
                       .body_from_group = glm::mat3x4(glm::transpose(glm::mat3_cast(body_from_group))),
                       .grid = grid.place,
                       .whole = whole ? 1u : 0u,
                       .pad = {}}});
    }
    std::ranges::stable_sort(found, {}, &Found::distance);
    if (found.size() > kMaxArrivals) {
      left_out_ += static_cast<std::uint32_t>(found.size()) - kMaxArrivals;
      found.resize(kMaxArrivals);
    }
    found_[d].first = static_cast<std::uint32_t>(arrivals_.size());
    found_[d].count = static_cast<std::uint32_t>(found.size());
    for (const Found& one : found) arrivals_.push_back(one.arrival);
    if (!at_vertices.from.empty()) vertex_draws_.push_back(std::move(at_vertices));
  }
}

void Neighborhoods::takeReceivers() {
  for (const effects::neighborhood::VertexDraw& draw : vertex_draws_)
    found_[draw.draw].change_word = vertex_receivers_.changeWord(draw.draw);
  const auto sameKind = [](const Receiver& a, const Receiver& b) {
    return (a.count > 0) == (b.count > 0) && a.change_word == b.change_word;
  };
  if (!std::ranges::equal(found_, receivers_, sameKind)) ++version_;
  receivers_ = found_;
}

void Neighborhoods::bind() const {
  receivers_table_.bindStorage(effects::neighborhood::kBindReceivers);
  arrivals_table_.bindStorage(effects::neighborhood::kBindArrivals);
  effect_.bind();
}

void Neighborhoods::bindVertices() const {
  vertex_receivers_.bindStorage(kBindRadianceChange);
}

NeighborhoodModule::NeighborhoodModule(const Neighborhoods& neighborhoods, const bool& shown,
                                       bool at_vertices)
    : SurfaceModule(at_vertices ? std::span<const SurfaceFunction>(kVertexChange) : kPixelChange),
      neighborhoods_(neighborhoods),
      on_(shown),
      at_vertices_(at_vertices) {}

}  // namespace lambent::frame
