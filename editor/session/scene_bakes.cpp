// Implements the part of Scenes that bakes them, and offers bakes that an earlier session left unfinished.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "baker/bake/bake.hpp"
#include "baker/bake/option_rows.hpp"
#include "baker/pipeline/journal.hpp"
#include "editor/session/scenes.hpp"

namespace lambent::editor {

Result<void> Scenes::setOption(std::size_t index, std::string_view name, std::string_view word) {
  SceneEntry& entry = entries_[index];
  baker::BakeOptions options = entry.options;
  if (auto done = baker::putOption(options, name, word); !done) return done;
  if (auto checked = baker::checkRequest(options, entry.bundle); !checked) return checked;
  entry.options = options;
  return {};
}

namespace {

std::string sceneNameOf(const baker::BakeRequest& request) {
  return request.scene.filename().string();
}

}  // namespace

void Scenes::findUnfinished() {
  unfinished_.clear();
  if (settings_.cache_folder.empty()) return;
  for (baker::BakeRequest& request :
       baker::Journal(settings_.cache_folder / baker::kJournalFolder).unfinished())
    if (!find(request.scene.lexically_normal())) unfinished_.push_back(std::move(request));
  if (unfinished_.empty()) return;
  log_.note(
      unfinished_.size() == 1
          ? sceneNameOf(unfinished_.front()) +
                ": its bake was cut short in an earlier session; the Bakes panel offers to go on"
          : fmt::format("{} bakes were cut short in an earlier session; the Bakes panel offers to go on",
                        unfinished_.size()));
}

void Scenes::goOn(std::size_t unfinished) {
  unseen_.push_back(queue_->add(unfinished_[unfinished]));
  jobs_ = queue_->states();
  unfinished_.erase(unfinished_.begin() + static_cast<std::ptrdiff_t>(unfinished));
}

void Scenes::forget(std::size_t unfinished) {
  baker::Journal(settings_.cache_folder / baker::kJournalFolder).forget(unfinished_[unfinished]);
  unfinished_.erase(unfinished_.begin() + static_cast<std::ptrdiff_t>(unfinished));
}

std::vector<baker::JobState> Scenes::unseen() const {
  std::vector<baker::JobState> states = jobs_;
  std::erase_if(states, [&](const baker::JobState& state) {
    return std::ranges::find(unseen_, state.id) == unseen_.end() ||
           std::ranges::any_of(entries_, [&](const SceneEntry& entry) { return entry.job == state.id; });
  });
  return states;
}

void Scenes::takeUnseen(const baker::BakeEvent& event) {
  for (const baker::JobState& job : unseen()) {
    if (job.id != event.job) continue;
    if (event.kind == baker::BakeEvent::Kind::Failed && job.error) log_.error(*job.error);
    if (event.kind == baker::BakeEvent::Kind::Bundle && event.preview_level == baker::PreviewLevel::Final)
      log_.note(sceneNameOf(job.request) + ": the bake that was cut short is done");
  }
}

}  // namespace lambent::editor
