#include "runtime/shadows/key_shadows.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

namespace lambent::frame {

namespace {

// A point p is inside if dot(plane, (p, 1)) >= 0 for each plane.
using Planes = std::array<glm::dvec4, 12>;

Planes planesOf(const scene::Box& box, const glm::dmat4& clip_from_world) {
  Planes planes;
  const glm::dmat4 rows = glm::transpose(clip_from_world);
  for (int axis = 0; axis < 3; ++axis) {
    planes[static_cast<std::size_t>(2 * axis)] = rows[3] + rows[axis];
    planes[static_cast<std::size_t>(2 * axis + 1)] = rows[3] - rows[axis];
    glm::dvec4 low(0.0), high(0.0);
    low[axis] = 1.0;
    low.w = -double{box.min[axis]};
    high[axis] = -1.0;
    high.w = double{box.max[axis]};
    planes[static_cast<std::size_t>(6 + 2 * axis)] = low;
    planes[static_cast<std::size_t>(7 + 2 * axis)] = high;
  }
  for (glm::dvec4& plane : planes)
    if (const double length = glm::length(glm::dvec3(plane)); length > 0.0) plane /= length;
  return planes;
}

double extent(const scene::Box& box, glm::dvec3 direction, bool most) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const bool upper = (direction[i] > 0.0) == most;
    sum += direction[i] * double{upper ? box.max[i] : box.min[i]};
  }
  return sum;
}

}  // namespace

std::vector<glm::dvec3> seenCorners(const scene::Box& box, const glm::mat4& clip_from_world) {
  std::vector<glm::dvec3> corners;
  if (box.empty()) return corners;
  const Planes planes = planesOf(box, glm::dmat4(clip_from_world));
  const double doubt = 1e-6 * (double{box.radius()} + glm::length(glm::dvec3(box.center()))) + 1e-9;
  const auto inside = [&](glm::dvec3 p) {
    return std::ranges::all_of(
        planes, [&](const glm::dvec4& plane) { return glm::dot(plane, glm::dvec4(p, 1.0)) >= -doubt; });
  };
  // The corners of a convex body are among the points where three of its planes meet.
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const glm::dmat3 normals =
            glm::transpose(glm::dmat3(glm::dvec3(planes[i]), glm::dvec3(planes[j]), glm::dvec3(planes[k])));
        if (std::abs(glm::determinant(normals)) < 1e-12) continue;
        const glm::dvec3 p = glm::inverse(normals) * -glm::dvec3(planes[i].w, planes[j].w, planes[k].w);
        if (inside(p)) corners.push_back(p);
      }
  return corners;
}

void KeyRegion::enclose(std::span<const glm::dvec3> seen, double tan_radius) {
  min = glm::dvec2(std::numeric_limits<double>::infinity());
  max = -min;
  for (const glm::dvec3& p : seen) {
    const glm::dvec2 place(glm::dot(right, p), glm::dot(up, p));
    const double reach = tan_radius * (top - glm::dot(towards, p));
    min = glm::min(min, place - reach);
    max = glm::max(max, place + reach);
  }
}

bool KeyRegion::holds(const KeyRegion& other) const {
  const double doubt = 1e-6 * (max.x - min.x + max.y - min.y);
  return right == other.right && up == other.up && towards == other.towards &&
         glm::all(glm::lessThanEqual(min - doubt, other.min)) &&
         glm::all(glm::greaterThanEqual(max + doubt, other.max)) && top >= other.top - doubt &&
         top - range <= other.top - other.range + doubt;
}

std::optional<KeyRegion> regionOf(std::span<const glm::dvec3> seen, glm::dvec3 towards, double tan_radius,
                                  const scene::Box& casters) {
  if (seen.empty() || casters.empty()) return std::nullopt;
  constexpr int kTurns = 12;  // number of angles tried over a quarter turn
  const glm::dvec3 beside = std::abs(towards.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 first = glm::normalize(glm::cross(beside, towards)), second = glm::cross(towards, first);
  std::optional<KeyRegion> best;
  double bottom = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : seen) bottom = std::min(bottom, glm::dot(towards, p));
  const double top = std::max(extent(casters, towards, /*most=*/true), bottom);
  for (int turn = 0; turn < kTurns; ++turn) {
    const double angle = 0.5 * std::numbers::pi * turn / kTurns;
    KeyRegion region{.right = std::cos(angle) * first + std::sin(angle) * second, .towards = towards};
    region.up = glm::cross(towards, region.right);
    region.top = top;
    region.range = top - bottom;
    region.enclose(seen, tan_radius);
    if (!best || region.area() < 0.999 * best->area()) best = region;
  }
  return best;
}

