#include "runtime/bounces/patch_bounces.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "lambent_bounces_embedded.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/lighting/key_lights.hpp"

namespace lambent::frame {

static_assert(kPatchLinks == lighting::kLinks);

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_bounces::find};
constexpr SurfaceFunction kBounceFunctions[] = {
    {SurfaceHook::Vertex, CalledBy::Diffuse, "bounced_vertex.glsl", "addBounces"},
    {SurfaceHook::Gathered, CalledBy::Glossy, "bounced_corners.glsl", "addBounces"}};
// If bounces of uniform direct light add less than this, bands suffice for key lights.
constexpr float kWorthPatches = 0.02f;
constexpr float kFarAway = 1e3f;  // distance of key lights, in radii of the room

std::uint32_t outputsOf(const streaming::ResidentDraw& draw) {
  return draw.form() == transfer::Form::Vector ? 1 : transfer::kMappedOutputs;
}

lighting::LinkSpread spreadOf(const streaming::ResidentDraw& draw) {
  return outputsOf(draw) == 1 ? lighting::LinkSpread::Cosine : lighting::LinkSpread::Hemisphere;
}

std::vector<glm::vec3> readVectors(const gpu::Buffer& page, std::uint32_t word, std::uint32_t count) {
  std::vector<glm::vec3> values(count);
  page.read(4 * std::size_t{word}, std::span(values));
  return values;
}

float distanceToSegment(const glm::vec3& point, const glm::vec3& from, const glm::vec3& to) {
  const glm::vec3 way = to - from;
  const float length2 = glm::dot(way, way);
  const float along = length2 > 0.0f ? std::clamp(glm::dot(point - from, way) / length2, 0.0f, 1.0f) : 0.0f;
  return glm::distance(point, from + along * way);
}

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0.0f ? v / length : glm::vec3(0.0f, 1.0f, 0.0f);
}

}  // namespace

PatchBounces::PatchBounces()
    : SurfaceModule(kBounceFunctions),
      patches_("lamp patches"),
      bounced_("lamp light at vertices"),
      directions_("lamp link directions"),
      block_("lamp draw") {}

void PatchBounces::drop() {
  if (counts_.rooms > 0 || !words_.empty()) ++layout_version_;
  rooms_.clear();
  draws_.clear();
  words_.clear();
  counts_ = {};
}

PatchBounces::Task PatchBounces::taskOf(const World& world, const LightPlan& plan, const PatchLights& lights,
                                        std::size_t group) const {
  const std::uint32_t beside = plan.beside_masks[group];
  const auto& transport = rooms_[group].room.transport();
  Task task;
  task.apart = world.residency().groups()[group].volume < 0 &&
               (!lights.keys.empty() || (lights.bands->hasKeys() && beside != 0));
  task.mends_bands = task.apart && transport && transport->bounced() >= kWorthPatches;
  // Lamps within the group's bounds always use patches.
  task.lamps = plan.within_masks[group] | (task.mends_bands ? beside : 0u);
  for (std::size_t k = 0; k < plan.shadowed_lights.size(); ++k)
    if (!shines(plan.shadowed_lights[k])) task.lamps &= ~(1u << k);
  return task;
}

RoomLights PatchBounces::lightsIn(const World& world, const LightPlan& plan, const PatchLights& lights,
                                  std::size_t group) const {
  const streaming::ResidentGroup& resident = world.residency().groups()[group];
  const Task task = taskOf(world, plan, lights, group);
  RoomLights found;
  for (std::size_t k = 0; k < plan.shadowed_lights.size(); ++k)
    if ((task.lamps >> k & 1u) != 0) found.lamps.push_back(plan.shadowed_lights[k]);
  if (!task.mends_bands) return found;
  const glm::quat group_from_world = glm::conjugate(world.rotationOf(group));
  for (spec::Disc key : lights.keys) {
    key.direction = group_from_world * key.direction;
    found.keys.push_back(key);
  }
  for (std::size_t s = 0; s < resident.light_probes.size(); ++s) {
    const auto block = [&](std::uint32_t first) {
      return lights.bands->coefficients().subspan(first, lighting::GroupLights::kBlock);
    };
    const std::uint32_t first = lights.bands->firstOf(group, s);
    const auto rest = block(first), keys = block(first + lighting::GroupLights::kBlock);
    KeyBands& bands = found.bands.emplace_back(resident.light_probes[s]);
    bands.keys.assign(keys.begin(), keys.end());
    for (std::size_t c = 0; c < keys.size(); ++c) bands.all.push_back(rest[c] + keys[c]);
  }
  return found;
}

