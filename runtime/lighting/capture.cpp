#include "runtime/lighting/capture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <unordered_map>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "runtime/base/finite.hpp"
#include "runtime/base/threads.hpp"
#include "runtime/lighting/capture_plan.hpp"
#include "runtime/lighting/capture_shared.h"
#include "runtime/lighting/sky.hpp"
#include "runtime/sh/image_layout.hpp"

namespace lambent::lighting {

namespace capture {

// Holds what a light capture keeps of a proxy: its bounds, and its levels in the form in which they are
// drawn. It is made once per proxy and from that proxy alone, so that it stays valid when other proxies come
// and go. No GL.
struct PreparedProxy {
  // A vertex is its position as bits of three floats, then its surface id: the triangle's number in its proxy
  // + 1, or 0 for a vertex that is no triangle's last corner.
  using Vertex = std::array<std::uint32_t, 4>;
  struct Level {
    std::uint32_t first_vertex = 0;  // index into `vertices`
    // Three indices of vertices of the level per triangle, the triangles that are seen from one side only
    // last.
    std::vector<std::uint32_t> indices;
    std::size_t front_only = 0;  // the first index of those
  };
  ProxyBounds bounds;
  std::vector<Level> levels;
  std::vector<Vertex> vertices;
  std::uint32_t triangle_count = 0;

  static PreparedProxy of(const bundle::CaptureProxy& proxy);
};

// In the worst case each triangle has three corners of its own.
static_assert(3 * bundle::kMaxProxyTriangles <= 1u << kVertexBits);

// A triangle's id comes from its last corner, so each triangle needs a corner that is last in no other.
// Closed meshes have half as many vertices as triangles, so about half of the triangles need an extra vertex.
PreparedProxy PreparedProxy::of(const bundle::CaptureProxy& proxy) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  PreparedProxy made{.bounds = ProxyBounds::of(proxy),
                     .levels = {},
                     .vertices = {},
                     .triangle_count = static_cast<std::uint32_t>(proxy.triangles.size())};
  for (const bundle::ProxyLevel& level : proxy.levels) {
    const std::size_t first = made.vertices.size();
    Level& drawn = made.levels.emplace_back();
    drawn.first_vertex = static_cast<std::uint32_t>(first);
    std::vector<std::uint32_t> shared(proxy.positions.size(), kNone);  // the vertex at each position
    const auto make = [&](std::uint32_t corner) {
      const glm::vec3& p = proxy.positions[corner];
      made.vertices.push_back({std::bit_cast<std::uint32_t>(p.x), std::bit_cast<std::uint32_t>(p.y),
                               std::bit_cast<std::uint32_t>(p.z), 0});
      return static_cast<std::uint32_t>(made.vertices.size() - 1 - first);
    };
    const auto share = [&](std::uint32_t corner) {
      if (shared[corner] == kNone) shared[corner] = make(corner);
      return shared[corner];
    };
    const auto isFree = [&](std::uint32_t corner) {
      return shared[corner] == kNone || made.vertices[first + shared[corner]][3] == 0;
    };
    std::vector<std::uint32_t> front_only;
    for (std::uint32_t t = level.first_triangle; t < level.first_triangle + level.triangle_count; ++t) {
      const bundle::ProxyTriangle& triangle = proxy.triangles[t];
      const auto usable = [&](std::uint32_t v) { return isFinite(proxy.positions[v]); };
      if (!std::ranges::all_of(triangle.vertices, usable)) continue;
      std::array<std::uint32_t, 3> corners = triangle.vertices;
      for (int turn = 0; turn < 3 && !isFree(corners[2]); ++turn)
        std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      const std::uint32_t last = isFree(corners[2]) ? share(corners[2]) : make(corners[2]);
      made.vertices[first + last][3] = t + 1;
      std::vector<std::uint32_t>& indices = triangle.front_only ? front_only : drawn.indices;
      for (const std::uint32_t vertex : {share(corners[0]), share(corners[1]), last})
        indices.push_back(vertex);
    }
    drawn.front_only = drawn.indices.size();
    drawn.indices.insert(drawn.indices.end(), front_only.begin(), front_only.end());
  }
  return made;
}

}  // namespace capture