namespace {

constexpr std::uint32_t kLeastSize = 256;
constexpr std::uint32_t kLeastRays = 8;
constexpr std::uint64_t kFinestTiles = 2;  // limit on the texels of all maps, in areas of the finest
constexpr double kMargin = 0.05;           // margin that lets the camera move before a map is drawn again
constexpr double kWasted = 4.0;  // a map that covers this many times the visible area is drawn again
constexpr SurfaceFunction kKeyFunctions[] = {
    {SurfaceHook::Received, CalledBy::All, "key_surface.glsl", "addKeyLights"}};
// These are the uniform locations of key_blockers.comp.
constexpr GLint kFirst = 0, kSize = 1, kLevel = 2;

// Returns a size for which texels are a small part of the penumbra's width, which hides them.
std::uint32_t sizeFor(float radius_rad, std::uint32_t finest) {
  constexpr float kSharp = 0.026f, kMedium = 0.1f;  // in radians
  const std::uint32_t size = radius_rad <= kSharp ? finest : radius_rad <= kMedium ? finest / 2 : finest / 4;
  return std::max(size, kLeastSize);
}

bool shines(const spec::Disc& light) {
  const float sum = light.radiance.x + light.radiance.y + light.radiance.z;
  return std::isfinite(sum) && light.radiance != glm::vec3(0.0f) && light.radius_rad > 0.0f &&
         light.radius_rad < 1.0f;
}

float fluxOf(const spec::Disc& light) {
  const float half = std::sin(0.5f * light.radius_rad);
  return half * half * (light.radiance.r + light.radiance.g + light.radiance.b);
}

double tangentOf(const spec::Disc& light) {
  return std::tan(double{light.radius_rad});
}

bool sameShape(const spec::Disc& a, const spec::Disc& b) {
  return a.direction == b.direction && a.radius_rad == b.radius_rad;
}

glm::vec4 row(glm::dvec3 xyz, double w) {
  return glm::vec4(glm::dvec4(xyz, w));
}

// Returns clip coordinates of the region: z from -1 at its top to 1 at its bottom.
glm::mat4 clipFromWorld(const KeyRegion& region) {
  const glm::dvec2 scale = 2.0 / (region.max - region.min);
  const double depth = 2.0 / region.range;
  const glm::dmat4 rows(glm::dvec4(scale.x * region.right, -scale.x * region.min.x - 1.0),
                        glm::dvec4(scale.y * region.up, -scale.y * region.min.y - 1.0),
                        glm::dvec4(-depth * region.towards, depth * region.top - 1.0),
                        glm::dvec4(0, 0, 0, 1));
  return glm::mat4(glm::transpose(rows));
}

}  // namespace

KeyShadows::KeyShadows() : SurfaceModule(kKeyFunctions), block_("key lights") {}

Result<void> KeyShadows::compile() {
  if (pyramid_program_) return {};
  if (Result<void> done = casters_.compile(); !done) return done;
  Result<gpu::Program> pyramid =
      gpu::Program::create("key blockers", {{GL_COMPUTE_SHADER, "key_blockers.comp"}}, kShadowShaders);
  if (!pyramid) return failAgain(pyramid.error());
  pyramid_program_ = std::move(*pyramid);
  return {};
}

// Places large tiles first, in rows as high as their first tile. Each tile lies at a multiple of its own
// size, so that no texel of the pyramid covers two tiles.
void KeyShadows::layOut(std::span<const spec::Disc> keys) {
  std::vector<Map> maps;
  for (const spec::Disc& key : keys)
    if (shines(key) && maps.size() < kMostKeyLights)
      maps.push_back(
          {.light = key, .size = sizeFor(key.radius_rad, options_.finest), .region = {}, .casters = {}});
  const auto texels = [](const Map& map) { return std::uint64_t{map.size} * map.size; };
  std::uint64_t sum = 0;
  for (const Map& map : maps) sum += texels(map);
  // The faintest lights get smaller maps first.
  std::vector<Map*> faintest;
  for (Map& map : maps) faintest.push_back(&map);
  std::ranges::stable_sort(faintest, std::ranges::less(), [](const Map* map) { return fluxOf(map->light); });
  const std::uint64_t most = kFinestTiles * options_.finest * options_.finest;
  for (std::uint32_t size = options_.finest; size > kLeastSize && sum > most; size /= 2)
    for (Map* map : faintest)
      if (sum > most && map->size == size) {
        sum -= 3 * texels(*map) / 4;
        map->size /= 2;
      }
  std::ranges::stable_sort(maps, std::ranges::greater(), &Map::size);
  const auto side = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(sum)));
  const std::uint32_t width = maps.empty() ? 0 : std::max(maps.front().size, std::bit_ceil(side));
  std::uint32_t x = 0, y = 0, row_height = 0;
  for (Map& map : maps) {
    if (x + map.size > width) {
      x = 0;
      y += row_height;
      row_height = 0;
    }
    row_height = std::max(row_height, map.size);
    map.x = x;
    map.y = y;
    x += map.size;
  }
  const std::uint32_t height = y + row_height;
  const gpu::Texture& depths = casters_.depths();
  const bool same_texture = depths && depths.desc().width == width && depths.desc().height == height;
  for (std::size_t k = 0; k < maps.size() && same_texture; ++k)
    if (k < maps_.size() && maps_[k].x == maps[k].x && maps_[k].y == maps[k].y &&
        maps_[k].size == maps[k].size) {
      const spec::Disc light = maps[k].light;
      maps[k] = std::move(maps_[k]);
      maps[k].drawn &= sameShape(maps[k].light, light);
      maps[k].light = light;
    }
  maps_ = std::move(maps);
  if (same_texture || maps_.empty()) return;
  casters_.resize(width, height);
  const std::uint32_t levels = std::bit_width(width / kBlockerTexels);
  blockers_ = gpu::Texture("key blockers", {.format = GL_RG32F,
                                            .width = width / kBlockerTexels,
                                            .height = height / kBlockerTexels,
                                            .levels = levels});
}

