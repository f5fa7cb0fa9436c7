#include "runtime/gpu/pass_timers.hpp"

namespace lambent::gpu {

PassTimers::Scope::Scope(PassTimers& timers, std::string_view name)
    : frame_(timers.frames_[timers.current_]), group_(name), pass_(frame_.passes.size()) {
  frame_.passes.push_back(
      {.name = std::string(name), .cpu_ms = 0.0, .gpu_ms = -1.0, .counters = {}, .reason = {}});
  while (frame_.queries.size() < 2 * frame_.passes.size()) {
    GLuint id = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &id);
    frame_.queries.emplace_back(id);
  }
  glQueryCounter(frame_.queries[2 * pass_].id(), GL_TIMESTAMP);
  start_ = std::chrono::steady_clock::now();
}

PassTimers::Scope::~Scope() {
  frame_.passes[pass_].cpu_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  glQueryCounter(frame_.queries[2 * pass_ + 1].id(), GL_TIMESTAMP);
}

void PassTimers::beginFrame() {
  current_ = (current_ + 1) % kFramesInFlight;
  // This slot was used kFramesInFlight frames ago. Times that are still missing are given up.
  collect(frames_[current_], /*wait=*/false);
  frames_[current_].passes.clear();
}

void PassTimers::finish() {
  for (std::size_t i = 1; i <= kFramesInFlight; ++i)
    collect(frames_[(current_ + i) % kFramesInFlight], /*wait=*/true);
}

void PassTimers::collect(Frame& frame, bool wait) {
  if (frame.passes.empty()) return;
  if (!wait) {
    GLint available = 0;
    glGetQueryObjectiv(frame.queries[2 * frame.passes.size() - 1].id(), GL_QUERY_RESULT_AVAILABLE,
                       &available);
    if (!available) return;
  }
  for (std::size_t i = 0; i < frame.passes.size(); ++i) {
    GLuint64 begin_ns = 0, end_ns = 0;
    glGetQueryObjectui64v(frame.queries[2 * i].id(), GL_QUERY_RESULT, &begin_ns);
    glGetQueryObjectui64v(frame.queries[2 * i + 1].id(), GL_QUERY_RESULT, &end_ns);
    frame.passes[i].gpu_ms = static_cast<double>(end_ns - begin_ns) * 1e-6;
  }
  latest_ = frame.passes;
}

}  // namespace lambent::gpu
