#include "editor/session/status.hpp"

#include <fmt/format.h>

#include "editor/session/session.hpp"

namespace lambent::editor {

std::string titleOf(const Session& session) {
  const std::filesystem::path& world = session.files.world();
  std::string name = world.empty() ? "untitled" : world.filename().string();
  if (world.empty() && session.scenes.entries().size() == 1) name = session.scenes.entries().front().id;
  return fmt::format("{}{} - Lambent", name, session.files.modified() ? "*" : "");
}

std::string pictureStatus(const Session& session) {
  const double ms = session.picture.times.median();
  const std::string time = ms < 1000.0 ? fmt::format("{:.1f} ms", ms) : fmt::format("{:.1f} s", 1e-3 * ms);
  return session.picture.settled ? time : "light settles   " + time;
}

}  // namespace lambent::editor