namespace {

using namespace capture;

// These are the uniform locations of capture.vert, capture_resolve.comp and capture_project.comp.
constexpr GLint kClipFromPixel = 0, kDepth = 1;
constexpr GLint kFirstTexel = 0, kTexelCount = 1, kFirstWord = 2, kWordCount = 3, kSubsamples = 4;
constexpr GLint kFirstPoint = 0;
constexpr std::uint32_t kNoRecord = 0xffffffffu;

void put(float (&row)[4], const glm::dvec4& value) {
  for (int i = 0; i < 4; ++i) row[i] = static_cast<float>(value[i]);
}

DrawRecord drawRecord(const CaptureOptions& options, const Tile& tile, const CaptureBody& body,
                      const PlannedPoint& planned, const glm::vec3& point_ws, std::uint32_t page_height) {
  glm::dmat4 point_from_proxy(body.world_from_proxy);
  point_from_proxy[3] -= glm::dvec4(glm::dvec3(point_ws), 0.0);
  // Rows give face coordinates, x = sc w and y = tc w, in units of the near plane's distance.
  const glm::dmat4 rows = glm::transpose(glm::dmat4(faceFromWorld(tile.face)) * point_from_proxy) *
                          (1.0 / double{planned.near_m});
  // The face's square is scaled and moved so that the tile lands in its place in the atlas.
  const double face_pixels = options.size * options.subsamples;
  const auto placed = [&](const glm::dvec4& along, std::uint32_t at, std::uint32_t texel,
                          double atlas_pixels) {
    const double offset = 2.0 * (1.0 * at - 1.0 * texel * options.subsamples) + face_pixels;
    return along * (face_pixels / atlas_pixels) + rows[2] * (offset / atlas_pixels - 1);
  };
  DrawRecord record{};
  put(record.clip_x, placed(rows[0], tile.x, tile.texels.x0, kAtlasWidth));
  put(record.clip_y, placed(rows[1], tile.y, tile.texels.y0, page_height));
  put(record.clip_w, rows[2]);
  record.tile_x = tile.x | (tile.x + tile.texels.width() * options.subsamples) << 16;
  record.tile_y = tile.y | (tile.y + tile.texels.height() * options.subsamples) << 16;
  return record;
}

}  // namespace

Capture::Capture(const CaptureOptions& options)
    : options_(options),
      vertices_("capture vertices"),
      draws_("capture draws"),
      indices_("capture indices"),
      points_("capture points"),
      texels_("capture texels"),
      values_("capture values"),
      lookups_("capture lookups"),
      results_("capture results"),
      hidden_("capture hidden lights") {}

Result<Capture> Capture::create(const CaptureOptions& options, const Environment& environment) {
  Capture capture(options);
  // The layout is [texel][coefficient], padded to vec4s because the shaders fetch four at a time.
  const std::vector<float> weights = sh::cubeWeights(options.order, static_cast<int>(options.size));
  const std::size_t count = static_cast<std::size_t>(sh::coefficientCount(options.order)),
                    texels = weights.size() / count, stride = (count + 3) / 4 * 4;
  std::vector<float> by_texel(texels * stride);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < texels; ++k) by_texel[k * stride + i] = weights[i * texels + k];
  capture.weights_ = gpu::Buffer("capture weights", by_texel.size() * sizeof(float));
  capture.weights_.write(0, std::span<const float>(by_texel));
  auto sky = CaptureSky::create(options, environment);
  if (!sky) return failAgain(sky.error());
  capture.sky_ = std::move(*sky);
  auto draw = gpu::Program::create("capture",
                                   {{GL_VERTEX_SHADER, "capture.vert"}, {GL_FRAGMENT_SHADER, "capture.frag"}},
                                   kLightingShaders);
  if (!draw) return failAgain(draw.error());
  capture.draw_program_ = std::move(*draw);
  auto resolve = gpu::Program::create("capture resolve", {{GL_COMPUTE_SHADER, "capture_resolve.comp"}},
                                      kLightingShaders);
  if (!resolve) return failAgain(resolve.error());
  capture.resolve_program_ = std::move(*resolve);
  const gpu::Define order{"ORDER", std::to_string(options.order)};
  auto project = gpu::Program::create("capture projection", {{GL_COMPUTE_SHADER, "capture_project.comp"}},
                                      kLightingShaders, std::span(&order, 1));
  if (!project) return failAgain(project.error());
  capture.project_program_ = std::move(*project);
  capture.array_ = gpu::VertexArray("capture");
  return capture;
}

