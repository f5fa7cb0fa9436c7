#include "runtime/debug/picker.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "runtime/debug/overlays.hpp"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

namespace {

constexpr GLint kClipFromWorld = 0;  // as in pick.glsl

struct Ray {
  glm::dvec3 origin{0.0}, direction{0.0};  // starts at the near plane
};

Ray rayThrough(const glm::dmat4& world_from_clip, double x, double y) {
  const glm::dvec4 near = world_from_clip * glm::dvec4(x, y, -1.0, 1.0);
  const glm::dvec4 far = world_from_clip * glm::dvec4(x, y, 1.0, 1.0);
  const glm::dvec3 origin = glm::dvec3(near) / near.w;
  return {origin, glm::normalize(glm::dvec3(far) / far.w - origin)};
}

struct Hit {
  double distance = 0.0;
  bool from_within = false;
};

// Returns where the ray enters the box from 0 to `size`.
std::optional<Hit> enters(const Ray& ray, const glm::dmat4& world_from_box, const glm::uvec3& size) {
  const glm::dmat4 box_from_world = glm::inverse(world_from_box);
  const glm::dvec3 origin(box_from_world * glm::dvec4(ray.origin, 1.0));
  const glm::dvec3 direction(box_from_world * glm::dvec4(ray.direction, 0.0));
  double first = -std::numeric_limits<double>::infinity(), last = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = -origin[axis] / direction[axis], b = (size[axis] - origin[axis]) / direction[axis];
    // A ray parallel to a face is either between the two faces or misses.
    if (direction[axis] == 0.0) {
      if (origin[axis] < 0.0 || origin[axis] > size[axis]) return {};
      continue;
    }
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  if (!(first <= last) || last < 0.0) return {};
  return Hit{std::max(first, 0.0), first < 0.0};
}

}  // namespace

Picker::Picker() : draws_("picked draws"), commands_("pick commands"), indices_("pick") {}

