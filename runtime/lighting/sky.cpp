#include "runtime/lighting/sky.hpp"

#include <algorithm>
#include <bit>
#include <future>

#include <glm/common.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "lambent_lighting_embedded.hpp"
#include "runtime/sh/image_layout.hpp"

namespace lambent::lighting {

const gpu::FindText kLightingShaders[1] = {&embedded::lambent_lighting::find};

namespace {

constexpr float kLargestHalf = 65504.0f;

// These are the binding and the uniform locations of sky.frag.
constexpr GLuint kBindSkyDiscs = 0;
constexpr GLint kWorldFromClip = 0, kLightFromWorld = 1, kDiscCount = 2, kPixelAngle = 3, kShares = 4;
struct DiscRecord {
  glm::vec4 direction_and_radius;  // lights' own frame; w: radius in radians
  glm::vec3 radiance;
  float set;
};
static_assert(sizeof(DiscRecord) == 32);

// Returns a size with about one texel of the cube per texel of the environment map; a constant needs only
// one. The size is a power of two because reflections read mip levels, and halving an odd size drops a row of
// texels, in which a lamp may stand.
std::uint32_t cubeSize(std::span<const spec::EnvironmentMap* const> environment_maps) {
  std::uint32_t size = 1;
  for (const spec::EnvironmentMap* environment_map : environment_maps) {
    const std::uint32_t width = environment_map->image.width;
    const std::uint32_t wanted =
        environment_map->layout == sh::ImageLayout::VerticalCross ? width / 3 : width / 4;
    size = std::max(size, std::bit_ceil(std::clamp(wanted, 16u, 1024u)));
  }
  return size;
}

std::vector<std::uint64_t> faceTexels(std::span<const spec::EnvironmentMap* const> environment_maps,
                                      glm::vec3 constant, int face, std::uint32_t size) {
  std::vector<std::uint64_t> texels;
  texels.reserve(std::size_t{size} * size);
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const glm::vec3 dir =
          sh::cubeTexelDirection(static_cast<int>(size), face, static_cast<int>(x), static_cast<int>(y));
      glm::vec3 sum = constant;
      for (const spec::EnvironmentMap* environment_map : environment_maps)
        sum += spec::radiance(*environment_map, dir);
      texels.push_back(glm::packHalf4x16(glm::vec4(glm::min(sum, glm::vec3(kLargestHalf)), 0.0f)));
    }
  return texels;
}

}  // namespace

gpu::Texture skyCube(std::span<const spec::EnvironmentMap* const> environment_maps, glm::vec3 constant) {
  const std::uint32_t size = cubeSize(environment_maps);
  gpu::Texture cube("sky", {.format = GL_RGBA16F, .width = size, .height = size, .cube = true});
  std::vector<std::future<std::vector<std::uint64_t>>> faces;
  for (int face = 0; face < 6; ++face)
    faces.push_back(std::async(std::launch::async,
                               [&, face] { return faceTexels(environment_maps, constant, face, size); }));
  for (int face = 0; face < 6; ++face)
    glTextureSubImage3D(cube.id(), 0, 0, 0, face, static_cast<GLsizei>(size), static_cast<GLsizei>(size), 1,
                        GL_RGBA, GL_HALF_FLOAT, faces[static_cast<std::size_t>(face)].get().data());
  glTextureParameteri(cube.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(cube.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return cube;
}

Result<Sky> Sky::create(const Environment& environment) {
  Sky sky;
  Result<gpu::Program> program = gpu::Program::create(
      "sky", {{GL_VERTEX_SHADER, "sky.vert"}, {GL_FRAGMENT_SHADER, "sky.frag"}}, kLightingShaders);
  if (!program) return failAgain(program.error());
  sky.program_ = std::move(*program);
  sky.no_vertices_ = gpu::VertexArray("sky");
  sky.update(environment);
  return sky;
}

bool Sky::update(const Environment& environment) {
  if (upToDate(environment)) return false;
  lights_ = environment.lightsVersion();
  std::vector<DiscRecord> discs;
  for (std::size_t i = 0; i < Environment::kSets; ++i) {
    const Environment::Shown shown = environment.shownOf(i);
    if (pictures_ != environment.picturesVersion())
      cubes_[i] = skyCube(shown.environment_maps, shown.constant);
    for (const Disc& disc : shown.discs)
      discs.push_back({{disc.direction, disc.radius_rad}, disc.radiance, static_cast<float>(i)});
  }
  pictures_ = environment.picturesVersion();
  disc_count_ = static_cast<std::uint32_t>(discs.size());
  discs_.assign(std::span<const DiscRecord>(discs));
  return true;
}

void Sky::draw(const Environment& environment, const glm::mat4& view_from_world,
               const glm::mat4& clip_from_view, std::uint32_t picture_height, gpu::Counters& counters) const {
  // Only the rotation is used, so that precision does not depend on where the scene stands.
  const glm::mat4 rotation = glm::mat4(glm::mat3(view_from_world));
  const glm::mat4 world_from_clip = glm::inverse(clip_from_view * rotation);
  const glm::mat3 light_from_world = glm::transpose(environment.worldFromLight());
  program_.use();
  glUniformMatrix4fv(kWorldFromClip, 1, GL_FALSE, glm::value_ptr(world_from_clip));
  glUniformMatrix3fv(kLightFromWorld, 1, GL_FALSE, glm::value_ptr(light_from_world));
  glUniform1ui(kDiscCount, disc_count_);
  glUniform1f(kPixelAngle, 2.0f / (clip_from_view[1][1] * static_cast<float>(picture_height)));
  glUniform2f(kShares, environment.shareOf(0), environment.shareOf(1));
  for (GLuint i = 0; i < Environment::kSets; ++i) {
    cubes_[i].bind(i);
    glBindSampler(i, 0);
  }
  discs_.bindStorage(kBindSkyDiscs);
  glBindVertexArray(no_vertices_.id());
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_CULL_FACE);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  ++counters.draws;
  ++counters.draw_calls;
}

}  // namespace lambent::lighting