void Capture::setProxies(std::span<const bundle::CaptureProxy* const> proxies, gpu::Counters& counters,
                         std::span<const std::uint64_t> keys) {
  std::unordered_map<std::uint64_t, std::shared_ptr<const PreparedProxy>> known;
  for (const Proxy& proxy : proxies_)
    if (proxy.key) known.emplace(*proxy.key, proxy.prepared);
  proxies_.assign(proxies.size(), {});
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < proxies.size(); ++i) {
    if (!keys.empty()) proxies_[i].key = keys[i];
    const auto found = keys.empty() ? known.end() : known.find(keys[i]);
    if (found != known.end())
      proxies_[i].prepared = found->second;
    else
      unknown.push_back(i);
  }
  constexpr std::size_t kWorthAThread = 2;  // each takes a tenth of a millisecond or more
  inParallel(unknown.size(), kWorthAThread, [&](std::size_t i) {
    proxies_[unknown[i]].prepared =
        std::make_shared<const PreparedProxy>(PreparedProxy::of(*proxies[unknown[i]]));
  });
  bounds_.clear();
  triangle_count_ = 0;
  std::vector<PreparedProxy::Vertex> vertices;
  for (Proxy& made : proxies_) {
    made.first_triangle = triangle_count_;
    made.first_vertex = static_cast<std::uint32_t>(vertices.size());
    for (PreparedProxy::Vertex vertex : made.prepared->vertices) {
      if (vertex[3] != 0) vertex[3] += triangle_count_;
      vertices.push_back(vertex);
    }
    bounds_.push_back(made.prepared->bounds);
    triangle_count_ += made.prepared->triangle_count;
  }
  vertices_.assign(std::span<const PreparedProxy::Vertex>(vertices));
  counters.uploaded_bytes += vertices.size() * sizeof(PreparedProxy::Vertex);
}

capture::BodySphere Capture::sphereOf(const CaptureBody& body) const {
  return body.proxy < bounds_.size() ? capture::BodySphere::of(body, bounds_[body.proxy]) : BodySphere{};
}

Result<void> Capture::run(const Environment& environment, std::span<const CaptureBody> bodies,
                          std::span<const CapturePoint> points, const gpu::Buffer& triangle_radiance,
                          gpu::Counters& counters) {
  if (pending_) return fail("light capture", "started again before the last one was taken");
  if (triangle_radiance.byteCount() < std::size_t{triangle_count_} * sizeof(glm::vec4))
    return fail("light capture", "fewer radiances than the proxies have triangles");
  const gpu::DebugGroup group("light capture");
  sky_is_new_ = sky_.update(environment, weights_, counters) || sky_is_new_;
  const Plan plan = capture::plan(options_, bounds_, bodies, points);

  if (plan.draws.size() >= std::size_t{1} << (32 - kVertexBits))
    return fail("light capture", "more than two million bodies to draw", "capture fewer points at a time");

  run_ = {};
  run_.points.assign(points.begin(), points.end());
  run_.sky = environment.skyLight().truncated(options_.order);
  run_.records.assign(points.size(), kNoRecord);
  for (std::uint32_t r = 0; r < plan.points.size(); ++r) run_.records[plan.points[r].point] = r;
  load_ = {};
  pending_ = true;
  if (plan.points.empty()) return {};

  upload(plan, bodies, points, counters);
  for (std::size_t i = 0; i < plan.pages.size(); ++i) {
    drawPage(plan.pages[i], i, counters);
    projectPage(plan.pages[i], triangle_radiance, counters);
  }
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  const std::size_t result_bytes = plan.points.size() * 2 *
                                   static_cast<std::size_t>(sh::coefficientCount(options_.order)) *
                                   sizeof(glm::vec4),
                    hidden_bytes = run_.word_count * sizeof(std::uint32_t);
  readback_.start(result_bytes + hidden_bytes + sky_.light().byteCount());
  run_.results_at = readback_.copy(results_.buffer(), result_bytes);
  run_.hidden_at = readback_.copy(hidden_.buffer(), hidden_bytes);
  run_.new_sky = std::exchange(sky_is_new_, false);
  if (run_.new_sky) run_.sky_at = readback_.copy(sky_.light(), sky_.light().byteCount());
  readback_.finish();
  return {};
}

