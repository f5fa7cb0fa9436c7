#include "editor/session/scene_steps.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "editor/session/session.hpp"

namespace lambent::editor {

namespace {

class SceneChange : public OutsideChange {
 public:
  SceneChange(SceneSteps& steps, ClosedScene scene, bool opened)
      : steps_(steps), scene_(std::move(scene)), opened_(opened) {}

  void carryOut(bool forth, std::vector<std::string>& missing) override {
    if (opened_ != forth) {
      if (!steps_.take(scene_)) missing.push_back("the scene " + scene_.entry.id);
    } else if (const auto brought = steps_.bring(scene_); !brought) {
      missing.push_back(brought.error().line());
    }
  }
  std::size_t bytes() const override {
    std::size_t bytes = sizeof *this + 1024;  // an estimate of paths and options
    for (const EntityOverride& edit : scene_.kept) {
      bytes += sizeof edit + edit.name.size();
      for (const FieldOverride& field : edit.fields) bytes += sizeof field + editor::bytesOf(field.value);
    }
    return bytes;
  }

 private:
  SceneSteps& steps_;
  ClosedScene scene_;
  bool opened_;
};

std::optional<std::size_t> placeOf(const Scenes& scenes, const SceneEntry& entry) {
  const auto& entries = scenes.entries();
  const auto found = std::ranges::find_if(entries, [&](const auto& other) { return other.isSame(entry); });
  if (found == entries.end()) return std::nullopt;
  return static_cast<std::size_t>(found - entries.begin());
}

// Returns the edits that lack something: those of entities that do not exist, and the parents of others that
// were below them.
Overrides lacking(const Document& document, Overrides all) {
  Overrides gone;
  for (EntityOverride& edit : all) {
    if (!document.find(edit.id)) {
      gone.push_back(std::move(edit));
    } else if (edit.parent && *edit.parent != kNoId && !document.find(*edit.parent)) {
      EntityOverride hung;
      hung.id = edit.id, hung.name = edit.name, hung.parent = edit.parent;
      gone.push_back(std::move(hung));
    }
  }
  return gone;
}

}  // namespace

Result<void> SceneSteps::open(const std::filesystem::path& path) {
  const std::vector<SceneEntry> before = session_.scenes.entries();
  const std::vector<std::filesystem::path> watched = session_.scenes.watched();
  if (auto opened = session_.scenes.open(path); !opened) return opened;
  session_.document.adoptAll();
  const std::string name = "opening of " + path.filename().string();
  session_.history.begin(name);
  const auto did = [&](ClosedScene scene) {
    session_.history.did(std::make_shared<SceneChange>(*this, std::move(scene), /*opened=*/true), name);
  };
  const auto& entries = session_.scenes.entries();
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (std::ranges::none_of(before, [&](const auto& other) { return other.isSame(entries[i]); }))
      did({.entry = entries[i], .place = i, .kept = {}, .folder = {}});
  for (const std::filesystem::path& folder : session_.scenes.watched())
    if (std::find(watched.begin(), watched.end(), folder) == watched.end()) {
      ClosedScene watch;
      watch.folder = folder;
      did(std::move(watch));
    }
  session_.history.commit();
  return {};
}

void SceneSteps::close(std::size_t entry) {
  ClosedScene scene{.entry = session_.scenes.entries()[entry], .place = entry, .kept = {}, .folder = {}};
  if (!take(scene)) return;
  const std::string name = "closing of " + scene.entry.id;
  session_.history.did(std::make_shared<SceneChange>(*this, std::move(scene), /*opened=*/false), name);
}

Result<void> SceneSteps::bring(const ClosedScene& scene) {
  if (!scene.folder.empty()) {
    session_.scenes.watchFolder(scene.folder);
    return {};
  }
  if (auto done = session_.scenes.reopen(scene.entry, scene.place); !done) return done;
  waiting_.push_back({scene.entry, scene.kept});
  update();
  return {};
}

bool SceneSteps::take(ClosedScene& scene) {
  if (!scene.folder.empty()) {
    session_.scenes.unwatchFolder(scene.folder);
    return true;
  }
  const auto place = placeOf(session_.scenes, scene.entry);
  if (!place) return false;
  scene.entry = session_.scenes.entries()[*place];
  scene.place = *place;
  const auto waits = std::ranges::find_if(
      waiting_, [&](const Waiting& waiting) { return waiting.entry.isSame(scene.entry); });
  if (waits != waiting_.end()) {
    // Its edits were never restored, so they are what is kept.
    scene.kept = std::move(waits->kept);
    waiting_.erase(waits);
    session_.scenes.close(*place);
    return true;
  }
  Overrides all = captureOverrides(session_.document, session_.changes.baseline());
  session_.scenes.close(*place);
  scene.kept = lacking(session_.document, std::move(all));
  return true;
}

std::size_t SceneSteps::await(const Overrides& edits) {
  awaited_ = lacking(session_.document, edits);
  return awaited_.size();
}

void SceneSteps::restoreAwaited() {
  Overrides here;
  for (const EntityOverride& edit : awaited_)
    if (session_.document.find(edit.id)) here.push_back(edit);
  if (here.empty()) return;
  applyOverrides(session_.document, here);
  awaited_ = lacking(session_.document, std::move(awaited_));
  session_.viewing.changed = true;
}

void SceneSteps::update() {
  restoreAwaited();
  for (std::size_t i = 0; i < waiting_.size();) {
    const auto place = placeOf(session_.scenes, waiting_[i].entry);
    if (place && !session_.scenes.entries()[*place].slot) {
      ++i;
      continue;
    }
    if (place)
      for (const std::string& missing : applyOverrides(session_.document, waiting_[i].kept).missing)
        session_.log.warn(missing + " is not there any more; its edits are lost");
    waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
    session_.viewing.changed = true;
  }
}

}  // namespace lambent::editor
