#include "runtime/lighting/reflected_sky.hpp"

#include <algorithm>
#include <bit>
#include <vector>

#include <glm/matrix.hpp>

#include "lambent_lighting_embedded.hpp"
#include "runtime/gpu/program.hpp"
#include "runtime/lighting/reflected_lobe.hpp"

namespace lambent::lighting {

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_lighting::find};
constexpr std::uint32_t kLargestSize = 256, kLeastSize = 64;  // 64: kReflectedLevels levels
// Of the lobe, each of which looks at the sky once: more where the lobe is wide and texels are few.
int sharesOf(std::uint32_t level) {
  return level <= 1 ? 32 : level == 2 ? 64 : kLobeShares;
}

// As in reflected_sky.comp.
constexpr GLint kSize = 0, kLobe = 1, kSkyShares = 2, kDiscCount = 3;

// The sky with all its mip levels, so that wide looks are cheap.
gpu::Texture withLevels(const gpu::Texture& sky, const gpu::Program& program, gpu::Counters& counters) {
  const std::uint32_t size = sky.desc().width;
  gpu::Texture weighted("sky to reflect", {.format = GL_RGBA16F,
                                           .width = size,
                                           .height = size,
                                           .levels = static_cast<std::uint32_t>(std::bit_width(size)),
                                           .cube = true});
  program.use();
  sky.bind(0);
  glBindSampler(0, 0);
  glUniform1i(kSize, static_cast<GLint>(size));
  glBindImageTexture(0, weighted.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
  const std::uint32_t groups = (size + kReflectedGroup - 1) / kReflectedGroup;
  glDispatchCompute(groups, groups, 6);
  ++counters.dispatches;
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  glGenerateTextureMipmap(weighted.id());
  glTextureParameteri(weighted.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(weighted.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return weighted;
}

// Suns are sharper than probes.
std::uint32_t sizeFor(const Environment::Rest& lights, const gpu::Texture& sky) {
  if (!lights.discs.empty()) return kLargestSize;
  return std::clamp(std::bit_ceil(sky.desc().width), kLeastSize, kLargestSize);
}

}  // namespace

Result<ReflectedSky> ReflectedSky::make(const Environment& environment, const Sky& sky,
                                        gpu::Counters& counters) {
  Result<gpu::Program> program =
      gpu::Program::create("reflected sky", {{GL_COMPUTE_SHADER, "reflected_sky.comp"}}, kShaders);
  if (!program) return failAgain(program.error());
  Result<gpu::Program> weigh =
      gpu::Program::create("reflected source", {{GL_COMPUTE_SHADER, "reflected_source.comp"}}, kShaders);
  if (!weigh) return failAgain(weigh.error());
  ReflectedSky made;
  std::vector<ReflectedLobe> lobes;
  for (std::uint32_t level = 0; level < kReflectedLevels; ++level) {
    lobes.push_back(makeReflectedLobe(roughnessOfLevel(level, kReflectedLevels)));
    for (std::uint32_t l = 0; l < 8; ++l)
      made.values_.bands[2 * level + l / 4][static_cast<int>(l % 4)] = lobes.back().bands[l];
  }
  gpu::Table angles("lobe"), discs_table("reflected discs");
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  for (std::size_t set = 0; set < Environment::kSets; ++set) {
    const Environment::Rest lights = environment.restOf(set);
    const bool whole = environment.keysOf(set).empty();
    const gpu::Texture rest = whole ? gpu::Texture() : skyCube(lights.probes, lights.constant);
    const gpu::Texture source = withLevels(whole ? sky.cube(set) : rest, *weigh, counters);
    const std::uint32_t size = sizeFor(lights, source);
    made.cubes_[set] = gpu::Texture(
        "reflected sky",
        {.format = GL_RGBA16F, .width = size, .height = size, .levels = kReflectedLevels, .cube = true});
    const gpu::Texture& cube = made.cubes_[set];
    glTextureParameteri(cube.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(cube.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    std::vector<ReflectedDisc> discs;
    for (const Disc& disc : lights.discs)
      discs.push_back({{disc.direction, disc.radius_rad}, {disc.radiance, 0.0f}});
    discs_table.assign(std::span<const ReflectedDisc>(discs));
    discs_table.bindStorage(kBindDiscs);
    program->use();
    source.bind(0);
    glBindSampler(0, 0);
    for (std::uint32_t level = 0; level < kReflectedLevels; ++level) {
      const ReflectedLobe& lobe = lobes[level];
      const std::uint32_t side = std::max(size >> level, 1u);
      angles.assign(std::span<const float>(lobe.angles_rad));
      angles.bindStorage(kBindLobe);
      glUniform1i(kSize, static_cast<GLint>(side));
      glUniform2f(kLobe, lobe.alpha, lobe.scale);
      glUniform1i(kSkyShares, lights.probes.empty() ? 1 : sharesOf(level));
      glUniform1ui(kDiscCount, static_cast<GLuint>(discs.size()));
      glBindImageTexture(0, cube.id(), static_cast<GLint>(level), GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
      const std::uint32_t groups = (side + kReflectedGroup - 1) / kReflectedGroup;
      glDispatchCompute(groups, groups, 6);
      ++counters.dispatches;
    }
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return made;
}

void ReflectedSky::update(const Environment& environment, int order, sh::Window window,
                          gpu::Counters& counters) {
  if (environment.version() == environment_seen_ && order == order_seen_ && window == window_seen_) return;
  environment_seen_ = environment.version();
  order_seen_ = order;
  window_seen_ = window;
  values_.light_from_world = glm::mat4(glm::transpose(environment.worldFromLight()));
  values_.shares = {environment.shareOf(0), environment.shareOf(1), static_cast<float>(kReflectedLevels - 1),
                    0.0f};
  const sh::LightVector light =
      sh::applyWindow(environment.restLight().truncated(order), window).truncated(sh::kMaxOrder);
  for (std::size_t k = 0; k < kReflectionCoefficients; ++k) values_.light[k] = glm::vec4(light.c[k], 0.0f);
  block_.assign(std::span<const ReflectionValues>(&values_, 1));
  counters.uploaded_bytes += sizeof(values_);
}

void ReflectedSky::bind() const {
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindReflection, block_.buffer().id());
  cubes_[0].bind(kUnitFirstReflection);
  cubes_[1].bind(kUnitSecondReflection);
  glBindSampler(kUnitFirstReflection, 0);
  glBindSampler(kUnitSecondReflection, 0);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
}

}  // namespace lambent::lighting
