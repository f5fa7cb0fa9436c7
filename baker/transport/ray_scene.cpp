#include "baker/transport/ray_scene.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <limits>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/embree/embree.hpp"
#include "baker/transport/group_geometry.hpp"

namespace lambent::baker {

namespace {

// A MaskedDraw says where a cut-out surface (alphaMode MASK) lets rays through: texture, factor and vertex
// colour are compared with the cutoff.
struct MaskedDraw {
  std::shared_ptr<const DecodedImage> image;  // null: only factor and vertex alpha count
  gltf::Sampler sampler;
  float factor = 1.0f, cutoff = 0.5f;
  std::vector<glm::uvec3> triangles;
  std::vector<glm::vec2> texcoords;
  std::vector<glm::vec4> colors;

  bool blocks(std::uint32_t triangle, float u, float v) const {
    const glm::uvec3 t = triangles[triangle];
    const float w = 1.0f - u - v;
    const glm::vec2 uv = w * texcoords[t.x] + u * texcoords[t.y] + v * texcoords[t.z];
    const float vertex_alpha = w * colors[t.x].w + u * colors[t.y].w + v * colors[t.z].w;
    const float texture_alpha = image ? sampleImage(*image, sampler, uv).w : 1.0f;
    return texture_alpha * factor * vertex_alpha >= cutoff;
  }
};

void filterMasked(const RTCFilterFunctionNArguments* args) {
  const auto& draw = *static_cast<const MaskedDraw*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const float u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
    if (!draw.blocks(RTCHitN_primID(args->hit, args->N, i), u, v)) args->valid[i] = 0;
  }
}

// MetFace is a face of a pane as Embree reports it.
struct MetFace {
  std::uint32_t surface, triangle;
  float u, v, distance;
  bool behind;

  // A ray may meet both triangles at an edge that they share.
  bool isSame(const MetFace& before) const {
    return surface == before.surface && behind == before.behind &&
           distance - before.distance <= 1e-6f * distance;
  }
};

// Adds every face that a ray meets to the query's list, and lets the ray go on.
void collectFaces(const RTCFilterFunctionNArguments* args) {
  auto& faces = *static_cast<std::vector<MetFace>*>(RayQuery::userOf(*args));
  const unsigned n = args->N;
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] != -1) continue;
    const float along = RTCRayN_dir_x(args->ray, n, i) * RTCHitN_Ng_x(args->hit, n, i) +
                        RTCRayN_dir_y(args->ray, n, i) * RTCHitN_Ng_y(args->hit, n, i) +
                        RTCRayN_dir_z(args->ray, n, i) * RTCHitN_Ng_z(args->hit, n, i);
    faces.push_back({.surface = RTCHitN_geomID(args->hit, n, i),
                     .triangle = RTCHitN_primID(args->hit, n, i),
                     .u = RTCHitN_u(args->hit, n, i),
                     .v = RTCHitN_v(args->hit, n, i),
                     .distance = RTCRayN_tfar(args->ray, n, i),
                     .behind = along > 0.0f});
    args->valid[i] = 0;
  }
}

struct Packet {
  alignas(64) RTCRayHit16 rays;
  PacketLanes lanes;
};

// Returns a mask in which bit k is set if lane k is to be traced.
std::uint32_t validMask(const PacketLanes& lanes) {
  std::uint32_t mask = 0;
  for (std::size_t k = 0; k < kPacketWidth; ++k) mask |= lanes.valid[k] ? 1u << k : 0u;
  return mask;
}

// Fills a packet with the first segments of a list. Lanes beyond its end are not valid.
void fillSegments(std::span<const RaySegment> segments, RTCRay16& rays,
                  std::array<int, kPacketWidth>& valid) {
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    valid[k] = k < segments.size() ? -1 : 0;
    const auto& [origin, direction, length] = segments[std::min(k, segments.size() - 1)];
    rays.org_x[k] = origin.x, rays.org_y[k] = origin.y, rays.org_z[k] = origin.z;
    rays.dir_x[k] = direction.x, rays.dir_y[k] = direction.y, rays.dir_z[k] = direction.z;
    rays.tnear[k] = 0.0f, rays.tfar[k] = length;
    rays.time[k] = 0.0f, rays.mask[k] = ~0u, rays.flags[k] = 0;
  }
}

void forgetHits(RTCRayHit16& rays) {
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    rays.ray.tfar[k] = std::numeric_limits<float>::infinity();
    rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
  }
}

}  // namespace

