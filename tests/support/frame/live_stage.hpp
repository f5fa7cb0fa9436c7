// Shows a written bundle in a world with a light and a frame of 64 x 64 linear pixels. A test can change
// everything while it is shown.
#pragma once

#include "runtime/scene/materials.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/view_stage.hpp"

namespace lambent::testing {

struct LiveStage : ViewStage {
  LiveStage(const BundleBuilder& builder, const std::vector<spec::Light>& lights,
            const frame::FrameSettings& settings = {})
      : ViewStage(builder, lights,
                  {.size = {64, 64}, .output = frame::Output::Linear, .settings = settings}) {
    camera.azimuth_deg = 20.0f;
    camera.elevation_deg = 15.0f;
  }

  // Renders until everything is at rest, and returns the picture.
  std::vector<glm::vec4> picture() {
    render();
    const Result<std::uint32_t> steps = frame->rest(world, environment);
    EXPECT_TRUE(steps) << steps.error().line();
    render();
    return frame->readLinear().texels;
  }
  void set(std::string_view name, std::string_view word) {
    frame::FrameSettings settings = frame->settings();
    const Result<void> put = frame::putSetting(settings, name, word);
    ASSERT_TRUE(put) << put.error().line();
    const Result<void> set = frame->setSettings(settings);
    ASSERT_TRUE(set) << set.error().line();
  }
  scene::MaterialComponent& editMaterial(std::size_t index) {
    return world.registry().edit<scene::MaterialComponent>(world.instance(0).materials[index]);
  }
  std::string reason(const std::string& name) {
    const auto found = pass(name);
    EXPECT_TRUE(found) << name;
    return found ? found->reason : "";
  }
};

// Returns the largest difference in any channel.
inline float farthest(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
  float most = a.size() == b.size() ? 0.0f : 1e9f;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    for (int k = 0; k < 4; ++k) most = larger(most, std::abs(a[i][k] - b[i][k]));
  return most;
}

}  // namespace lambent::testing
