#include "baker/refine/add_wedges.hpp"

#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include "baker/refine/wedges.hpp"
#include "baker/transport/vertex_key.hpp"

namespace lambent::baker {

namespace {

// A FanSource is a primitive whose vertices may be split into fans.
struct FanSource {
  std::size_t mesh, primitive, group, draw;
  std::span<const std::uint32_t> faces;  // index in the mesh of each triangle of the draw
};

// Lists primitives that are drawn only once (front and back), since fans would cost transfer at every place,
// in groups that were measured.
std::vector<FanSource> fanSources(const MeasuredGroups& measured) {
  const auto& [groups, geometries, refiners] = measured;
  std::map<std::pair<std::size_t, std::size_t>, int> fronts;
  for (const RigidGroup& group : groups)
    for (const PlannedDraw& draw : group.draws)
      if (!draw.back) ++fronts[{draw.mesh, draw.primitive}];
  std::vector<FanSource> sources;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t d = 0; d < groups[g].draws.size(); ++d) {
      if (!refiners[g].measured()) continue;
      const PlannedDraw& draw = groups[g].draws[d];
      const DrawGeometry& drawn = geometries[g].draws[d];
      if (draw.back || fronts[{draw.mesh, draw.primitive}] != 1) continue;
      if (drawn.kind != SampleKind::Glossy) continue;
      sources.push_back(
          {draw.mesh, draw.primitive, g, d,
           std::span(geometries[g].mesh_faces).subspan(drawn.first_triangle, drawn.triangle_count)});
    }
  return sources;
}

}  // namespace

std::optional<std::size_t> addWedges(const MeasuredGroups& measured, const WedgeLimits& limits,
                                     std::vector<std::vector<bundle::MeshData>>& meshes,
                                     const std::stop_token& stop) {
  const auto& geometries = measured.geometries;
  const std::vector<FanSource> sources = fanSources(measured);
  FaceLacks lacks{.width = GroupRefiner::kLackValues};
  std::size_t stars = 0;
  for (const FanSource& source : sources) {
    measured.refiners[source.group].addLacks(geometries[source.group].draws[source.draw], lacks);
    const bundle::MeshData& mesh = meshes[source.mesh][source.primitive];
    std::unordered_map<VertexKey, std::uint32_t, VertexKeyHash> known;
    for (const std::uint32_t face : source.faces)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t v = mesh.indices[3 * face + c];
        const auto [entry, is_new] =
            known.try_emplace(vertexKey(mesh.positions[v], mesh.normals[v], SampleKind::Diffuse),
                              static_cast<std::uint32_t>(stars));
        if (is_new) ++stars;
        lacks.corner_stars.push_back(entry->second);
      }
  }
  double area = 0.0;
  for (const double a : lacks.areas) area += a;
  const Wedges fans =
      chooseWedges(std::move(lacks), stars, limits.bound * limits.bound * area, limits.most, stop);
  if (stop.stop_requested()) return std::nullopt;
  std::size_t next = 0;
  for (const FanSource& source : sources) {
    bundle::MeshData& mesh = meshes[source.mesh][source.primitive];
    std::vector<std::uint8_t> of_corner(mesh.indices.size(), 0);
    for (const std::uint32_t face : source.faces)
      for (std::size_t c = 0; c < 3; ++c) of_corner[3 * face + c] = fans.of_corner[next++];
    splitIntoWedges(mesh, of_corner);
  }
  return fans.added;
}

}  // namespace lambent::baker
