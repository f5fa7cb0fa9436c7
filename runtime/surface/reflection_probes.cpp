#include "runtime/surface/reflection_probes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/draws/surface_record.hpp"
#include "runtime/lighting/prefiltered_shared.h"
#include "runtime/surface/reflection_probes_shared.h"
#include "runtime/surface/surfaces.hpp"

namespace lambent::frame {

namespace {

constexpr SurfaceFunction kSpecular[] = {
    {SurfaceHook::MirroredSky, CalledBy::Ggx, "specular_environment.glsl", "addSpecularEnvironment"},
    {SurfaceHook::MirroredSky, CalledBy::Layered, "specular_environment.glsl", "addLayeredEnvironment"}};
constexpr SurfaceFunction kProbes[] = {
    {SurfaceHook::MirroredSky, CalledBy::Ggx, "reflection_probes.glsl", "addGlossyProbes"},
    {SurfaceHook::MirroredSky, CalledBy::Layered, "reflection_probes.glsl", "addLayeredProbes"}};

constexpr GLint kFromMesh = 0, kCount = 1, kMesh = 2;  // uniform locations of surface_voxels.comp

static_assert(kProbeLevels == lighting::kReflectedLevels, "reflection_probes.glsl uses levelOf()");
static_assert(kProbeShares == lighting::kLobeShares);

// These are the uniform locations of the kernels of probes.
constexpr GLint kFace = 0, kImageLayer = 1, kDistanceLayer = 2, kProjection = 3;
constexpr GLint kSize = 0, kLobe = 1, kShares = 2, kFirstLayer = 3;
constexpr std::uint32_t kProbeFaceTexels = 128;  // along an edge of a face
constexpr std::uint32_t kLevels = std::bit_width(kProbeFaceTexels);

// Returns the number of samples of the lobe: more where it is wide.
GLint sharesOf(std::uint32_t level) {
  return level <= 1 ? 32 : 64;
}

std::uint32_t groupsOf(std::uint32_t texels) {
  return (texels + kProbeGroup - 1) / kProbeGroup;
}

// Returns the view of a face of a cube map about a point. Its pixels are the face's texels, in the same
// order.
spec::View probeFaceView(const glm::vec3& place_ws, int face, float near_m, float far_m) {
  // The axes of texels are those of runtime/sh/image_layout.hpp. Row 0 of a picture is at the bottom, so "up"
  // is where rows of the face go.
  static constexpr std::array<glm::vec3, 6> kForward = {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0),
                                                        glm::vec3(0, 1, 0), glm::vec3(0, -1, 0),
                                                        glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)};
  static constexpr std::array<glm::vec3, 6> kUp = {glm::vec3(0, -1, 0), glm::vec3(0, -1, 0),
                                                   glm::vec3(0, 0, 1),  glm::vec3(0, 0, -1),
                                                   glm::vec3(0, -1, 0), glm::vec3(0, -1, 0)};
  const auto at = static_cast<std::size_t>(face);
  return {.view_from_world = glm::lookAt(place_ws, place_ws + kForward[at], kUp[at]),
          .clip_from_view = glm::perspective(glm::radians(90.0f), 1.0f, near_m, far_m),
          .eye_ws = place_ws};
}

}  // namespace

