#include "runtime/frame/frame_pass.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "runtime/scene/materials.hpp"

namespace lambent::frame {

namespace {

// Sets `seen` to the current version of a type of components. Returns whether it was another one.
template <typename Component>
bool changed(const ecs::Registry& registry, std::uint64_t& seen) {
  const std::uint64_t now = registry.version<Component>();
  return std::exchange(seen, now) != now;
}

// The names of all counts: a list for each kind of passes, in their order.
constexpr std::initializer_list<std::string_view> kCounts[] = {
    {"volumes", "groups", "bodies", "local_lights", "shadowed_lights", "shadowed_lights_left_out",
     "light_probes", "light_probes_risen", "light_probes_written"},
    {"patch_rooms", "patch_rooms_to_come", "patches", "lights_bounced", "patch_draws_gathered"},
    {"cells_shaded", "draws_shaded"},
    {"neighborhood_grids", "neighborhood_grids_ready", "neighborhood_grids_written", "neighborhood_pairs",
     "neighborhood_receivers", "neighborhood_arrivals", "neighborhood_vertex_receivers",
     "neighborhood_vertex_receivers_shaded", "neighborhood_arrivals_left_out"},
    {"light_probes_captured", "light_probes_waiting", "capture_pages", "capture_tiles",
     "capture_bodies_drawn", "capture_triangles", "capture_pixels"},
    {"shadow_cubes_drawn", "key_lights", "key_maps_drawn", "reflection_probes", "reflection_probes_captured"},
    {"draws_out_of_view", "volumes_shaded", "volume_slabs_written", "volumes_out_of_view", "volumes_drawn"}};

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
  const bool nodes = changed<scene::WorldTransform>(registry, transforms_);
  const bool groups = changed<scene::RigidGroupComponent>(registry, groups_);
  const bool lamps = changed<scene::LampComponent>(registry, lamps_);
  const bool lights = changed<scene::LocalLightComponent>(registry, local_lights_);
  const bool materials = changed<scene::MaterialComponent>(registry, materials_);
  if (!std::exchange(world_known_, true)) return;
  if (groups || nodes) note(Cause::Moved, groups ? "groups moved" : "nodes moved");
  if (lamps) note(Cause::Lights, "lamps changed");
  if (lights) note(Cause::Lights, "lights changed");
  if (materials) note(Cause::Materials, "materials changed");
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
  if (!view_ || view.view_from_world != view_->view_from_world ||
      view.clip_from_view != view_->clip_from_view)
    note(Cause::View, "camera");
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

StepCounts::StepCounts() {
  for (const auto& names : kCounts)
    for (const std::string_view name : names) counts_.push_back({.name = name});
}

void StepCounts::clear() {
  for (Count& count : counts_) count.value = 0;
}

std::size_t StepCounts::placeOf(std::string_view name) const {
  const auto found = std::ranges::find(counts_, name, &Count::name);
  if (found == counts_.end()) throw std::out_of_range(fmt::format("no pass counts {}", name));
  return static_cast<std::size_t>(found - counts_.begin());
}

void StepCounts::add(std::string_view name, std::uint64_t value) {
  counts_[placeOf(name)].value += value;
}

std::uint64_t StepCounts::operator[](std::string_view name) const {
  return counts_[placeOf(name)].value;
}

}  // namespace lambent::frame
