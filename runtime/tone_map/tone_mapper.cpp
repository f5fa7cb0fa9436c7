#include "runtime/tone_map/tone_mapper.hpp"

#include <cmath>
#include <string>

#include "lambent_tone_map_embedded.hpp"

namespace lambent::frame {

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_tone_map::find};

struct ExposureRecord {
  float scale;
  std::uint32_t negative_pixels;
};

}  // namespace

ToneMapper::ToneMapper(std::uint32_t samples, bool linear)
    : kernels_(kShaders), exposure_("exposure", sizeof(ExposureRecord)), no_vertices_("full screen") {
  if (samples > 0) defines_.push_back({"LAMBENT_SAMPLES", std::to_string(samples)});
  if (linear) defines_.push_back({"LAMBENT_LINEAR", "1"});
}

Result<void> ToneMapper::run(const gpu::Texture& hdr, std::optional<float> exposure_ev,
                             gpu::Counters& counters, bool as_is) {
  hdr.bind(0);
  exposure_.bindStorage(0);
  if (Result<void> done = kernels_.use("meter.comp", defines_); !done) return done;
  glUniform1f(0, exposure_ev ? std::exp2(*exposure_ev) : 0.0f);
  glDispatchCompute(1, 1, 1);
  ++counters.dispatches;
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  if (Result<void> done = kernels_.use(
          {{GL_VERTEX_SHADER, "full_screen.vert"}, {GL_FRAGMENT_SHADER, "resolve.frag"}}, defines_);
      !done)
    return done;
  glUniform1ui(0, as_is ? 1u : 0u);
  glDisable(GL_DEPTH_TEST);
  no_vertices_.draw(3, counters);
  return {};
}

std::uint32_t ToneMapper::negativePixels() const {
  ExposureRecord record{};
  exposure_.read(0, std::span(&record, 1));
  return record.negative_pixels;
}

float ToneMapper::exposureEv() const {
  ExposureRecord record{};
  exposure_.read(0, std::span(&record, 1));
  return std::log2(record.scale);
}

}  // namespace lambent::frame