Result<lighting::SurfaceVoxels> ReflectionProbes::voxelsOf(World& world, std::size_t group,
                                                           gpu::Counters& counters) {
  if (Result<void> done = kernels_.use("surface_voxels.comp"); !done) return failAgain(done.error());
  const scene::Box& box = world.groupBounds(group);
  lighting::SurfaceVoxels voxels = lighting::SurfaceVoxels::over(box.min, box.max);
  gpu::Table words("surface voxels");
  words.assign(voxels.words);
  words.bindStorage(kBindVoxelWords);
  glUniform3i(kCount, voxels.count.x, voxels.count.y, voxels.count.z);
  const glm::mat4 voxels_from_world = glm::scale(glm::mat4(1.0f), glm::vec3(1.0f / voxels.edge_m)) *
                                      glm::translate(glm::mat4(1.0f), -voxels.origin) *
                                      glm::inverse(world.worldFromGroup(group));
  const streaming::Residency& residency = world.residency();
  for (std::size_t i = 0; i < residency.draws().size(); ++i) {
    const streaming::ResidentDraw& draw = residency.draws()[i];
    const streaming::ResidentMesh& mesh = residency.meshes()[draw.mesh];
    if (draw.group != group || !mesh.block) continue;
    world.residency().geometry().page(mesh.block.page).bindStorage(kBindVoxelGeometry);
    const glm::mat4 from_mesh = voxels_from_world * frame::describe(world, i).world_from_mesh;
    // Mirrored nodes reverse the winding, and so do the backs of double-sided surfaces.
    const bool over = (glm::determinant(glm::mat3(from_mesh)) < 0.0f) != draw.back;
    const std::uint32_t triangles = mesh.index_count / 3;
    glUniformMatrix4fv(kFromMesh, 1, GL_FALSE, glm::value_ptr(from_mesh));
    glUniform4ui(kMesh, mesh.positions_word, mesh.indices_word, triangles, over ? 1 : 0);
    glDispatchCompute((triangles + kVoxelGroup - 1) / kVoxelGroup, 1, 1);
    ++counters.dispatches;
  }
  words.buffer().read(0, std::span(voxels.words));
  return voxels;
}

ReflectionProbes::ReflectionProbes(const SpecularEnvironmentModule& environment)
    : SurfaceModule(kProbes),
      environment_(environment),
      kernels_(kSurfaceShaders),
      block_("reflection probes"),
      angles_("probe lobe") {
  for (std::uint32_t level = 0; level < kProbeLevels; ++level)
    lobes_.push_back(lighting::makeReflectedLobe(lighting::roughnessOfLevel(level, kProbeLevels)));
}

void ReflectionProbes::place(std::vector<glm::vec3> places_ws) {
  if (places_ws.size() > kMostProbes) places_ws.resize(kMostProbes);
  if (places_ws == places_) return;
  if (places_ws.size() != places_.size()) {
    images_ = {};
    captured_.clear();
    ++layout_version_;
  }
  std::vector<std::uint8_t> captured(places_ws.size(), 0);
  for (std::size_t i = 0; i < captured_.size(); ++i)
    captured[i] = captured_[i] != 0 && places_[i] == places_ws[i] ? 1 : 0;
  captured_ = std::move(captured);
  places_ = std::move(places_ws);
  if (places_.empty()) {
    target_ = {};
    for (gpu::Texture* const texture : {&drawn_, &depth_, &weighted_, &weights_}) *texture = {};
    return;
  }
  if (!images_) makeTargets();
  uploadBlock(/*looked_up=*/true);
}

void ReflectionProbes::showBy(std::vector<std::uint8_t> draws) {
  if (draws == draws_) return;
  draws_ = std::move(draws);
  ++layout_version_;
}