std::vector<std::size_t> KeyShadows::findChanged(World& world, const spec::View& view) {
  if (casters_.follow(world)) {
    bounds_ws_ = {};
    for (const ShadowCaster& caster : casters_.all()) bounds_ws_.add(caster.bounds_ws);
  }
  const std::vector<glm::dvec3> seen = seenCorners(bounds_ws_, view.clip_from_view * view.view_from_world);
  std::vector<std::size_t> changed;
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    Map& map = maps_[k];
    std::optional<KeyRegion> wanted =
        regionOf(seen, glm::normalize(glm::dvec3(map.light.direction)), tangentOf(map.light), bounds_ws_);
    if (!wanted) continue;
    const glm::dvec2 size = wanted->max - wanted->min;
    const double least = 1e-6 * std::max({size.x, size.y, wanted->range, 1e-3});
    const auto holds = [&] {
      KeyRegion turned = *wanted;  // expressed in the map's present axes
      turned.right = map.region.right;
      turned.up = map.region.up;
      turned.enclose(seen, tangentOf(map.light));
      return map.region.holds(turned) && map.region.area() < kWasted * wanted->area();
    };
    std::vector<ShadowCaster> casters;
    const auto take = [&](const KeyRegion& region) {
      for (const ShadowCaster& caster : casters_.all()) {
        const glm::dvec3 center(caster.bounds_ws.center());
        const double radius = double{caster.bounds_ws.radius()};
        const glm::dvec2 place(glm::dot(region.right, center), glm::dot(region.up, center));
        if (place.x + radius >= region.min.x && place.x - radius <= region.max.x &&
            place.y + radius >= region.min.y && place.y - radius <= region.max.y)
          casters.push_back(caster);
      }
    };
    if (map.drawn && holds()) {
      take(map.region);
      if (casters == map.casters) continue;
      casters.clear();
    }
    wanted->min -= kMargin * size + least;
    wanted->max += kMargin * size + least;
    // A margin at both ends keeps casters there distinct from empty texels.
    wanted->top += 1e-3 * wanted->range + least;
    wanted->range *= 1.002;
    wanted->range += 2.0 * least;
    take(*wanted);
    map.region = *wanted;
    map.casters = std::move(casters);
    map.drawn = true;
    changed.push_back(k);
  }
  return changed;
}

Result<void> KeyShadows::update(World& world, std::span<const spec::Disc> keys, const spec::View& view,
                                const KeyShadowOptions& options, gpu::Counters& counters) {
  maps_drawn_ = 0;
  if (!(options == options_)) {
    options_ = options;
    options_.finest = std::bit_floor(std::clamp(options.finest, kLeastSize, 8192u));
    options_.samples = std::clamp(options.samples, 4u, 128u);
  }
  layOut(keys);
  if (maps_.empty()) return {};
  if (Result<void> done = compile(); !done) return done;
  const std::vector<std::size_t> changed = findChanged(world, view);
  if (changed.empty()) return {};
  maps_drawn_ = static_cast<std::uint32_t>(changed.size());
  drawMaps(world, changed, counters);
  makePyramid(changed, counters);
  return {};
}

void KeyShadows::drawMaps(World& world, const std::vector<std::size_t>& changed, gpu::Counters& counters) {
  std::vector<ShadowCasters::Tile> tiles;
  for (const std::size_t k : changed) {
    const Map& map = maps_[k];
    ShadowCasters::Tile& tile =
        tiles.emplace_back(ShadowCasters::Tile{.x = map.x, .y = map.y, .size = map.size, .casters = {}});
    for (const ShadowCaster& caster : map.casters) tile.casters.push_back(&caster);
    tile.setView(KeyMapView{clipFromWorld(map.region)});
  }
  glEnable(GL_DEPTH_CLAMP);  // casters may reach below the map's bottom, where they shadow nothing visible
  casters_.draw(world, tiles, kBindKeyMap, counters);
  glDisable(GL_DEPTH_CLAMP);
}

