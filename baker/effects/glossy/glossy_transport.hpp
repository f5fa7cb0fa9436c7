// Holds the transfer matrices of the glossy samples of a group, in the group's frame: l' = M l is the light
// that arrives at a sample after shadows and interreflection (Sloan 2002, section 4; Kautz 2002). Direct
// light is stored as visibility V in order_in + order_out - 1 bands, bounced light and light of the group's
// own lights as matrices. Below the sample's tangent plane, where the BRDF reads nothing, transferred light
// continues as its mirror image: V(s) = V(mirrored s), and bounced light alike. So V is 1 at open points and
// 0 in closed rooms, without an edge along the horizon at which few bands would ring.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lambent::baker {

struct GlossyField {
  int order_in = 5, order_out = 5;  // during bounces, order_out is the order of exit radiance
  std::uint32_t channels = 1;       // of bounced light and of the lights: 1 or 3
  std::uint32_t light_columns = 0;  // number of lights of the group
  std::uint32_t first_sample = 0;   // that of SampleSet::glossy

  std::vector<float> visibility;  // [sample][k], visibilityBands()² each
  // Bounced light of the environment: [sample][channel][output][column], order_out² by order_in²; empty
  // without bounces.
  std::vector<float> bounced;
  // Light of the group's lights, without and with bounces: [sample][channel][output][light]; empty if there
  // are none.
  std::vector<float> lights_shadowed, lights_full;

  int visibilityBands() const { return order_in + order_out - 1; }
  std::size_t visibilitySize() const {
    return static_cast<std::size_t>(visibilityBands() * visibilityBands());
  }
  std::size_t size() const { return visibility.size() / visibilitySize(); }
  // Keeps only the first `order` bands, at most order_out, of visibility and lights_shadowed.
  void keepBands(int order);
};

}  // namespace lambent::baker
