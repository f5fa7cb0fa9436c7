#include "runtime/debug/data_view.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/debug/overlays.hpp"
#include "runtime/draws/surface_record.hpp"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

namespace {

using evaluate::TransferValue;

// These are the uniform locations and bindings of data_view.glsl.
constexpr GLint kDrawIndex = 0, kRange = 1, kWireColor = 2, kRowsOfDraw = 3, kFirstValue = 4;
constexpr GLuint kBindDataRows = 3, kBindDataValues = 4;

struct CodingErrors {
  std::vector<float> of_cells;  // per cell, the larger error of its transfers of distant light
  // The colour range for surfaces ends here: at twice the requested bound, so that the bound is in the
  // middle; more if an error is larger.
  float range_end = 0.0f;
};

// Collects the errors that the bakes recorded.
CodingErrors errorsOf(const World& world) {
  CodingErrors errors;
  const streaming::Residency& residency = world.residency();
  for (std::uint32_t c = 0; c < residency.cells().size(); ++c) {
    const streaming::ResidentGroup& group = residency.groups()[residency.cells()[c].group];
    const bundle::Cell& cell =
        world.description(group.bundle).groups[group.index.value].cells[c - group.first_cell];
    float error = 0.0f;
    for (const bundle::CellTransfer& transfer : cell.transfers) {
      if (!transfer.fromEnvironment()) continue;
      error = std::max(error, transfer.error);
      if (cell.domain == transfer::Domain::Vertex)
        errors.range_end = std::max({errors.range_end, 2.0f * transfer.error_bound, transfer.error});
    }
    errors.of_cells.push_back(error);
  }
  return errors;
}

// Reads the importance of all samples from their bundles, in the order of TransferValues.
Result<std::vector<evaluate::SampleValue>> importanceOf(const World& world) {
  std::vector<evaluate::SampleValue> values;
  const streaming::Residency& residency = world.residency();
  for (const streaming::ResidentGroup& group : residency.groups())
    for (std::uint32_t c = 0; c < group.cell_count; ++c) {
      const streaming::ResidentCell& cell = residency.cells()[group.first_cell + c];
      if (cell.domain != transfer::Domain::Vertex) continue;
      const auto codes = world.reader(group.bundle).readImportance(group.index, bundle::CellIndex{c});
      if (!codes) return failAgain(codes.error());
      const std::size_t first = values.size();
      values.resize(first + cell.sample_count, {.value_bits = 0, .cluster = evaluate::kNoCluster});
      for (std::size_t s = 0; s < codes->size(); ++s)
        if ((*codes)[s] > 0)
          values[first + s] = {std::bit_cast<std::uint32_t>(bundle::importanceOctaves((*codes)[s])), 0};
    }
  return values;
}

TransferValue valueOf(SurfaceView view) {
  if (view == SurfaceView::Importance) return TransferValue::Given;
  if (view == SurfaceView::TransferDc) return TransferValue::Dc;
  return TransferValue::OfCell;
}

}  // namespace

DataView::DataView(bool numbers)
    : numbers_(numbers),
      programs_(kDebugShaders),
      draws_("data view draws"),
      view_("data view"),
      no_vertices_("data view") {}

Result<void> DataView::update(World& world, const lighting::GroupLights& lights, const ViewChoice& choice,
                              evaluate::TransferMode mode, gpu::Counters& counters) {
  choice_ = choice;
  const CodingErrors errors = errorsOf(world);
  legend_ = legendOf(choice, errors.range_end);
  return values_.update(
      world.residency(), lights, {.value = valueOf(choice.view), .mode = mode}, errors.of_cells,
      [&] { return importanceOf(world); }, counters);
}

Result<void> DataView::draw(World& world, const spec::View& view, gpu::Counters& counters) {
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  return drawAll(world, view, choice_.view == SurfaceView::ClusterIds ? Kind::Clusters : Kind::Values,
                 counters);
}

Result<void> DataView::drawWires(World& world, const spec::View& view, gpu::Counters& counters) {
  gpu::blendPremultiplied();
  glDepthMask(GL_FALSE);
  glEnable(GL_POLYGON_OFFSET_FILL);  // another program drew the surfaces themselves
  glPolygonOffset(-1.0f, -2.0f);
  Result<void> done = drawAll(world, view, Kind::Wires, counters);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  return done;
}

Result<void> DataView::drawPicked(World& world, const spec::View& view, const Surfaces& surfaces) {
  glDisable(GL_BLEND);
  gpu::Counters counters;
  return drawAll(world, view, Kind::Picked, counters, &surfaces);
}