// Uploads the tables of all pages at once.
void Capture::upload(const Plan& plan, std::span<const CaptureBody> bodies,
                     std::span<const CapturePoint> points, gpu::Counters& counters) {
  load_ = {.pages = static_cast<std::uint32_t>(plan.pages.size()),
           .points = static_cast<std::uint32_t>(plan.points.size()),
           .draws = static_cast<std::uint32_t>(plan.draws.size())};
  std::vector<PointRecord> records;
  std::vector<TexelRecord> texels;
  std::vector<Lookup> lookups;
  const std::uint32_t size = options_.size, subsamples = options_.subsamples;
  for (const PlannedPoint& planned : plan.points) {
    PointRecord& record = records.emplace_back();
    record.first_texel = static_cast<std::uint32_t>(texels.size());
    for (std::uint32_t t = planned.first_tile; t < planned.first_tile + planned.tile_count; ++t) {
      const Tile& tile = plan.tiles[t];
      for (std::uint32_t y = tile.texels.y0; y < tile.texels.y1; ++y)
        for (std::uint32_t x = tile.texels.x0; x < tile.texels.x1; ++x)
          texels.push_back({(tile.x + (x - tile.texels.x0) * subsamples) |
                                (tile.y + (y - tile.texels.y0) * subsamples) << 16,
                            (tile.face * size + y) * size + x});
    }
    record.texel_count = static_cast<std::uint32_t>(texels.size()) - record.first_texel;
    run_.first_texels.push_back(record.first_texel);
    run_.first_words.push_back(static_cast<std::uint32_t>(lookups.size() / kLookupsPerWord));
    appendLookups(size, subsamples, planned, plan.tiles, points[planned.point], lookups);
    run_.uncovered.push_back(6 * size * size - record.texel_count);
  }
  run_.first_texels.push_back(static_cast<std::uint32_t>(texels.size()));
  run_.first_words.push_back(static_cast<std::uint32_t>(lookups.size() / kLookupsPerWord));
  run_.word_count = lookups.size() / kLookupsPerWord;

  std::vector<DrawRecord> draws;
  std::vector<std::uint32_t>&indices = indices_of_draws_, &front_only = front_only_;
  indices.clear();
  draws.reserve(plan.draws.size());
  page_indices_.clear();
  for (const Page& page : plan.pages) {
    front_only.clear();
    PageIndices& range = page_indices_.emplace_back();
    range.first = static_cast<std::uint32_t>(indices.size());
    for (std::uint32_t d = page.first_draw; d < page.first_draw + page.draw_count; ++d) {
      const Draw& draw = plan.draws[d];
      const Tile& tile = plan.tiles[draw.tile];
      const Proxy& proxy = proxies_[bodies[draw.body].proxy];
      const PreparedProxy::Level& level = proxy.prepared->levels[draw.level];
      DrawRecord& record = draws.emplace_back(drawRecord(options_, tile, bodies[draw.body],
                                                         plan.points[run_.records[tile.point]],
                                                         points[tile.point].position_ws, page.height));
      record.first_vertex = proxy.first_vertex + level.first_vertex;
      for (std::size_t i = 0; i < level.indices.size(); ++i)
        (i < level.front_only ? indices : front_only).push_back(d << kVertexBits | level.indices[i]);
    }
    range.front_only = static_cast<std::uint32_t>(indices.size());
    indices.insert(indices.end(), front_only.begin(), front_only.end());
    range.end = static_cast<std::uint32_t>(indices.size());
  }

  const auto give = [&](gpu::Table& table, auto& values) {
    table.assign(std::span(std::as_const(values)));
    counters.uploaded_bytes += std::span(values).size_bytes();
  };
  give(points_, records);
  give(texels_, texels);
  give(lookups_, lookups);
  give(draws_, draws);
  give(indices_, indices);
  results_.reserve(records.size() * 2 * static_cast<std::size_t>(sh::coefficientCount(options_.order)) *
                   sizeof(glm::vec4));
  values_.reserve(texels.size() * sizeof(glm::vec4));
  hidden_.reserve(run_.word_count * sizeof(std::uint32_t));
}