// Returns the bodies that may stand between the group's surfaces and its lights.
std::vector<lighting::RayTriangle> PatchBounces::othersAround(const World& world, const LightPlan& plan,
                                                              std::size_t group, const RoomLights& lights) {
  if (lights.none()) return {};
  const std::uint32_t own = plan.groups[group].body;
  if (own == lighting::CapturePoint::kNoBody) return {};
  const lighting::IncidentBody& room = plan.bodies[own];
  const glm::mat4 group_from_world = glm::inverse(world.worldFromGroup(group));
  std::vector<glm::vec3> ends;  // where lines from the room to its lights end
  for (const lighting::LocalLight& lamp : lights.lamps) ends.push_back(lamp.position_ws);
  for (const spec::Disc& key : lights.keys)
    ends.push_back(room.center_ws + kFarAway * room.radius_m * (world.rotationOf(group) * key.direction));
  const auto inTheWay = [&](const lighting::IncidentBody& other) {
    return std::ranges::any_of(ends, [&](const glm::vec3& end) {
      return distanceToSegment(other.center_ws, room.center_ws, end) <= room.radius_m + other.radius_m;
    });
  };
  std::vector<lighting::RayTriangle> triangles;
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const std::uint32_t body = plan.groups[g].body;
    if (body == own || body == lighting::CapturePoint::kNoBody) continue;
    const lighting::IncidentBody& other = plan.bodies[body];
    if (!inTheWay(other)) continue;
    lighting::appendBlockers(*world.residency().groups()[g].proxy,
                             group_from_world * other.body.world_from_proxy, triangles);
  }
  return triangles;
}

PatchBounces::Points PatchBounces::pointsOf(World& world, std::size_t index) {
  const streaming::ResidentDraw& draw = world.residency().draws()[index];
  const streaming::ResidentMesh& mesh = world.residency().meshes()[draw.mesh];
  const gpu::Buffer& page = world.residency().geometry().page(mesh.block.page);
  const glm::mat4 group_from_mesh =
      glm::inverse(world.worldFromGroup(draw.group)) * world.worldFromMesh(index);
  const std::vector<glm::vec3> positions = readVectors(page, mesh.positions_word, mesh.vertex_count);
  const std::vector<glm::vec3> normals = readVectors(page, mesh.normals_word, mesh.vertex_count);
  Points points{.draw = draw.id, .points = {}, .spread = spreadOf(draw)};
  points.points.reserve(mesh.vertex_count);
  for (std::size_t v = 0; v < mesh.vertex_count; ++v)
    points.points.push_back({.position = glm::vec3(group_from_mesh * glm::vec4(positions[v], 1.0f)),
                             .normal = unit(draw.group_from_mesh_normal * normals[v])});
  return points;
}

bool PatchBounces::lit(const World& world, std::size_t draw) const {
  const streaming::ResidentDraw& resident = world.residency().draws()[draw];
  return !rooms_[resident.group].room.givenOff().empty() && !world.material(draw).unlit;
}

// Requests everything that the group needs and lacks, as one task.
void PatchBounces::ask(World& world, std::size_t group, bool links) {
  Room& room = rooms_[group];
  if (room.coming.valid()) return;
  const auto& draws = world.residency().draws();
  std::vector<Points> points;
  for (std::size_t i = 0; links && i < draws.size(); ++i) {
    if (draws[i].group != group || draws_[i].asked) continue;
    if (!world.residency().meshes()[draws[i].mesh].block || world.material(i).unlit) continue;
    draws_[i].asked = true;
    points.push_back(pointsOf(world, i));
  }
  if (room.room.transport() && points.empty()) return;
  const streaming::ResidentGroup& resident = world.residency().groups()[group];
  room.coming = std::async(std::launch::async, [transport = room.room.transport(), points = std::move(points),
                                                proxy = *resident.proxy,
                                                order = static_cast<int>(resident.order)]() mutable {
    Made made{.transport = std::move(transport), .links = {}};
    if (!made.transport)
      made.transport = std::make_shared<const lighting::PatchTransport>(proxy, lighting::kMaxPatches, order);
    for (const Points& draw : points)
      made.links.push_back({draw.draw, made.transport->link(draw.points, draw.spread)});
    return made;
  });
}