Result<void> DataView::drawAll(World& world, const spec::View& view, Kind kind, gpu::Counters& counters,
                               const Surfaces* shown) {
  const bool values = kind == Kind::Values || kind == Kind::Clusters;
  streaming::Residency& residency = world.residency();
  std::vector<SurfaceDraw> draws;
  for (std::size_t i = 0; i < residency.draws().size(); ++i) draws.push_back(describe(world, i));
  if (draws.empty()) return {};
  draws_.assign(draws, counters);
  view_.assignOne(ViewBlock{view.view_from_world, view.clip_from_view, {}});

  std::vector<gpu::Define> defines = {{values                ? "LAMBENT_VALUES"
                                       : kind == Kind::Wires ? "LAMBENT_WIRES"
                                                             : "LAMBENT_PICKED",
                                       "1"}};
  if (kind == Kind::Clusters) defines.push_back({"LAMBENT_CLUSTERS", "1"});
  if (numbers_) defines.push_back({"LAMBENT_FINEST_TEXELS", "1"});
  if (Result<void> done = programs_.use(
          {{GL_VERTEX_SHADER, "data_view.glsl"}, {GL_FRAGMENT_SHADER, "data_view.glsl"}}, defines);
      !done)
    return done;
  view_.bindUniform(kBindView);
  draws_.bindStorage(kBindDraws);
  if (values) values_.buffer().bindStorage(kBindDataValues);
  glUniform2f(kRange, legend_.min, legend_.max);
  glUniform4f(kWireColor, 0.93f, 0.97f, 1.0f, 0.8f);
  glEnable(GL_CULL_FACE);
  for (std::uint32_t i = 0; i < draws.size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    if (!mesh.block || (shown != nullptr && !shown->shows(i))) continue;
    residency.geometry().page(mesh.block.page).bindStorage(kBindGeometry);
    if (draw.rows)
      residency.rows().page(draw.rows.page).bindStorage(kBindDataRows);
    else
      draws_.bindStorage(kBindDataRows);  // any buffer will do, since nothing is read
    units_.bind(world, texturesOf(world, i, draws[i]));
    const bool mirrored = glm::determinant(glm::mat3(draws[i].world_from_mesh)) < 0.0f;
    glFrontFace(mirrored != draw.back ? GL_CW : GL_CCW);
    glUniform1ui(kDrawIndex, i);
    glUniform4ui(kRowsOfDraw, draw.rows ? draw.rows.word() : kAbsent, draw.row_entries, mesh.vertex_count,
                 mesh.indices_word);
    if (values) glUniform1ui(kFirstValue, values_.firstOf(draw.group));
    no_vertices_.draw(mesh.index_count, counters);
  }
  glFrontFace(GL_CCW);
  glDisable(GL_CULL_FACE);
  units_.unbindSamplers();
  return {};
}

namespace {

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

Result<std::optional<Picker::Seen>> Picker::drawPixel(World& world, const Surfaces& surfaces,
                                                      const spec::View& pixel, bool finest_texels) {
  if (!draws_) {
    seen_ = gpu::Texture("picked", {.format = GL_RGBA32UI});
    depth_ = gpu::Texture("picked depth", {.format = GL_DEPTH_COMPONENT32F});
    target_ = gpu::Framebuffer("pick", seen_, &depth_);
    draws_.emplace(finest_texels);
  }
  target_.bind();
  gpu::testDepth();
  constexpr GLuint kNothing[4] = {~0u, 0, 0, 0};
  glClearNamedFramebufferuiv(target_.id(), GL_COLOR, 0, kNothing);
  target_.clearDepth();
  if (Result<void> done = draws_->drawPicked(world, pixel, surfaces); !done) return failAgain(done.error());
  std::array<GLuint, 4> words{};
  Seen seen;
  glGetTextureImage(seen_.id(), 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, sizeof(words), words.data());
  glGetTextureImage(depth_.id(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, sizeof(seen.depth), &seen.depth);
  if (words[0] == ~0u) return std::optional<Seen>();
  seen.draw = words[0];
  for (int i = 0; i < 3; ++i)
    seen.normal_group[i] = std::bit_cast<float>(words[static_cast<std::size_t>(i) + 1]);
  return std::optional(seen);
}

Result<std::optional<Picked>> Picker::pick(World& world, const Surfaces& surfaces, const spec::View& view,
                                           const PickPoint& point) {
  const auto& [size, x, y, finest_texels, with_volumes] = point;
  if (!(x >= 0.0f && x < static_cast<float>(size.width) && y >= 0.0f && y < static_cast<float>(size.height)))
    return std::optional<Picked>();
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
  spec::View pixel = view;
  pixel.clip_from_view = glm::mat4(pixel_from_clip * glm::dmat4(view.clip_from_view));
  const auto drawn = drawPixel(world, surfaces, pixel, finest_texels);
  if (!drawn) return failAgain(drawn.error());
  const std::optional<Seen>& seen = *drawn;

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
  if (!with_volumes) return picked;
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