// SurfaceSides maps an Embree geometry to its triangles in GroupGeometry.
struct SurfaceSides {
  std::uint32_t front = 0, back = 0;  // first triangles of both sides
  bool double_sided = false;
};

namespace {

// Returns the face that lane k of a traced packet hits.
FirstHit faceOf(const RTCRayHit16& rays, std::size_t k, const std::vector<SurfaceSides>& surfaces) {
  const RTCRay16& ray = rays.ray;
  const RTCHit16& hit = rays.hit;
  if (hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) return {};
  const SurfaceSides& sides = surfaces[hit.geomID[k]];
  const float along = ray.dir_x[k] * hit.Ng_x[k] + ray.dir_y[k] * hit.Ng_y[k] + ray.dir_z[k] * hit.Ng_z[k];
  const bool behind = along > 0.0f, other_side = behind && sides.double_sided;
  FirstHit out{.triangle = (other_side ? sides.back : sides.front) + hit.primID[k],
               .u = hit.u[k],
               .v = hit.v[k],
               .distance = ray.tfar[k],
               .back = behind && !sides.double_sided};
  if (other_side) std::swap(out.u, out.v);  // corners 1 and 2 of a back are swapped
  return out;
}

}  // namespace

struct RayScene::State {
  EmbreeDevice device;
  EmbreeScene scene, panes;                         // panes is null if there are none
  std::vector<std::unique_ptr<MaskedDraw>> masked;  // user data of geometries, which must stay in place
  std::vector<SurfaceSides> surfaces;               // by geometry id, which both scenes share
};

RayScene::RayScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

namespace {

Result<std::unique_ptr<MaskedDraw>> maskedDraw(const GroupGeometry& group, const DrawGeometry& draw,
                                               const Scene& scene, DecodedImages& images) {
  const gltf::Material& material = scene.materials[static_cast<std::size_t>(draw.material)];
  const std::int32_t texture = material.base_color_texture.texture;
  auto masked = std::make_unique<MaskedDraw>();
  masked->factor = material.base_color.w;
  masked->cutoff = material.alpha_cutoff;
  auto image = images.ofTexture(texture);
  if (!image) return failAgain(image.error());
  masked->image = std::move(*image);
  if (masked->image) masked->sampler = scene.textures[static_cast<std::size_t>(texture)].sampler;
  for (std::uint32_t t = 0; t < draw.triangle_count; ++t)
    masked->triangles.push_back(group.triangles[draw.first_triangle + t] - draw.first_vertex);
  const auto first = static_cast<std::ptrdiff_t>(draw.first_vertex),
             count = static_cast<std::ptrdiff_t>(draw.vertex_count);
  masked->texcoords.assign(group.texcoords.begin() + first, group.texcoords.begin() + first + count);
  masked->colors.assign(group.colors.begin() + first, group.colors.begin() + first + count);
  return masked;
}

}  // namespace

