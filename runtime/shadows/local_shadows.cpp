#include "runtime/shadows/local_shadows.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <glm/matrix.hpp>

#include "runtime/shadows/shadowed_light.hpp"

namespace lambent::frame {

namespace {

using lighting::LocalLight;
constexpr std::uint32_t kFaces = 6, kFullCubes = 4;
constexpr float kLocalPlane_m = 2e-3f;
constexpr float kLightSurface = 1.01f;  // the body of a spherical lamp may be larger by this factor
static_assert(kShadowedLights == lighting::kMaxShadowedLights);
constexpr SurfaceFunction kLocalFunctions[] = {
    {SurfaceHook::Received, CalledBy::All, "local_surface.glsl", "addLocalLights"}};

// Returns whether both cast the same shadows, whatever their colour and cones.
bool sameShadows(const LocalLight& a, const LocalLight& b) {
  return a.kind == b.kind && a.position_ws == b.position_ws && a.radius_m == b.radius_m &&
         a.body_radius_m == b.body_radius_m && a.range_m == b.range_m &&
         (!hasDirection(a) || a.direction_ws == b.direction_ws);
}

ShadowFace faceOf(const LocalLight& light, float reach, std::uint32_t face) {
  const FaceAxes axes = faceAxes(face);
  return {.right = axes.right,
          .clip_near = kLocalPlane_m,
          .up = axes.up,
          .reach = reach,
          .forward = axes.forward,
          .hole = light.kind == LocalLight::Kind::Sphere
                      ? kLightSurface * std::max(light.radius_m, light.body_radius_m)
                      : 0.0f,
          .position = light.position_ws,
          .behind = light.kind == LocalLight::Kind::Disc ? 1.0f : 0.0f,
          .direction = light.direction_ws,
          .pad = 0.0f};
}

scene::Box around(const scene::Box& box, glm::vec3 center) {
  return {.min = box.min - center, .max = box.max - center};
}

// Returns whether part of the box stands where the light may shine.
bool mayShineOn(const LocalLight& light, const scene::Box& from_light) {
  return nearestDistance(from_light) <= rangeOf(light) &&
         (!hasDirection(light) || mostAlong(from_light, light.direction_ws) > 0.0f);
}

}  // namespace

LocalShadows::LocalShadows(const LocalOptions& options)
    : SurfaceModule(kLocalFunctions),
      options_{.size = std::clamp(options.size, 16u, 4096u),
               .samples = std::clamp(options.samples, 1u, 256u)},
      block_("local lights"),
      draws_table_("near draws") {}

void LocalShadows::updateMasks(const World& world, std::span<const std::uint32_t> mask_of_group,
                               gpu::Counters& counters) {
  const streaming::Residency& residency = world.residency();
  lights_used_ = 0;
  std::uint32_t shining = 0;
  for (std::size_t k = 0; k < lights_.size(); ++k) shining |= shines(lights_[k]) ? 1u << k : 0u;
  for (const std::uint32_t mask : mask_of_group) lights_used_ |= mask & shining;
  any_ = lights_used_ != 0;
  if (!masks_changed_.renew({mask_of_group.begin(), mask_of_group.end()}, own_lamps_, shining,
                            residency.version(), world.transformsVersion()))
    return;
  std::vector<LocalDraw> draws;
  if (any_) {
    draws.reserve(residency.draws().size());
    for (std::size_t i = 0; i < residency.draws().size(); ++i) {
      const std::uint32_t group = residency.draws()[i].group;
      const glm::quat turn = world.rotationOf(group);
      // Unlit surfaces show their colour whatever the light.
      const bool lit = group < mask_of_group.size() && !world.material(i).unlit;
      std::uint32_t own = 0;
      for (std::size_t k = 0; k < own_lamps_.size(); ++k)
        if (own_lamps_[k] && own_lamps_[k] == world.lampOfDraw(i)) own |= 1u << k;
      draws.push_back({.world_from_group = {turn.x, turn.y, turn.z, turn.w},
                       .lights = lit ? mask_of_group[group] & shining & ~own : 0u,
                       .pad0 = 0,
                       .pad1 = 0,
                       .pad2 = 0});
    }
  }
  const bool same_lights =
      draws.size() == draws_.size() &&
      std::equal(draws.begin(), draws.end(), draws_.begin(),
                 [](const LocalDraw& a, const LocalDraw& b) { return a.lights == b.lights; });
  const std::size_t bytes = draws.size() * sizeof(LocalDraw);
  const bool same = same_lights && (bytes == 0 || std::memcmp(draws.data(), draws_.data(), bytes) == 0);
  if (!same_lights) ++version_;
  if (same) return;
  draws_ = std::move(draws);
  if (draws_.empty()) return;
  draws_table_.assign(std::span<const LocalDraw>(draws_));
  counters.uploaded_bytes += bytes;
}

std::vector<std::uint32_t> LocalShadows::findChanged(World& world) {
  const bool world_same = !casters_.follow(world);
  std::vector<std::uint32_t> changed;
  for (std::uint32_t k = 0; k < lights_.size(); ++k) {
    Cube& cube = cubes_[k];
    const LocalLight& light = lights_[k];
    const bool light_same = cube.drawn && sameShadows(cube.light, light);
    if ((lights_used_ >> k & 1u) == 0 || (light_same && world_same)) continue;
    std::vector<ShadowCaster> casters;
    float reach = 0.0f;
    for (const ShadowCaster& caster : casters_.all()) {
      const scene::Box box = around(caster.bounds_ws, light.position_ws);
      if (!mayShineOn(light, box)) continue;
      casters.push_back(caster);
      reach = std::max(reach, farthestDistance(box));
    }
    if (light_same && casters == cube.casters) continue;
    cube.light = light;
    cube.casters = std::move(casters);
    // The reach is a little larger than needed, because depth 1 means that nothing is there.
    cube.reach = std::max(1.001f * std::min(reach, rangeOf(light)), 1e-3f);
    cube.drawn = false;
    changed.push_back(k);
  }
  return changed;
}

Result<void> LocalShadows::update(World& world, std::span<const LocalLight> lights,
                                  std::span<const std::uint32_t> mask_of_group, gpu::Counters& counters,
                                  std::span<const ecs::Entity> own_lamps) {
  cubes_drawn_ = 0;
  const std::span<const LocalLight> kept =
      lights.first(std::min<std::size_t>(lights.size(), kShadowedLights));
  lights_.assign(kept.begin(), kept.end());
  for (LocalLight& light : lights_)
    if (const float length = glm::length(light.direction_ws); length > 0.0f) light.direction_ws /= length;
  own_lamps_.assign(own_lamps.begin(), own_lamps.end());
  own_lamps_.resize(lights_.size());
  updateMasks(world, mask_of_group, counters);
  if (!any_) return {};
  if (Result<void> done = casters_.compile(); !done) return done;
  makeRoom(static_cast<std::uint32_t>(std::bit_width(lights_used_)));
  const std::vector<std::uint32_t> changed = findChanged(world);
  if (!changed.empty()) drawCubes(world, changed, counters);
  return {};
}

void LocalShadows::makeRoom(std::uint32_t rows) {
  if (rows <= rows_) return;
  rows_ = rows;
  // All cubes together take no more memory than kFullCubes of the largest size.
  size_ = rows <= kFullCubes
              ? options_.size
              : static_cast<std::uint32_t>(static_cast<float>(options_.size) *
                                           std::sqrt(float{kFullCubes} / static_cast<float>(rows)));
  casters_.resize(kFaces * size_, rows * size_);
  for (Cube& cube : cubes_) cube.drawn = false;  // the new texture is empty
}

void LocalShadows::drawCubes(World& world, const std::vector<std::uint32_t>& changed,
                             gpu::Counters& counters) {
  std::vector<ShadowCasters::Tile> tiles;
  for (const std::uint32_t k : changed) {
    Cube& cube = cubes_[k];
    for (std::uint32_t face = 0; face < kFaces; ++face) {
      ShadowCasters::Tile& tile = tiles.emplace_back(
          ShadowCasters::Tile{.x = face * size_, .y = k * size_, .size = size_, .casters = {}});
      for (const ShadowCaster& caster : cube.casters)
        if (faceMeets(faceAxes(face), around(caster.bounds_ws, cube.light.position_ws)))
          tile.casters.push_back(&caster);
      tile.setView(faceOf(cube.light, cube.reach, face));
    }
    cube.drawn = true;
    ++cubes_drawn_;
  }
  casters_.draw(world, tiles, kBindShadowFace, counters);
}

void LocalShadows::bind(const spec::View& view, const spec::Size& size) const {
  if (!any_) return;
  struct Block {
    ShadowView view;
    std::array<ShadowedLightRecord, kShadowedLights> lights;
  };
  Block block{};
  block.view = {.view_from_clip = glm::mat4(glm::inverse(glm::dmat4(view.clip_from_view))),
                .world_from_view = glm::mat4(glm::inverse(glm::dmat4(view.view_from_world))),
                .width = static_cast<float>(size.width),
                .height = static_cast<float>(size.height),
                .size = size_,
                .samples = options_.samples};
  for (std::size_t k = 0; k < lights_.size(); ++k) block.lights[k] = recordOf(lights_[k], cubes_[k].reach);
  block_.assign(std::span<const Block>(&block, 1));
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindShadowedLights, block_.buffer().id());
  draws_table_.bindStorage(kBindLocalDraws);
  casters_.depths().bind(kUnitLocalShadows);
}

}  // namespace lambent::frame
