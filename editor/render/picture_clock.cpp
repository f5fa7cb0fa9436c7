#include "editor/render/picture_clock.hpp"

#include <algorithm>
#include <utility>

namespace lambent::editor {

PictureClock::Query PictureClock::timestamp() {
  if (free_.empty()) {
    GLuint id = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &id);
    free_.emplace_back(id);
  }
  Query query = std::move(free_.back());
  free_.pop_back();
  glQueryCounter(query.id(), GL_TIMESTAMP);
  return query;
}

void PictureClock::begin() {
  begun_ = std::chrono::steady_clock::now();
  first_ = timestamp();
}

void PictureClock::end(bool whole) {
  const std::chrono::duration<double, std::milli> cpu = std::chrono::steady_clock::now() - begun_;
  Query last = timestamp();
  pictures_.push_back({std::move(first_), std::move(last), cpu.count(), whole});
  glFlush();  // otherwise a driver may hold the commands back until something else is drawn
}

std::optional<PictureClock::Time> PictureClock::take() {
  if (pictures_.empty()) return std::nullopt;
  Picture& oldest = pictures_.front();
  GLint ready = 0;
  glGetQueryObjectiv(oldest.last.id(), GL_QUERY_RESULT_AVAILABLE, &ready);
  if (ready == 0) return std::nullopt;
  GLuint64 from_ns = 0, to_ns = 0;
  glGetQueryObjectui64v(oldest.first.id(), GL_QUERY_RESULT, &from_ns);
  glGetQueryObjectui64v(oldest.last.id(), GL_QUERY_RESULT, &to_ns);
  const double gpu_ms = 1e-6 * static_cast<double>(to_ns - std::min(from_ns, to_ns));
  const Time time{std::max(gpu_ms, oldest.cpu_ms), oldest.whole};
  free_.push_back(std::move(oldest.first));
  free_.push_back(std::move(oldest.last));
  pictures_.pop_front();
  return time;
}

}  // namespace lambent::editor