Result<RayScene> RayScene::build(const GroupGeometry& group, const Scene& scene, DecodedImages& images) {
  auto state = std::make_unique<State>();
  auto device = newEmbreeDevice();
  if (!device) return failAgain(std::move(device.error()));
  state->device = std::move(*device);
  state->scene.reset(rtcNewScene(state->device.get()));
  rtcSetSceneBuildQuality(state->scene.get(), RTC_BUILD_QUALITY_HIGH);

  const std::vector<std::uint8_t> flipped_faces = findFlippedFaces(group);
  for (std::size_t d = 0; d < group.draws.size(); ++d) {
    const DrawGeometry& draw = group.draws[d];
    const gltf::Material* material =
        draw.material < 0 ? nullptr : &scene.materials[static_cast<std::size_t>(draw.material)];
    if (draw.back || draw.triangle_count == 0) continue;  // the front's triangles stand for both sides
    if (material && material->alpha_mode == gltf::AlphaMode::Blend) continue;
    const bool pane = material && material->transmits();
    if (pane && !state->panes) {
      // Spatial splits (HIGH) would report a triangle's hit more than once.
      state->panes.reset(rtcNewScene(state->device.get()));
      rtcSetSceneFlags(state->panes.get(), kSceneFlagQueryFilter);
    }
    const auto corners = [&](std::uint32_t t) {
      return !pane && flipped_faces[draw.first_triangle + t] != 0
                 ? glm::uvec3(0)  // a degenerate triangle, which no ray hits
                 : group.triangles[draw.first_triangle + t] - draw.first_vertex;
    };
    RTCGeometry geometry = newTriangles(
        state->device.get(), std::span(group.positions).subspan(draw.first_vertex, draw.vertex_count),
        draw.triangle_count, corners);
    if (!geometry) return fail("Embree", "has not enough memory for the scene", "bake it in parts");
    if (material && material->alpha_mode == gltf::AlphaMode::Mask) {
      auto masked = maskedDraw(group, draw, scene, images);
      if (!masked) {
        rtcReleaseGeometry(geometry);
        return failAgain(masked.error());
      }
      state->masked.push_back(std::move(*masked));
      rtcSetGeometryUserData(geometry, state->masked.back().get());
      rtcSetGeometryOccludedFilterFunction(geometry, filterMasked);
      rtcSetGeometryIntersectFilterFunction(geometry, filterMasked);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(pane ? state->panes.get() : state->scene.get(), geometry,
                          static_cast<unsigned>(state->surfaces.size()));
    rtcReleaseGeometry(geometry);  // the scene keeps its own reference
    SurfaceSides sides{.front = draw.first_triangle, .back = 0, .double_sided = false};
    if (d + 1 < group.draws.size() && group.draws[d + 1].back)
      sides.back = group.draws[d + 1].first_triangle, sides.double_sided = true;
    state->surfaces.push_back(sides);
  }
  rtcCommitScene(state->scene.get());
  if (state->panes) rtcCommitScene(state->panes.get());
  if (rtcGetDeviceError(state->device.get()) != RTC_ERROR_NONE)
    return fail("Embree", "could not build its hierarchy over the scene", "check the memory that is free");
  return RayScene(std::move(state));
}

void blockBelowHorizons(const SampleRays& rays, std::span<std::uint16_t> masks) {
  const OriginDealer dealer(rays.origins);
  Packet packet;
  for (std::size_t p = 0; p < masks.size(); ++p) {
    fillPacket(p, rays, dealer, packet.rays.ray, packet.lanes);
    masks[p] = static_cast<std::uint16_t>(~validMask(packet.lanes));
  }
}

std::uint32_t RayScene::walk(const SampleRays& rays, bool mostly_blocked, std::span<std::uint16_t> masks,
                             std::vector<RayHit>* hits) const {
  assert(!rays.origins.empty() && masks.size() == rays.table.packets());
  const FlushDenormals flush;
  const OriginDealer dealer(rays.origins);
  Packet packet;
  // Embree's path for incoherent rays is the faster one for occlusion, although these rays are coherent.
  RayQuery any(RayOrder::Incoherent), closest(RayOrder::Coherent);
  std::uint32_t traced = 0;
  for (std::size_t p = 0; p < masks.size(); ++p) {
    fillPacket(p, rays, dealer, packet.rays.ray, packet.lanes);
    const std::uint32_t valid = validMask(packet.lanes);
    traced += static_cast<std::uint32_t>(std::popcount(valid));
    masks[p] = static_cast<std::uint16_t>(~valid);
    // If few rays hit, it is faster to test occlusion first and then find the hits of blocked rays only.
    if (!mostly_blocked) {
      any.occluded(state_->scene.get(), packet.lanes.valid.data(), packet.rays.ray);
      std::uint32_t blocked = 0;
      for (std::size_t k = 0; k < kPacketWidth; ++k) {
        const bool hit = packet.rays.ray.tfar[k] < 0.0f;  // Embree sets -inf where something is in the way
        blocked |= hit ? 1u << k : 0u;
        packet.lanes.valid[k] = hit ? -1 : 0;
      }
      masks[p] = static_cast<std::uint16_t>(masks[p] | blocked);
      if (blocked == 0 || !hits) continue;
    }
    forgetHits(packet.rays);
    closest.intersect(state_->scene.get(), packet.lanes.valid.data(), packet.rays);
    for (std::size_t k = 0; k < kPacketWidth; ++k) {
      if (!packet.lanes.valid[k]) continue;
      const FirstHit met = faceOf(packet.rays, k, state_->surfaces);
      if (!met.any()) continue;
      masks[p] = static_cast<std::uint16_t>(masks[p] | 1u << k);
      if (!met.back)
        hits->push_back({.ray = static_cast<std::uint32_t>(p * kPacketWidth + k),
                         .triangle = met.triangle,
                         .u = met.u,
                         .v = met.v,
                         .distance = met.distance});
    }
  }
  return traced;
}

void RayScene::occluded(std::span<const RaySegment> segments, std::span<std::uint8_t> blocked) const {
  assert(blocked.size() == segments.size());
  const FlushDenormals flush;
  alignas(64) RTCRay16 rays;
  alignas(64) std::array<int, kPacketWidth> valid;
  RayQuery query(RayOrder::Incoherent);
  for (std::size_t first = 0; first < segments.size(); first += kPacketWidth) {
    fillSegments(segments.subspan(first), rays, valid);
    query.occluded(state_->scene.get(), valid.data(), rays);
    for (std::size_t k = 0; k < kPacketWidth && first + k < segments.size(); ++k)
      blocked[first + k] = rays.tfar[k] < 0.0f ? 1 : 0;
  }
}

void RayScene::firstHits(std::span<const RaySegment> rays, std::span<FirstHit> hits) const {
  assert(hits.size() == rays.size());
  const FlushDenormals flush;
  Packet packet;
  RayQuery query(RayOrder::Coherent);
  for (std::size_t first = 0; first < rays.size(); first += kPacketWidth) {
    forgetHits(packet.rays);
    fillSegments(rays.subspan(first), packet.rays.ray, packet.lanes.valid);
    query.intersect(state_->scene.get(), packet.lanes.valid.data(), packet.rays);
    for (std::size_t k = 0; k < kPacketWidth && first + k < rays.size(); ++k)
      hits[first + k] = faceOf(packet.rays, k, state_->surfaces);
  }
}

bool RayScene::hasPanes() const {
  return state_->panes != nullptr;
}

void RayScene::panesOn(std::span<const RaySegment> rays, std::vector<PaneHit>& hits) const {
  hits.clear();
  if (!hasPanes()) return;
  const FlushDenormals flush;
  alignas(64) RTCRay16 packet;
  alignas(64) std::array<int, kPacketWidth> valid;
  std::vector<MetFace> faces;
  RayQuery any(RayOrder::Incoherent), every(RayOrder::Incoherent, collectFaces, &faces);
  for (std::size_t first = 0; first < rays.size(); first += kPacketWidth) {
    fillSegments(rays.subspan(first), packet, valid);
    any.occluded(state_->panes.get(), valid.data(), packet);
    for (std::size_t k = 0; k < kPacketWidth && first + k < rays.size(); ++k) {
      if (!(packet.tfar[k] < 0.0f)) continue;
      const RaySegment& ray = rays[first + k];
      faces.clear();
      RTCRayHit one = rayOf(ray.origin, ray.direction, ray.length);
      every.intersect(state_->panes.get(), one);
      std::ranges::sort(faces, {}, [](const MetFace& face) {
        return std::tuple(face.distance, face.surface, face.triangle);
      });
      for (std::size_t i = 0; i < faces.size(); ++i) {
        const MetFace& face = faces[i];
        if (i > 0 && face.isSame(faces[i - 1])) continue;
        const SurfaceSides& sides = state_->surfaces[face.surface];
        const bool back = face.behind && sides.double_sided;
        hits.push_back({.ray = static_cast<std::uint32_t>(first + k),
                        .triangle = (back ? sides.back : sides.front) + face.triangle,
                        .u = back ? face.v : face.u,
                        .v = back ? face.u : face.v,
                        .distance = face.distance,
                        .entering = !face.behind,
                        .back = face.behind && !sides.double_sided});
      }
    }
  }
}

float RayScene::meet(const SampleRays& rays, std::span<MetShares> shares) const {
  const auto& origins = rays.origins;
  assert(!origins.empty() && shares.size() == origins.size());
  const FlushDenormals flush;
  const OriginDealer dealer(origins);
  Packet packet;
  RayQuery query(RayOrder::Coherent);
  std::vector<std::uint32_t> counts(origins.size(), 0), backs(origins.size(), 0), near(origins.size(), 0);
  std::uint32_t traced = 0, met = 0;
  for (std::size_t p = 0; p < rays.table.packets(); ++p) {
    fillPacket(p, rays, dealer, packet.rays.ray, packet.lanes);
    for (std::size_t k = 0; k < kPacketWidth; ++k) packet.rays.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
    query.intersect(state_->scene.get(), packet.lanes.valid.data(), packet.rays);
    for (std::size_t k = 0; k < kPacketWidth; ++k) {
      if (!packet.lanes.valid[k]) continue;
      const std::size_t origin = packet.lanes.origin[k];
      ++counts[origin];
      ++traced;
      const FirstHit hit = faceOf(packet.rays, k, state_->surfaces);
      if (!hit.any()) continue;
      ++met;
      backs[origin] += hit.back;
      near[origin] += hit.back || hit.distance < origins[origin].reach;
    }
  }
  for (std::size_t o = 0; o < origins.size(); ++o) {
    const float share = counts[o] == 0 ? 0.0f : 1.0f / static_cast<float>(counts[o]);
    shares[o] = {share * static_cast<float>(backs[o]), share * static_cast<float>(near[o])};
  }
  return traced == 0 ? 0.0f : static_cast<float>(met) / static_cast<float>(traced);
}

namespace {

// If more first hits of an origin than this share are back faces, it lies inside a body or under something.
constexpr float kInsideShare = 0.5f;
// If more first hits than this share are nearer than the origin's reach, or back faces, something lies on its
// face: a slab, or a hollow body without a bottom, whose rooms show some fronts from inside.
constexpr float kCoveredShare = 0.9f;
// If this share of a few rays is blocked, the sample deserves more rays. If all of them are, it most likely
// stands in a closed room, where more rays show nothing more.
constexpr float kBlockedShare = 0.5f;
constexpr std::size_t kInsideTestRays = 16, kLookRays = 64;
// If no origin is seen, all of them move into their faces by these shares of the way to the middle, until
// one is.
constexpr std::array kMovedInto = {0.0f, 0.1f, 0.3f, 1.0f};
// Whether an origin and its vertex see each other is asked from this share of the origin's reach away from
// the vertex, which may itself lie in another surface.
constexpr float kBeginOfWay = 0.001f;

// Drops origins that something hides from their vertex, unless all are: they stand behind a wall that cuts
// their face, and the light there is not the vertex's.
void dropHiddenFromVertex(const RayScene& rays, std::vector<SampleOrigin>& origins) {
  if (origins.size() < 2) return;
  std::vector<RaySegment> ways;
  for (const SampleOrigin& origin : origins) {
    const glm::vec3 pull = kPullIntoFace / (1.0f - kPullIntoFace) * origin.inward;
    const float whole = glm::length(pull), length = std::max(0.0f, whole - kBeginOfWay * origin.reach);
    const glm::vec3 along = whole > 0.0f ? pull / whole : origin.geometric_normal;
    ways.push_back({origin.position - length * along, along, length});
  }
  std::vector<std::uint8_t> hidden(ways.size(), 0);
  rays.occluded(ways, hidden);
  const auto seen = static_cast<std::size_t>(std::count(hidden.begin(), hidden.end(), 0));
  if (seen == 0 || seen == origins.size()) return;
  float weight = 0.0f;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if (hidden[i] != 0) continue;
    weight += origins[i].weight;
    origins[kept++] = origins[i];
  }
  origins.resize(kept);
  for (SampleOrigin& origin : origins) origin.weight /= weight;
}

}  // namespace

