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

std::string statusOf(const Session& session) {
  std::string text = fmt::format("{:.1f} ms", session.picture.times.median());
  std::size_t working = 0;
  for (const baker::JobState& job : session.scenes.jobs())
    working += job.phase == baker::JobPhase::Baking || job.phase == baker::JobPhase::Waiting ||
               job.phase == baker::JobPhase::Importing;
  if (working > 0) text = fmt::format("bakes: {}   {}", working, text);
  if (!session.picture.settled) text = "light settles   " + text;
  return text;
}

}  // namespace lambent::editor