bool PatchBounces::take(const World& world, std::size_t group, bool wait) {
  Room& room = rooms_[group];
  if (!room.coming.valid()) return false;
  if (!wait && room.coming.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  Made made = room.coming.get();
  if (!room.room.transport()) room.room = PatchRoom(std::move(made.transport));
  const auto& draws = world.residency().draws();
  for (Made::Links& links : made.links) {
    const auto found = std::ranges::find(draws, links.draw, &streaming::ResidentDraw::id);
    if (found == draws.end()) continue;
    Draw& draw = draws_[static_cast<std::size_t>(found - draws.begin())];
    draw.links = gpu::Buffer("lamp links", std::max<std::size_t>(4, 2 * links.patches.size()));
    draw.links.write(0, std::span<const std::uint16_t>(links.patches));
  }
  return true;
}

bool PatchBounces::prepare(World& world, const LightPlan& plan, const PatchLights& lights, std::size_t group,
                           bool wait) {
  if (!world.residency().groups()[group].proxy) return false;
  bool came = false;
  // For a group with only key lights, form factors come first: they tell whether links are worth making.
  for (int stage = 0; stage < 2; ++stage) {
    const Task task = taskOf(world, plan, lights, group);
    const bool links = task.lamps != 0 || (task.mends_bands && !lights.keys.empty());
    if (!links && (!task.apart || rooms_[group].room.transport())) return came;
    ask(world, group, links);
    if (!take(world, group, wait)) return came;
    came = true;
  }
  return came;
}

Result<void> PatchBounces::update(World& world, const LightPlan& plan, const PatchLights& lights, bool on,
                                  bool wait, gpu::Counters& counters) {
  const auto& groups = world.residency().groups();
  counts_ = {};
  bool any = !lights.keys.empty();
  for (const std::uint32_t mask : plan.pixel_masks) any |= mask != 0;
  if (!on || (!any && rooms_.size() == 0)) {
    drop();
    return {};
  }
  const bool groups_moved = rooms_.follow(groups, &streaming::ResidentGroup::id);
  const bool draws_moved = draws_.follow(world.residency().draws(), &streaming::ResidentDraw::id);
  bool changed = groups_moved || draws_moved;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    Room& room = rooms_[g];
    changed |= prepare(world, plan, lights, g, wait);
    if (room.coming.valid()) ++counts_.rooms_to_come;
    if (!room.room.transport()) continue;
    const RoomLights found = lightsIn(world, plan, lights, g);
    room.room.light(found, world.worldFromGroup(g), othersAround(world, plan, g, found));
    counts_.lights_bounced += room.room.tracedLast();
    if (!room.room.givenOff().empty()) {
      ++counts_.rooms;
      counts_.patches += static_cast<std::uint32_t>(room.room.givenOff().size());
    }
    if (room.seen == room.room.version()) continue;
    room.seen = room.room.version();
    room.version = ++version_;
    room.sent.clear();
    if (!room.room.givenOff().empty()) room.sent = room.room.transport()->byTriangle(room.room.givenOff());
    changed = true;
  }
  if (!changed) return {};
  layOut(world);
  uploadPatches(counters);
  return gather(world, counters);
}

void PatchBounces::layOut(const World& world) {
  const auto& draws = world.residency().draws();
  std::vector<std::uint32_t> words(draws.size(), kNothing);
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < draws.size(); ++i) {
    if (!draws_[i].links || !lit(world, i)) continue;
    words[i] = word;
    word += (3 * outputsOf(draws[i]) + 1) * world.residency().meshes()[draws[i].mesh].vertex_count;
  }
  if (words == words_) return;
  words_ = std::move(words);
  ++layout_version_;
  for (Draw& draw : draws_) draw.gathered = 0;
  bounced_.reserve(std::max<std::size_t>(16, 4 * std::size_t{word}));
}

