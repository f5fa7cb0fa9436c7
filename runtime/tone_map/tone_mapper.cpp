#include "runtime/tone_map/tone_mapper.hpp"

#include <cmath>
#include <vector>

#include "lambent_tone_map_embedded.hpp"

namespace lambent::frame {

namespace {

constexpr gpu::FindText kShaders[] = {&embedded::lambent_tone_map::find};

struct ExposureRecord {
  float scale;
  std::uint32_t negative_pixels;
};

}  // namespace

Result<ToneMapper> ToneMapper::create(std::uint32_t samples, bool linear) {
  std::vector<gpu::Define> defines;
  if (samples > 0) defines.push_back({"LAMBENT_SAMPLES", std::to_string(samples)});
  if (linear) defines.push_back({"LAMBENT_LINEAR", "1"});
  ToneMapper mapper;
  Result<gpu::Program> meter =
      gpu::Program::create("meter", {{GL_COMPUTE_SHADER, "meter.comp"}}, kShaders, defines);
  if (!meter) return failAgain(meter.error());
  mapper.meter_ = std::move(*meter);
  Result<gpu::Program> resolve = gpu::Program::create(
      "resolve", {{GL_VERTEX_SHADER, "full_screen.vert"}, {GL_FRAGMENT_SHADER, "resolve.frag"}}, kShaders,
      defines);
  if (!resolve) return failAgain(resolve.error());
  mapper.resolve_ = std::move(*resolve);
  mapper.exposure_ = gpu::Buffer("exposure", sizeof(ExposureRecord));
  mapper.no_vertices_ = gpu::VertexArray("full screen");
  return mapper;
}

void ToneMapper::run(const gpu::Texture& hdr, std::optional<float> exposure_ev, gpu::Counters& counters,
                     bool as_is) {
  hdr.bind(0);
  glBindSampler(0, 0);
  exposure_.bindStorage(0);
  meter_.use();
  glUniform1f(0, exposure_ev ? std::exp2(*exposure_ev) : 0.0f);
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  resolve_.use();
  glUniform1ui(0, as_is ? 1u : 0u);
  glBindVertexArray(no_vertices_.id());
  glDisable(GL_DEPTH_TEST);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  ++counters.dispatches;
  ++counters.draws;
  ++counters.draw_calls;
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