void ReflectionProbes::makeTargets() {
  const auto count = static_cast<std::uint32_t>(places_.size());
  const auto target = [](GLenum format) {
    return gpu::TextureDesc{.format = format, .width = kProbeFaceTexels, .height = kProbeFaceTexels};
  };
  drawn_ = gpu::Texture("probe face", target(GL_RGBA16F));
  depth_ = gpu::Texture("probe depth", target(GL_DEPTH_COMPONENT32F));
  target_ = gpu::Framebuffer("probe face", drawn_, &depth_);
  gpu::TextureDesc cube = target(GL_RGBA16F);
  cube.cube = true;
  cube.levels = kLevels;
  weighted_ = gpu::Texture("probe to filter", cube);
  cube.format = GL_R16F;
  weights_ = gpu::Texture("probe weights", cube);
  images_ = gpu::Texture("reflection probes", {.format = GL_RGBA16F,
                                               .width = kProbeFaceTexels,
                                               .height = kProbeFaceTexels,
                                               .levels = kProbeLevels,
                                               .cube = true,
                                               .layers = 2 * count});
  for (const gpu::Texture* const texture : {&weighted_, &weights_, &images_}) {
    glTextureParameteri(texture->id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture->id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  }
}

void ReflectionProbes::uploadBlock(bool looked_up) {
  ProbeValues values{};
  values.counts = {static_cast<float>(places_.size()), looked_up ? 1.0f : 0.0f, 0.0f, 0.0f};
  for (std::size_t i = 0; i < places_.size(); ++i)
    values.places[i] = glm::vec4(places_[i], captured_[i] != 0 ? 1.0f : 0.0f);
  block_.assignOne(values);
}

Result<void> ReflectionProbes::capture(
    std::size_t probe, float near_m, float far_m,
    const std::function<Result<void>(const spec::View&, const spec::Size&)>& draw, gpu::Counters& counters) {
  const spec::Size size{kProbeFaceTexels, kProbeFaceTexels};
  uploadBlock(/*looked_up=*/false);
  for (int face = 0; face < 6; ++face) {
    const spec::View view = probeFaceView(places_[probe], face, near_m, far_m);
    target_.bind();
    gpu::testDepth();
    target_.clearColor({});
    target_.clearDepth();
    if (Result<void> done = draw(view, size); !done) return done;
    if (Result<void> done = store(probe, face, view.clip_from_view, counters); !done) return done;
  }
  if (Result<void> done = filter(probe, counters); !done) return done;
  captured_[probe] = 1;
  uploadBlock(/*looked_up=*/true);
  return {};
}

Result<void> ReflectionProbes::store(std::size_t probe, int face, const glm::mat4& clip_from_view,
                                     gpu::Counters& counters) {
  const auto layer = static_cast<GLint>(6 * probe) + face;
  if (Result<void> done = kernels_.use("reflection_probe.comp", {{"LAMBENT_STORE", "1"}}); !done) return done;
  drawn_.bind(0);
  depth_.bind(1);
  glUniform1i(kFace, face);
  glUniform1i(kImageLayer, layer);
  glUniform1i(kDistanceLayer, layer + static_cast<GLint>(6 * places_.size()));
  // With z_clip = a z + b and w = -z, the depth -z is b / (z_ndc + a).
  glUniform2f(kProjection, clip_from_view[3][2], clip_from_view[2][2]);
  glBindImageTexture(0, images_.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
  glBindImageTexture(1, weighted_.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
  glBindImageTexture(2, weights_.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R16F);
  glMemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  glDispatchCompute(groupsOf(kProbeFaceTexels), groupsOf(kProbeFaceTexels), 1);
  ++counters.dispatches;
  return {};
}

Result<void> ReflectionProbes::filter(std::size_t probe, gpu::Counters& counters) {
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                  GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  glGenerateTextureMipmap(weighted_.id());
  glGenerateTextureMipmap(weights_.id());
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  if (Result<void> done = kernels_.use("reflection_probe.comp"); !done) return done;
  weighted_.bind(0);
  weights_.bind(1);
  for (std::uint32_t level = 1; level < kProbeLevels; ++level) {
    const std::uint32_t side = kProbeFaceTexels >> level;
    angles_.assign(lobes_[level].angles_rad);
    angles_.bindStorage(kBindProbeLobe);
    glUniform1i(kSize, static_cast<GLint>(side));
    glUniform2f(kLobe, lobes_[level].alpha, lobes_[level].scale);
    glUniform1i(kShares, sharesOf(level));
    glUniform1i(kFirstLayer, static_cast<GLint>(6 * probe));
    glBindImageTexture(0, images_.id(), static_cast<GLint>(level), GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    glDispatchCompute(groupsOf(side), groupsOf(side), 6);
    ++counters.dispatches;
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return {};
}

void ReflectionProbes::bindFor(SurfaceReceiver receiver) const {
  const GLuint unit = isLayered(receiver) ? kUnitProbesLayered : kUnitProbesGlossy;
  block_.bindUniform(kBindProbes);
  images_.bind(unit);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
}

SpecularEnvironmentModule::SpecularEnvironmentModule(
    const std::optional<lighting::PrefilteredEnvironment>& environment, const bool& shown)
    : SurfaceModule(kSpecular), environment_(environment), on_(shown) {}

}  // namespace lambent::frame