// Each group's regions are followed by a dark one, for links that hit nothing.
void PatchBounces::uploadPatches(gpu::Counters& counters) {
  std::vector<glm::vec4> patches;
  for (Room& room : rooms_) {
    if (room.room.givenOff().empty()) continue;
    room.first_patch = static_cast<std::uint32_t>(patches.size());
    const lighting::Patches& of_room = room.room.transport()->patches();
    for (const glm::vec3& radiance : of_room.means(room.room.givenOff()))
      patches.emplace_back(radiance, 0.0f);
    if (!room.room.givenOffByBands().empty()) {
      glm::vec4* patch = &patches[room.first_patch];
      const float sign = room.room.hasLamps() ? 1.0f : -1.0f;
      for (const glm::vec3& radiance : of_room.means(room.room.givenOffByBands()))
        patch++->w = sign * static_cast<float>(lighting::luminance(radiance));
    }
    patches.emplace_back(0.0f);
  }
  if (patches.empty()) return;
  patches_.assign(std::span<const glm::vec4>(patches));
  counters.uploaded_bytes += patches.size() * sizeof(glm::vec4);
}

Result<const gpu::Program*> PatchBounces::program(std::uint32_t outputs) {
  if (const auto found = programs_.find(outputs); found != programs_.end()) return &found->second;
  const std::vector<gpu::Define> defines = {{"LAMBENT_OUTPUTS", std::to_string(outputs)}};
  Result<gpu::Program> made =
      gpu::Program::create(fmt::format("patch_gather.comp outputs {}", outputs),
                           {{GL_COMPUTE_SHADER, "patch_gather.comp"}}, kShaders, defines);
  if (!made) return failAgain(made.error());
  if (outputs > 1) {
    std::vector<glm::vec4> directions;
    for (const glm::vec3& direction : lighting::linkDirections(lighting::LinkSpread::Hemisphere))
      directions.emplace_back(direction, 0.0f);
    directions_.assign(std::span<const glm::vec4>(directions));
  }
  return &programs_.emplace(outputs, std::move(*made)).first->second;
}

Result<void> PatchBounces::gather(World& world, gpu::Counters& counters) {
  const auto& draws = world.residency().draws();
  for (std::size_t i = 0; i < draws.size(); ++i) {
    const Room& room = rooms_[draws[i].group];
    if (words_[i] == kNothing || draws_[i].gathered == room.version) continue;
    draws_[i].gathered = room.version;
    const Result<const gpu::Program*> kernel = program(outputsOf(draws[i]));
    if (!kernel) return failAgain(kernel.error());
    (*kernel)->use();
    const streaming::ResidentMesh& mesh = world.residency().meshes()[draws[i].mesh];
    const PatchDraw block{.group_from_mesh_normal = glm::mat3x4(draws[i].group_from_mesh_normal),
                          .first_patch = room.first_patch,
                          .vertex_count = mesh.vertex_count,
                          .bounced_word = words_[i],
                          .normals_word = mesh.normals_word};
    block_.assign(std::span<const PatchDraw>(&block, 1));
    glBindBufferBase(GL_UNIFORM_BUFFER, kBindPatchDraw, block_.buffer().id());
    draws_[i].links.bindStorage(kBindPatchLinks);
    patches_.bindStorage(kBindPatches);
    bounced_.bindStorage(kBindPatchBounced);
    if (outputsOf(draws[i]) > 1) {
      world.residency().geometry().page(mesh.block.page).bindStorage(kBindPatchGeometry);
      directions_.bindStorage(kBindPatchDirections);
    }
    glDispatchCompute((mesh.vertex_count + kPatchGroupSize - 1) / kPatchGroupSize, 1, 1);
    ++counters.dispatches;
    ++counts_.draws_gathered;
    counters.uploaded_bytes += sizeof(block);
  }
  if (counts_.draws_gathered > 0) glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  return {};
}

}  // namespace lambent::frame
