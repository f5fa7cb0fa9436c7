#include "runtime/frame/invalidation_log.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "runtime/scene/materials.hpp"

namespace lambent::frame {

namespace {

std::string counted(std::size_t count, std::string_view one) {
  return count == 1 ? fmt::format("a {}", one) : fmt::format("{} {}s", count, one);
}

// Returns how many components of a type changed since its version was `seen`.
template <typename Component>
std::size_t changedSince(const ecs::Registry& registry, std::uint64_t seen) {
  std::size_t count = 0;
  for (auto [entity, component] : registry.view<const Component>())
    count += registry.version<Component>(entity) > seen ? 1 : 0;
  return count;
}

// Sets `seen` to the current version. Returns the number of changes, or nothing if it was current already.
template <typename Component>
std::optional<std::size_t> changes(const ecs::Registry& registry, std::uint64_t& seen) {
  const std::uint64_t now = registry.version<Component>();
  if (now == seen) return {};
  const std::size_t count = changedSince<Component>(registry, seen);
  seen = now;
  return count;
}

bool sameView(const spec::View& a, const spec::View& b) {
  return a.view_from_world == b.view_from_world && a.clip_from_view == b.clip_from_view;
}

bool sameValue(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void append(std::string& words, std::string_view more) {
  if (words.find(more) != std::string::npos) return;
  if (!words.empty()) words += ", ";
  words += more;
}

}  // namespace

void InvalidationLog::note(Cause cause, std::string words) {
  notes_.push_back({cause, std::move(words)});
}

void InvalidationLog::noticeArrivals(const World& world, std::uint64_t bytes) {
  if (bytes == 0) return;
  note(Cause::Arrived,
       fmt::format("{} kB arrived{}", (bytes + 999) / 1000, world.loaded() ? ", the last" : ""));
}

void InvalidationLog::noticeWorld(const World& world) {
  const ecs::Registry& registry = world.registry();
  const auto nodes = changes<scene::WorldTransform>(registry, transforms_);
  const auto groups = changes<scene::RigidGroupComponent>(registry, groups_);
  if (!std::exchange(world_known_, true)) {
    changes<scene::LampComponent>(registry, lamps_);
    changes<scene::LocalLightComponent>(registry, local_lights_);
    changes<scene::MaterialComponent>(registry, materials_);
    return;
  }
  if (groups && *groups > 0)
    note(Cause::Moved, counted(*groups, "group") + " moved");
  else if (nodes && *nodes > 0)
    note(Cause::Moved, counted(*nodes, "node") + " moved");
  if (const auto lamps = changes<scene::LampComponent>(registry, lamps_))
    note(Cause::Lights, counted(std::max<std::size_t>(*lamps, 1), "lamp") + " changed");
  if (const auto lights = changes<scene::LocalLightComponent>(registry, local_lights_))
    note(Cause::Lights, counted(std::max<std::size_t>(*lights, 1), "light") + " changed");
  if (const auto materials = changes<scene::MaterialComponent>(registry, materials_))
    note(Cause::Materials, counted(std::max<std::size_t>(*materials, 1), "material") + " changed");
}

void InvalidationLog::noticeEnvironment(const lighting::Environment& environment) {
  if (environment.version() == environment_) return;
  const bool first = std::exchange(environment_, environment.version()) == 0;
  if (first) {
    // The first step has nothing to compare with.
  } else if (environment.lightsVersion() != lights_) {
    note(Cause::Environment, "other light from outside");
  } else {
    if (environment.turnDegrees() != turn_) note(Cause::Environment, "light turned");
    if (environment.fade() != fade_) note(Cause::Environment, "light faded");
    if (environment.intensity() != intensity_) note(Cause::Environment, "light's intensity changed");
  }
  lights_ = environment.lightsVersion();
  turn_ = environment.turnDegrees();
  fade_ = environment.fade();
  intensity_ = environment.intensity();
}

void InvalidationLog::noticeSettings(const FrameSettings& settings) {
  if (!settings_) note(Cause::Settings, "first frame");
  if (settings_ && settings != *settings_)
    for (const SettingRow& row : settingRows())
      if (!sameValue(row.get(settings), row.get(*settings_)))
        note(row.name == "exposure" ? Cause::Exposure : Cause::Settings,
             fmt::format("{}: {}", row.label, settingWord(row, settings)));
  settings_ = settings;
}

void InvalidationLog::noticeView(const spec::View& view, const spec::Size& size) {
  if (!view_ || !sameView(view, *view_)) note(Cause::View, "camera");
  if (view_ && !(size == size_)) note(Cause::View, "size of the picture");
  view_ = view;
  size_ = size;
}

std::string InvalidationLog::of(std::uint32_t causes, std::string_view otherwise) const {
  std::string words;
  for (const Note& note : notes_)
    if ((causes & static_cast<std::uint32_t>(note.cause)) != 0) append(words, note.words);
  return words.empty() ? std::string(otherwise) : words;
}

}  // namespace lambent::frame