void KeyShadows::makePyramid(const std::vector<std::size_t>& changed, gpu::Counters& counters) {
  pyramid_program_.use();
  casters_.depths().bind(0);
  blockers_.bind(1);
  glBindSampler(0, 0);
  glBindSampler(1, 0);
  glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  for (std::uint32_t level = 0; level < blockers_.desc().levels; ++level) {
    glBindImageTexture(0, blockers_.id(), static_cast<GLint>(level), GL_FALSE, 0, GL_WRITE_ONLY, GL_RG32F);
    glUniform1i(kLevel, static_cast<GLint>(level));
    for (const std::size_t k : changed) {
      const Map& map = maps_[k];
      const std::uint32_t texels = kBlockerTexels << level, size = map.size / texels;
      if (size == 0) continue;
      glUniform2i(kFirst, static_cast<GLint>(map.x / texels), static_cast<GLint>(map.y / texels));
      glUniform1i(kSize, static_cast<GLint>(size));
      const std::uint32_t groups = (size + kBlockerGroup - 1) / kBlockerGroup;
      glDispatchCompute(groups, groups, 1);
      ++counters.dispatches;
    }
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  }
}

void KeyShadows::bind(const spec::View& view, const spec::Size& size) const {
  if (maps_.empty()) return;
  struct Block {
    KeyView view;
    std::array<KeyRecord, kMostKeyLights> keys;
  };
  Block block{};
  const glm::dmat4 view_from_world(view.view_from_world), world_from_view = glm::inverse(view_from_world);
  const glm::dmat3 turn(view_from_world);
  const glm::dvec3 eye(world_from_view[3]);
  // Errors of a light matter in proportion to its part of all light, and fall with the number of rays. This
  // distribution of rays minimizes the sum of squared errors.
  float all_flux = 0.0f;
  for (const Map& map : maps_) all_flux += fluxOf(map.light);
  const auto raysFor = [&](float part) {
    const float rays = 2.0f * static_cast<float>(options_.samples) * std::cbrt(part * part);
    return std::clamp(static_cast<std::uint32_t>(rays), std::min(kLeastRays, options_.samples),
                      options_.samples);
  };
  std::uint32_t count = 0;
  for (const Map& map : maps_) {
    if (!map.drawn) continue;
    const KeyRegion& region = map.region;
    const glm::dvec2 scale = double(map.size) / (region.max - region.min);
    KeyRecord& record = block.keys[count++];
    // For a point p in view space, dot(right, world) = dot(turn right, p) + dot(right, eye).
    record.right = row(scale.x * (turn * region.right),
                       double(map.x) + scale.x * (glm::dot(region.right, eye) - region.min.x));
    record.up = row(scale.y * (turn * region.up),
                    double(map.y) + scale.y * (glm::dot(region.up, eye) - region.min.y));
    record.towards = row(turn * region.towards, region.top - glm::dot(region.towards, eye));
    record.radiance = glm::vec4(map.light.radiance, std::sin(map.light.radius_rad));
    record.tile = glm::vec4(map.x, map.y, map.x + map.size - 1, map.y + map.size - 1);
    record.scale = glm::vec4(scale, region.range, std::tan(map.light.radius_rad));
    record.rays = raysFor(fluxOf(map.light) / all_flux);
  }
  block.view = {.view_from_clip = glm::mat4(glm::inverse(glm::dmat4(view.clip_from_view))),
                .view_from_world = glm::mat4(glm::mat3(view.view_from_world)),
                .picture = glm::vec4(size.width, size.height, 0, 0),
                .count = count,
                .pad0 = 0,
                .pad1 = 0,
                .pad2 = 0};
  block_.assign(std::span<const Block>(&block, 1));
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindKeyLights, block_.buffer().id());
  casters_.depths().bind(kUnitKeyShadows);
  blockers_.bind(kUnitKeyBlockers);
  glBindSampler(kUnitKeyShadows, 0);
  glBindSampler(kUnitKeyBlockers, 0);
}

std::uint64_t KeyShadows::bytesResident() const {
  const gpu::Texture& depths = casters_.depths();
  if (!depths) return 0;
  const std::uint64_t texels = std::uint64_t{depths.desc().width} * depths.desc().height;
  return 4 * texels + 8 * texels / (kBlockerTexels * kBlockerTexels) * 4 / 3;
}

}  // namespace lambent::frame
