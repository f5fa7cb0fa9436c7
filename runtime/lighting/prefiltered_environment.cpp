#include "runtime/lighting/prefiltered_environment.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include <glm/matrix.hpp>

#include "runtime/gpu/program.hpp"
#include "runtime/lighting/sky.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::lighting {

namespace {

using sh::kPi;
constexpr int kSteps = 16384;

double shape(double alpha, double cos_theta) {
  const double half_squared = 0.5 * (1.0 + cos_theta);  // cos² of half the angle
  const double root = half_squared * (alpha * alpha - 1.0) + 1.0;
  return std::max(cos_theta, 0.0) / (root * root);
}

// Returns a quadrature node for theta in 0..pi/2. Nodes are dense near 0, where narrow lobes are.
double thetaAt(double u) {
  return 0.5 * kPi * u * u * u;
}

}  // namespace

float ReflectedLobe::density(float cos_theta) const {
  return scale * static_cast<float>(shape(alpha, cos_theta));
}

float roughnessOfLevel(std::uint32_t level, std::uint32_t levels) {
  return std::pow(static_cast<float>(level) / static_cast<float>(levels - 1), 1.5f);
}

ReflectedLobe makeReflectedLobe(float roughness) {
  ReflectedLobe lobe;
  if (!(roughness > 0.0f)) {
    lobe.bands.fill(1.0f);
    return lobe;
  }
  lobe.alpha = std::max(roughness * roughness, 1e-3f);
  std::vector<double> shares(kSteps);
  double all = 0.0;
  std::array<double, sh::kMaxOrder> bands{};
  for (int i = 0; i < kSteps; ++i) {
    const double low = thetaAt(static_cast<double>(i) / kSteps), high = thetaAt((i + 1.0) / kSteps);
    const double theta = thetaAt((i + 0.5) / kSteps), cosine = std::cos(theta);
    const double ring = 2.0 * kPi * (std::cos(low) - std::cos(high));
    const double share = ring * shape(lobe.alpha, cosine);
    shares[static_cast<std::size_t>(i)] = share;
    all += share;
    for (int l = 0; l < sh::kMaxOrder; ++l)
      bands[static_cast<std::size_t>(l)] += share * sh::legendre(l, cosine);
  }
  lobe.scale = static_cast<float>(1.0 / all);
  for (std::size_t l = 0; l < bands.size(); ++l) lobe.bands[l] = static_cast<float>(bands[l] / all);
  double passed = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    passed += shares[static_cast<std::size_t>(i)] / all;
    while (static_cast<int>(lobe.angles_rad.size()) < kLobeShares &&
           passed >= (static_cast<double>(lobe.angles_rad.size()) + 0.5) / kLobeShares)
      lobe.angles_rad.push_back(static_cast<float>(thetaAt((i + 0.5) / kSteps)));
  }
  lobe.angles_rad.resize(kLobeShares, static_cast<float>(0.5 * kPi));
  return lobe;
}

namespace {

constexpr std::uint32_t kLargestSize = 256, kLeastSize = 64;  // kLeastSize allows kReflectedLevels levels
// Returns the number of samples of the lobe that look at the sky: more where the lobe is wide and texels are
// few.
int sharesOf(std::uint32_t level) {
  return level <= 1 ? 32 : level == 2 ? 64 : kLobeShares;
}

// These are the uniform locations of prefiltered_environment.comp.
constexpr GLint kSize = 0, kLobe = 1, kReflectedSkyShares = 2, kReflectedDiscCount = 3;

// Returns the sky with all mip levels, so that wide lookups are cheap.
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

// Key lights wider than this are pieces of something with a shape of its own.
constexpr float kWideKey_rad = 0.06f;

bool hasWideKeys(const Environment& environment) {
  float wide = 0.0f, all = 0.0f;
  for (std::size_t set = 0; set < Environment::kSets; ++set)
    for (const Disc& key : environment.keysOf(set)) {
      const float flux = key.radius_rad * key.radius_rad * (key.radiance.r + key.radiance.g + key.radiance.b);
      all += flux;
      if (key.radius_rad > kWideKey_rad) wide += flux;
    }
  return wide > 0.5f * all;
}

}  // namespace

std::uint64_t PrefilteredEnvironment::sourceVersion(const Environment& environment) {
  return hasWideKeys(environment) ? environment.lightsVersion() : environment.restVersion();
}

struct PrefilteredEnvironment::Source {
  const gpu::Texture& sky;  // in the lights' own frame
  std::span<const Disc> discs;
  bool pictured = false;  // false: everything that is not a disc is constant
  const gpu::Program &program, &weigh;
  std::span<const ReflectedLobe> lobes;
};

