#include "baker/effects/neighborhood/volume_body.hpp"

#include <algorithm>
#include <array>

#include <glm/geometric.hpp>

#include "runtime/sh/basis.hpp"

namespace lambent::baker {

VolumeBody::VolumeBody(const VolumeLight& light, const glm::vec3& bounds_min, const glm::vec3& bounds_max,
                       bool scatters)
    : light_(light),
      centre_(0.5f * (bounds_min + bounds_max)),
      radius_(0.5f * glm::distance(bounds_min, bounds_max)),
      scatters_(scatters) {}

void VolumeBody::look(const glm::vec3& from, const DirectionPacket& along, std::size_t, bool with_light,
                      BodyLook& out) const {
  out.sends = out.backs = 0;
  const std::size_t row_size = 3 * static_cast<std::size_t>(sh::coefficientCount(light_.order()));
  std::array<float, 3 * sh::kMaxCoefficients> unwanted;
  const float far = glm::distance(from, centre_) + radius_;
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const bool keep = with_light && scatters_;
    const auto row =
        keep ? std::span(out.sent).subspan(k * row_size, row_size) : std::span(unwanted).first(row_size);
    std::fill(row.begin(), row.end(), 0.0f);
    const float through = light_.look(from, along[k], far, row);
    out.stopped[k] = 1.0f - std::clamp(through, 0.0f, 1.0f);
    if (keep && std::any_of(row.begin(), row.end(), [](float value) { return value != 0.0f; }))
      out.sends |= static_cast<std::uint16_t>(1u << k);
  }
}

}  // namespace lambent::baker
