// Draws a small bundle under lights from infinity, for tests of key lights in whole pictures.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/support/frame/view_stage.hpp"

namespace lambent::frame {

// Makes all surfaces of the bundle, of order 5, send on half as much again.
inline testing::BundleBuilder& withBounces(testing::BundleBuilder& builder) {
  return builder.bounces().transfer([](const glm::vec3& normal) {
    std::vector<float> both = testing::openTransfer(5)(normal), full = both;
    for (float& value : full) value *= 1.5f;
    both.insert(both.end(), full.begin(), full.end());
    return both;
  });
}

struct KeyStage : testing::ViewStage {
  KeyStage(const testing::BundleBuilder& builder, const std::vector<spec::Light>& lights,
           std::uint32_t most_keys = FrameSettings::kAutoKeys, const FrameSettings& settings = {})
      : ViewStage(builder, lights, optionsOf(settings)) {
    environment.setMostKeys(most_keys);
  }
  static FrameOptions optionsOf(const FrameSettings& settings) {
    FrameOptions options = testing::linearOptions();
    options.settings = settings;
    options.settings.key_size = 1024;
    return options;
  }

  spec::RgbaImage picture(const spec::View& view) {
    render(view);
    return frame->readLinear();
  }
  std::uint64_t mapsDrawn() const { return frame->counts()["key_maps_drawn"]; }
};

}  // namespace lambent::frame
