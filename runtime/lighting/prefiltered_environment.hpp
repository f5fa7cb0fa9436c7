// What rough mirrors show of the sky beyond the few bands that surfaces have of its light: P(L) - P(L_n),
// prefiltered by the round lobe of prefiltered_lobe.hpp. L is the light without key lights, whose highlights
// surfaces shade by their discs; where key lights are wide, pieces of windows or soft boxes, their true shape
// is kept in second pictures, of all the light, for mirrors that are sharp enough to tell. P(L) stands in a
// cube map per set of lights, roughness along its mip levels, in the lights' own frame: made once, for
// turning, fading and dimming only mix it anew. P(L_n) has n bands, each scaled by the lobe's, and is taken
// off where a surface looks (glossy_surface.glsl), so that light of few bands leaves nothing. Render thread
// only. Errors: a kernel that does not compile on this device.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/base/result.hpp"
#include "runtime/gpu/objects.hpp"
#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/prefiltered_shared.h"
#include "runtime/lighting/sky.hpp"
#include "runtime/sh/window.hpp"

namespace lambent::lighting {

class PrefilteredEnvironment {
 public:
  // `sky` is that of the environment.
  static Result<PrefilteredEnvironment> make(const Environment& environment, const Sky& sky,
                                             gpu::Counters& counters);
  // What make() would make depends on this alone.
  static std::uint64_t sourceVersion(const Environment& environment);

  // The environment as it stands now, and the light that surfaces have of it: so many bands, windowed.
  void update(const Environment& environment, int order, sh::Window window, gpu::Counters& counters);
  void bind() const;

  // As uploaded, for tests.
  const ReflectionValues& values() const { return values_; }
  const gpu::Texture& cube(std::size_t set) const { return cubes_[set]; }

 private:
  // P of a set of lights, along the mip levels.
  struct Source;
  static gpu::Texture prefilter(const Source& source, gpu::Counters& counters);

  PrefilteredEnvironment() : block_("reflection") {}

  std::array<gpu::Texture, Environment::kSets> cubes_, whole_;
  bool has_whole_ = false;
  ReflectionValues values_{};
  gpu::Table block_;
  std::uint64_t environment_seen_ = ~std::uint64_t{0};
  int order_seen_ = 0;
  sh::Window window_seen_ = sh::Window::Off;
};

}  // namespace lambent::lighting