void Capture::drawPage(const Page& page, std::size_t index, gpu::Counters& counters) {
  // The atlas is as high as the largest page so far.
  if (!ids_ || ids_.desc().height < page.height) {
    const std::uint32_t height = std::bit_ceil(page.height);
    ids_ = gpu::Texture("capture ids", {.format = GL_R32UI, .width = kAtlasWidth, .height = height});
    depths_ = gpu::Texture("capture depths",
                           {.format = GL_DEPTH_COMPONENT32F, .width = kAtlasWidth, .height = height});
    // Integer textures are incomplete with the linear filters that textures are created with.
    for (const gpu::Texture* texture : {&ids_, &depths_}) {
      glTextureParameteri(texture->id(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      glTextureParameteri(texture->id(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    atlas_ = gpu::Framebuffer("capture atlas", ids_, &depths_);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, atlas_.id());
  glViewport(0, 0, static_cast<GLsizei>(kAtlasWidth), static_cast<GLsizei>(page.height));
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  for (GLenum i = 0; i < 4; ++i) glEnable(GL_CLIP_DISTANCE0 + i);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_TRUE);
  glDisable(GL_BLEND);
  glEnable(GL_SCISSOR_TEST);
  glScissor(0, 0, static_cast<GLsizei>(kAtlasWidth), static_cast<GLsizei>(page.height));
  constexpr GLuint kNothing[4] = {0, 0, 0, 0};
  constexpr GLfloat kFar = 0.0f;
  glClearBufferuiv(GL_COLOR, 0, kNothing);
  glClearBufferfv(GL_DEPTH, 0, &kFar);
  glDisable(GL_SCISSOR_TEST);

  draw_program_.use();
  glBindVertexArray(array_.id());
  glVertexArrayElementBuffer(array_.id(), indices_.buffer().id());
  bindTable(vertices_view_, kUnitVertices, GL_RGBA32UI, vertices_.buffer());
  bindTable(draws_view_, kUnitDraws, GL_RGBA32UI, draws_.buffer());
  glUniform2f(kClipFromPixel, 2.0f / static_cast<float>(kAtlasWidth), 2.0f / static_cast<float>(page.height));
  // A dark side that coincides with a bright one, as in a fold of a simplified surface, must not show through
  // it.
  constexpr float kDarkDepth = 0.9999f;
  const PageIndices& range = page_indices_[index];
  const auto draw = [&](GLenum culled, std::uint32_t end, float depth) {
    if (range.first == end) return;
    glCullFace(culled);
    glUniform1f(kDepth, depth);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(end - range.first), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(std::size_t{range.first} * sizeof(std::uint32_t)));
    ++counters.draws;
    ++counters.draw_calls;
  };
  glEnable(GL_CULL_FACE);
  draw(GL_BACK, range.end, 1.0f);
  draw(GL_FRONT, range.front_only, kDarkDepth);
  glCullFace(GL_BACK);
  glDisable(GL_CULL_FACE);
  glDepthFunc(GL_LESS);
  for (GLenum i = 0; i < 4; ++i) glDisable(GL_CLIP_DISTANCE0 + i);
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void Capture::projectPage(const Page& page, const gpu::Buffer& triangle_radiance, gpu::Counters& counters) {
  const std::uint32_t end_point = page.first_point + page.point_count;
  const std::uint32_t first_texel = run_.first_texels[page.first_point],
                      texel_count = run_.first_texels[end_point] - first_texel,
                      first_word = run_.first_words[page.first_point],
                      word_count = run_.first_words[end_point] - first_word;
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);  // the caller may have shaded the triangles in a shader
  resolve_program_.use();
  glUniform1ui(kFirstTexel, first_texel);
  glUniform1ui(kTexelCount, texel_count);
  glUniform1ui(kFirstWord, first_word);
  glUniform1ui(kWordCount, word_count);
  glUniform1ui(kSubsamples, options_.subsamples);
  ids_.bind(kUnitIds);
  depths_.bind(kUnitDepth);
  for (const GLuint unit : {kUnitIds, kUnitDepth}) glBindSampler(unit, 0);
  texels_.bindStorage(kBindTexels);
  triangle_radiance.bindStorage(kBindRadiance);
  values_.bindStorage(kBindValues);
  lookups_.bindStorage(kBindLookups);
  hidden_.bindStorage(kBindHidden);
  glDispatchCompute((texel_count + word_count + kWorkGroupSize - 1) / kWorkGroupSize, 1, 1);

  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  project_program_.use();
  glUniform1ui(kFirstPoint, page.first_point);
  bindTable(values_view_, kUnitValues, GL_RGBA32F, values_.buffer());
  bindTable(texels_view_, kUnitTexels, GL_RG32UI, texels_.buffer());
  sky_.bindTables(weights_);
  points_.bindStorage(kBindPoints);
  results_.bindStorage(kBindResults);
  glDispatchCompute(page.point_count, 1, 1);
  counters.dispatches += 2;
}

std::optional<std::vector<CapturedLight>> Capture::take(bool wait) {
  if (!pending_ || !readback_.arrived(wait)) return std::nullopt;
  pending_ = false;
  const auto count = static_cast<std::size_t>(sh::coefficientCount(options_.order));
  std::vector<glm::vec4> results(run_.uncovered.size() * 2 * count);
  std::vector<std::uint32_t> hidden(run_.word_count);
  if (!results.empty()) {
    readback_.read(run_.results_at, std::span(results));
    readback_.read(run_.hidden_at, std::span(hidden));
  }
  if (run_.new_sky) {
    std::vector<glm::vec4> sky(count);
    readback_.read(run_.sky_at, std::span(sky));
    sky_through_texels_ = lightFrom(sky);
  }

  std::vector<CapturedLight> lights(run_.points.size());
  for (std::size_t p = 0; p < lights.size(); ++p) {
    CapturedLight& out = lights[p];
    const CapturePoint& point = run_.points[p];
    out.light = run_.sky;
    out.visible.assign(point.queries.size(), 1.0f);
    const std::uint32_t record = run_.records[p];
    if (record == kNoRecord) continue;
    const std::span<const glm::vec4> sums = std::span(results).subspan(record * 2 * count, 2 * count);
    combine(sums, run_.uncovered[record], run_.sky, sky_through_texels_, out);
    for (std::size_t q = 0; q < point.queries.size(); ++q)
      out.visible[q] = visibleShare(point.queries[q], hidden[run_.first_words[record] + q]);
  }
  return lights;
}

sh::LightVector Capture::lightFrom(std::span<const glm::vec4> coefficients) const {
  sh::LightVector light{.order = options_.order};
  std::copy(coefficients.begin(), coefficients.end(), light.c.begin());
  return light;
}

}  // namespace lambent::lighting
