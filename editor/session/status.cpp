#include "editor/session/status.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "editor/session/session.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::editor {

namespace {

using baker::JobPhase;

// Returns a sentence if pictures of the shown bundle err by more than they were to.
std::string missedBound(const bundle::Description& description) {
  const bundle::PictureError* worst = nullptr;
  for (const bundle::Group& group : description.groups)
    if (const auto& error = group.picture_error; error && (!worst || error->all > worst->all))
      worst = &*error;
  if (!worst || !bundle::missesBound(double{worst->all}, double{worst->bound})) return {};
  return fmt::format("pictures err by {:.1f} % instead of {:.1f} %", 100.0 * double{worst->all},
                     100.0 * double{worst->bound});
}

bool works(JobPhase phase) {
  return phase == JobPhase::Waiting || phase == JobPhase::Importing || phase == JobPhase::Baking;
}

// Returns whether the scene's options are not those that its last bake was asked for.
bool hasNewOptions(const SceneEntry& entry, const baker::JobState& job) {
  return entry.options.settings() != job.request.options.settings();
}

SceneStatus wanting(std::string text, std::string detail = {}) {
  return {Standing::Wanting, std::move(text), std::move(detail)};
}

}  // namespace

SceneStatus statusOf(Session& session, std::size_t index) {
  const SceneEntry& entry = session.scenes.entries()[index];
  const auto job = session.scenes.jobOf(index);
  if (job && works(job->phase))
    return {Standing::Working, fmt::format("baking {:.0f} %", 100.0 * job->fraction), {}};
  if (job && job->phase == JobPhase::Failed)
    return {Standing::Failed, "bake failed", job->error ? job->error->line() : std::string()};
  if (entry.missing) return {Standing::Failed, "missing", entry.missing->line()};
  if (!entry.slot) return wanting("not baked");
  if (const auto& reasons = session.changes.needsRebakeNow(index); !reasons.empty())
    return wanting("needs a rebake", fmt::format("{}", fmt::join(reasons, "\n")));
  if (job && hasNewOptions(entry, *job))
    return wanting("needs a rebake", "options of the bake were changed since it was asked for");
  if (!entry.source.empty() && entry.shown != entry.bundle)
    return wanting(
        job && job->reached == baker::PreviewLevel::Coarse ? "coarse preview" : "preview without shadows",
        "the final bake was not made: Bake makes it");
  if (std::string missed = missedBound(session.stage.world().description(*entry.slot)); !missed.empty())
    return wanting(std::move(missed), "a higher quality in the bake's options helps");
  if (!job) return {Standing::Good, "bundle", "it was opened without its scene"};
  return {Standing::Good, job->up_to_date ? "up to date" : "baked", {}};
}

SceneStatus worstStatus(Session& session) {
  SceneStatus worst;
  std::size_t as_bad = 0;
  for (std::size_t i = 0; i < session.scenes.entries().size(); ++i) {
    SceneStatus status = statusOf(session, i);
    if (status.standing == Standing::Good || status.standing < worst.standing) continue;
    as_bad = status.standing == worst.standing ? as_bad + 1 : 1;
    if (as_bad > 1) continue;
    worst = std::move(status);
    worst.text = session.scenes.entries()[i].id + ": " + worst.text;
  }
  if (as_bad > 1) worst.text += fmt::format(", and {} more", as_bad - 1);
  return worst;
}

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