Result<PrefilteredEnvironment> PrefilteredEnvironment::make(const Environment& environment, const Sky& sky,
                                                            gpu::Counters& counters) {
  Result<gpu::Program> program = gpu::Program::create(
      "prefiltered environment", {{GL_COMPUTE_SHADER, "prefiltered_environment.comp"}}, kLightingShaders);
  if (!program) return failAgain(program.error());
  Result<gpu::Program> weigh = gpu::Program::create(
      "reflected source", {{GL_COMPUTE_SHADER, "prefiltered_source.comp"}}, kLightingShaders);
  if (!weigh) return failAgain(weigh.error());
  PrefilteredEnvironment made;
  std::vector<ReflectedLobe> lobes;
  for (std::uint32_t level = 0; level < kReflectedLevels; ++level) {
    lobes.push_back(makeReflectedLobe(roughnessOfLevel(level, kReflectedLevels)));
    for (std::uint32_t l = 0; l < 8; ++l)
      made.values_.bands[2 * level + l / 4][static_cast<int>(l % 4)] = lobes.back().bands[l];
  }
  made.has_whole_ = hasWideKeys(environment);
  for (std::size_t set = 0; set < Environment::kSets; ++set) {
    const Environment::Shown lights = environment.shownOf(set);
    const Environment::Rest rest = environment.restOf(set);
    const bool parted = !environment.keysOf(set).empty();
    const gpu::Texture rest_sky = parted ? skyCube(rest.environment_maps, rest.constant) : gpu::Texture();
    const auto prefilterOf = [&](const gpu::Texture& source, std::span<const Disc> discs) {
      return prefilter({source, discs, !lights.environment_maps.empty(), *program, *weigh, lobes}, counters);
    };
    made.cubes_[set] = prefilterOf(parted ? rest_sky : sky.cube(set), rest.discs);
    if (made.has_whole_) made.whole_[set] = prefilterOf(sky.cube(set), lights.discs);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
  return made;
}

gpu::Texture PrefilteredEnvironment::prefilter(const Source& from, gpu::Counters& counters) {
  gpu::Table angles("lobe"), discs_table("reflected discs");
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  const gpu::Texture source = withLevels(from.sky, from.weigh, counters);
  // Suns are sharper than environment maps.
  const std::uint32_t size = from.discs.empty()
                                 ? std::clamp(std::bit_ceil(source.desc().width), kLeastSize, kLargestSize)
                                 : kLargestSize;
  gpu::Texture cube(
      "prefiltered environment",
      {.format = GL_RGBA16F, .width = size, .height = size, .levels = kReflectedLevels, .cube = true});
  glTextureParameteri(cube.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTextureParameteri(cube.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  std::vector<ReflectedDisc> discs;
  for (const Disc& disc : from.discs)
    discs.push_back({{disc.direction, disc.radius_rad}, {disc.radiance, 0.0f}});
  discs_table.assign(std::span<const ReflectedDisc>(discs));
  discs_table.bindStorage(kBindDiscs);
  from.program.use();
  source.bind(0);
  glBindSampler(0, 0);
  for (std::uint32_t level = 0; level < kReflectedLevels; ++level) {
    const ReflectedLobe& lobe = from.lobes[level];
    const std::uint32_t side = std::max(size >> level, 1u);
    angles.assign(std::span<const float>(lobe.angles_rad));
    angles.bindStorage(kBindLobe);
    glUniform1i(kSize, static_cast<GLint>(side));
    glUniform2f(kLobe, lobe.alpha, lobe.scale);
    glUniform1i(kReflectedSkyShares, from.pictured ? sharesOf(level) : 1);
    glUniform1ui(kReflectedDiscCount, static_cast<GLuint>(discs.size()));
    glBindImageTexture(0, cube.id(), static_cast<GLint>(level), GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    const std::uint32_t groups = (side + kReflectedGroup - 1) / kReflectedGroup;
    glDispatchCompute(groups, groups, 6);
    ++counters.dispatches;
  }
  return cube;
}

void PrefilteredEnvironment::update(const Environment& environment, int order, sh::Window window,
                                    gpu::Counters& counters) {
  if (!changed_.renew(environment.version(), order, window)) return;
  values_.light_from_world = glm::mat4(glm::transpose(environment.worldFromLight()));
  values_.shares = {environment.shareOf(0), environment.shareOf(1), static_cast<float>(kReflectedLevels - 1),
                    has_whole_ ? 1.0f : 0.0f};
  const sh::LightVector light =
      sh::applyWindow(environment.restLight().truncated(order), window).truncated(sh::kMaxOrder);
  for (std::size_t k = 0; k < kReflectionCoefficients; ++k) values_.light[k] = glm::vec4(light.c[k], 0.0f);
  block_.assign(std::span<const ReflectionValues>(&values_, 1));
  counters.uploaded_bytes += sizeof(values_);
}

void PrefilteredEnvironment::bind() const {
  glBindBufferBase(GL_UNIFORM_BUFFER, kBindReflection, block_.buffer().id());
  cubes_[0].bind(kUnitFirstReflection);
  cubes_[1].bind(kUnitSecondReflection);
  (has_whole_ ? whole_ : cubes_)[0].bind(kUnitFirstWhole);
  (has_whole_ ? whole_ : cubes_)[1].bind(kUnitSecondWhole);
  glBindSampler(kUnitFirstWhole, 0);
  glBindSampler(kUnitSecondWhole, 0);
  glBindSampler(kUnitFirstReflection, 0);
  glBindSampler(kUnitSecondReflection, 0);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
}

}  // namespace lambent::lighting