Result<void> Picker::compile(const PickOptions& options) {
  if (program_) return {};
  std::vector<gpu::Define> defines;
  if (options.finest_texels) defines.push_back({"LAMBENT_FINEST_TEXELS", "1"});
  Result<gpu::Program> program = gpu::Program::create(
      "pick", {{GL_VERTEX_SHADER, "pick.glsl"}, {GL_FRAGMENT_SHADER, "pick.glsl"}}, kDebugShaders, defines);
  if (!program) return failAgain(program.error());
  program_ = std::move(*program);
  seen_ = gpu::Texture("picked", {.format = GL_RGBA32UI});
  glTextureParameteri(seen_.id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(seen_.id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  depth_ = gpu::Texture("picked depth", {.format = GL_DEPTH_COMPONENT32F});
  target_ = gpu::Framebuffer("pick", seen_, &depth_);
  units_.emplace();
  return {};
}

std::optional<Picker::Seen> Picker::drawPixel(World& world, const Surfaces& surfaces,
                                              const glm::mat4& clip_from_world) {
  const streaming::Residency& residency = world.residency();
  std::vector<SurfaceDraw> records;
  std::vector<DrawCommand> commands;
  struct Item {
    std::uint32_t draw = 0, command = 0;
    SurfaceTextures textures;
  };
  std::vector<Item> items;
  for (std::uint32_t i = 0; i < residency.draws().size(); ++i) {
    records.push_back(describe(world, i));
    if (!surfaces.shows(i)) continue;
    const streaming::ResidentMesh& mesh = residency.meshes()[residency.draws()[i].mesh];
    SurfaceTextures textures;
    const std::int32_t texture = materialOf(world, i).base_color_texture.texture;
    if (records[i].base_color_texture.set != kAbsent)
      textures = {.bundle = static_cast<std::int32_t>(residency.draws()[i].bundle), .base_color = texture};
    items.push_back({i, static_cast<std::uint32_t>(commands.size()), textures});
    commands.push_back({mesh.index_count, 1, mesh.indices_word, 0, i});
  }
  if (items.empty()) return {};
  draws_.assign(std::span<const SurfaceDraw>(records));
  commands_.assign(std::span<const DrawCommand>(commands));
  indices_.reserve(records.size());

  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glViewport(0, 0, 1, 1);
  constexpr GLuint kNothing[4] = {~0u, 0, 0, 0};
  constexpr GLfloat kFar = 1.0f;
  glDepthMask(GL_TRUE);
  glClearNamedFramebufferuiv(target_.id(), GL_COLOR, 0, kNothing);
  glClearNamedFramebufferfv(target_.id(), GL_DEPTH, 0, &kFar);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDisable(GL_BLEND);
  glEnable(GL_CULL_FACE);
  program_->use();
  glUniformMatrix4fv(kClipFromWorld, 1, GL_FALSE, &clip_from_world[0][0]);
  draws_.bindStorage(kBindDraws);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.buffer().id());
  gpu::Counters counters;
  for (const Item& item : items) {
    const streaming::ResidentDraw& draw = residency.draws()[item.draw];
    const gpu::Buffer& geometry = world.residency().geometry().page(residency.meshes()[draw.mesh].block.page);
    geometry.bindStorage(kBindGeometry);
    indices_.bind(geometry);
    units_->bind(world, item.textures);
    const bool clockwise =
        (glm::determinant(glm::mat3(records[item.draw].world_from_mesh)) < 0.0f) != draw.back;
    glFrontFace(clockwise ? GL_CW : GL_CCW);
    DrawIndices::draw(item.command, 1, counters);
  }
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  units_->unbindSamplers();
  std::array<GLuint, 4> words{};
  Seen seen;
  glGetTextureImage(seen_.id(), 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, sizeof(words), words.data());
  glGetTextureImage(depth_.id(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, sizeof(seen.depth), &seen.depth);
  if (words[0] == ~0u) return {};
  seen.draw = words[0];
  for (int i = 0; i < 3; ++i)
    seen.normal_group[i] = std::bit_cast<float>(words[static_cast<std::size_t>(i) + 1]);
  return seen;
}

Result<std::optional<Picked>> Picker::pick(World& world, const Surfaces& surfaces, const spec::View& view,
                                           const PicturePoint& point, const PickOptions& options) {
  const auto& [size, x, y] = point;
  if (!(x >= 0.0f && x < static_cast<float>(size.width) && y >= 0.0f && y < static_cast<float>(size.height)))
    return std::optional<Picked>();
  if (Result<void> done = compile(options); !done) return failAgain(done.error());
  const double width = size.width, height = size.height;
  const double ndc_x = 2.0 * static_cast<double>(x) / width - 1.0,
               ndc_y = 1.0 - 2.0 * static_cast<double>(y) / height;
  // A pixel's width around the point becomes all of clip space, so that textures are sampled as in the
  // picture.
  glm::dmat4 pixel_from_clip(1.0);
  pixel_from_clip[0][0] = width;
  pixel_from_clip[1][1] = height;
  pixel_from_clip[3][0] = -ndc_x * width;
  pixel_from_clip[3][1] = -ndc_y * height;
  const glm::dmat4 clip_from_world = glm::dmat4(view.clip_from_view) * glm::dmat4(view.view_from_world);
  const std::optional<Seen> seen = drawPixel(world, surfaces, glm::mat4(pixel_from_clip * clip_from_world));

  const glm::dmat4 world_from_clip = glm::inverse(clip_from_world);
  const Ray ray = rayThrough(world_from_clip, ndc_x, ndc_y);
  std::optional<Picked> picked;
  double nearest = std::numeric_limits<double>::infinity();
  const streaming::Residency& residency = world.residency();
  if (seen) {
    const streaming::ResidentDraw& draw = residency.draws()[seen->draw];
    const scene::SceneInstance& instance = world.instance(draw.bundle);
    const ecs::Entity entity = instance.draws[draw.index];
    const auto* item = world.registry().tryGet<scene::DrawItem>(entity);
    const glm::dvec4 place =
        world_from_clip * glm::dvec4(ndc_x, ndc_y, 2.0 * static_cast<double>(seen->depth) - 1.0, 1.0);
    const glm::vec3 normal = world.rotationOf(draw.group) * seen->normal_group;
    const float length = glm::length(normal);
    picked =
        Picked{.draw = entity,
               .node = item ? item->node : ecs::Entity{},
               .group = item ? item->group : ecs::Entity{},
               .material = draw.material >= 0 ? instance.materials[static_cast<std::size_t>(draw.material)]
                                              : ecs::Entity{},
               .position_ws = glm::vec3(glm::dvec3(place) / place.w),
               .normal_ws = length > 0.0f ? normal / length : normal};
    nearest = glm::dot(glm::dvec3(picked->position_ws) - ray.origin, ray.direction);
  }
  if (!options.volumes) return picked;
  for (const streaming::ResidentVolume& volume : residency.volumes()) {
    if (!volume.ready()) continue;
    const auto hit =
        enters(ray, glm::dmat4(world.worldFromGroup(volume.group)) * glm::dmat4(volume.grid.group_from_grid),
               volume.grid.size);
    if (!hit || (hit->from_within && picked) || hit->distance >= nearest) continue;
    const streaming::ResidentGroup& group = residency.groups()[volume.group];
    const ecs::Entity entity = world.instance(group.bundle).groups[group.index.value];
    const auto* rigid = world.registry().tryGet<scene::RigidGroupComponent>(entity);
    nearest = hit->distance;
    picked = Picked{.draw = {},
                    .node = rigid ? rigid->node : ecs::Entity{},
                    .group = entity,
                    .material = {},
                    .position_ws = glm::vec3(ray.origin + hit->distance * ray.direction),
                    .normal_ws = glm::vec3(-ray.direction)};
  }
  return picked;
}

}  // namespace lambent::frame
