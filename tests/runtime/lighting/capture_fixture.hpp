// Captures the light of small scenes on the GPU.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "runtime/lighting/capture.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::lighting {

inline Environment uniformSky(float radiance) {
  return *Environment::create({spec::ConstantLight{.radiance = glm::vec3(radiance)}});
}

inline bool allFinite(const CapturedLight& captured) {
  bool finite = std::isfinite(captured.sky_visible.r + captured.sky_visible.g + captured.sky_visible.b);
  for (const glm::vec3& c : captured.light.c) finite = finite && std::isfinite(c.r + c.g + c.b);
  for (const float v : captured.visible) finite = finite && v >= 0 && v <= 1;
  return finite;
}

class CaptureTest : public testing::GpuTest {
 protected:
  struct Scene {
    CaptureOptions options{};
    std::vector<bundle::CaptureProxy> proxies{};
    std::vector<glm::vec4> radiance{};  // per triangle; missing ones are black
    std::vector<CaptureBody> bodies{};
    std::vector<CapturePoint> points{};
  };

  std::vector<CapturedLight> captured(const Environment& environment, Scene scene) {
    auto capture = Capture::create(scene.options, environment);
    EXPECT_TRUE(capture) << capture.error().line();
    std::vector<const bundle::CaptureProxy*> proxies;
    for (const auto& proxy : scene.proxies) proxies.push_back(&proxy);
    capture->setProxies(proxies, counters);
    scene.radiance.resize(std::max<std::size_t>(capture->triangleCount(), 1));
    gpu::Buffer radiance("radiance", scene.radiance.size() * sizeof(glm::vec4));
    radiance.write(0, std::span<const glm::vec4>(scene.radiance));
    const auto run = capture->run(environment, scene.bodies, scene.points, radiance, counters);
    EXPECT_TRUE(run);
    load = capture->load();
    return *capture->take(true);
  }

  gpu::Counters counters;
  Capture::Load load;
};

}  // namespace lambent::lighting