InsideTestTables::InsideTestTables() : glance(cosineTable(kInsideTestRays)), look(cosineTable(kLookRays)) {}

void findSeenOrigins(std::span<const SampleOrigin> all, const glm::mat3& frame, const RayScene& rays,
                     const InsideTestTables& glances, SeenOrigins& seen) {
  seen.origins.assign(all.begin(), all.end());
  seen.valid = seen.double_rays = false;
  seen.blocked = 0.0f;
  if (all.empty()) return;
  std::vector<MetShares> shares(all.size());
  // Sixteen rays are enough to see that nothing is odd, which is nearly always so.
  seen.blocked = rays.meet({all, frame, glances.glance}, shares);
  seen.double_rays = seen.blocked >= kBlockedShare && seen.blocked < 1.0f;
  seen.valid = std::all_of(shares.begin(), shares.end(), [](const MetShares& met) {
    return met.back == 0.0f && met.near <= kCoveredShare;
  });
  if (seen.valid) return dropHiddenFromVertex(rays, seen.origins);
  for (const float share : kMovedInto) {
    seen.origins.clear();
    float weight = 0.0f;
    for (const SampleOrigin& origin : all) {
      // Each gets all of the rays. Dealt out by weight, faces that are slivers at the vertex would get none.
      SampleOrigin moved = origin;
      moved.position += share * origin.inward;
      moved.weight = 1.0f;
      MetShares met;
      rays.meet({std::span(&moved, 1), frame, glances.look}, std::span(&met, 1));
      if (met.back > kInsideShare || met.near > kCoveredShare) continue;
      moved.weight = origin.weight;
      weight += origin.weight;
      seen.origins.push_back(moved);
    }
    seen.valid = !seen.origins.empty();
    for (SampleOrigin& origin : seen.origins) origin.weight /= weight;
    if (seen.valid && share == 0.0f) dropHiddenFromVertex(rays, seen.origins);
    if (seen.valid) return;
  }
  seen.origins.assign(all.begin(), all.end());
}

}  // namespace lambent::baker
