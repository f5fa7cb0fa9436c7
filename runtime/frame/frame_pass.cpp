#include "runtime/frame/frame_pass.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "runtime/scene/materials.hpp"

namespace lambent::frame {

namespace {

std::string counted(std::size_t count, std::string_view one) {
  return count == 1 ? fmt::format("a {}", one) : fmt::format("{} {}s", count, one);
}

// Sets `seen` to the current version of a type of components. Returns how many changed, or nothing if it was
// current already.
template <typename Component>
std::optional<std::size_t> changes(const ecs::Registry& registry, std::uint64_t& seen) {
  const std::uint64_t now = registry.version<Component>(), before = std::exchange(seen, now);
  if (now == before) return {};
  std::size_t count = 0;
  for (auto [entity, component] : registry.view<const Component>())
    count += registry.version<Component>(entity) > before ? 1 : 0;
  return count;
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
  const bool known = std::exchange(world_known_, true);
  if (known && groups && *groups > 0)
    note(Cause::Moved, counted(*groups, "group") + " moved");
  else if (known && nodes && *nodes > 0)
    note(Cause::Moved, counted(*nodes, "node") + " moved");
  const auto noteChanged = [&](Cause cause, std::optional<std::size_t> count, std::string_view one) {
    if (known && count) note(cause, counted(std::max<std::size_t>(*count, 1), one) + " changed");
  };
  noteChanged(Cause::Lights, changes<scene::LampComponent>(registry, lamps_), "lamp");
  noteChanged(Cause::Lights, changes<scene::LocalLightComponent>(registry, local_lights_), "light");
  noteChanged(Cause::Materials, changes<scene::MaterialComponent>(registry, materials_), "material");
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

void StepCounts::declare(std::span<const std::string_view> names) {
  for (const std::string_view name : names)
    if (std::ranges::find(counts_, name, &Count::name) == counts_.end()) counts_.push_back({.name = name});
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
  return counts_.empty() ? 0 : counts_[placeOf(name)].value;
}

void FrameContext::because(std::string_view otherwise) const {
  scope->because(log.of(pass->causes, otherwise));
}

bool FrameContext::declares(std::type_index type, bool to_write) const {
  const auto has = [&](const Resources& types) { return std::ranges::find(types, type) != types.end(); };
  return has(pass->writes) || (!to_write && (has(pass->reads) || has(pass->reads_before)));
}

namespace {

using MakePass = MadePass (*)(const PassSetup&);

// These lists name all passes, in their order. Passes of a step bring light to where it is needed; passes of
// a picture draw it.
constexpr MakePass kStepPasses[] = {
    &makeUploadPass,        // uploads what has arrived, within the budget
    &makeTransformsPass,    // places nodes and rigid groups
    &makeLightPass,         // light at each light probe, windowed, in its group's frame
    &makePatchBouncesPass,  // bounces of lights among the surfaces, and of key lights
    &makeDiffusePass,       // E/pi at every vertex whose light or transfer changed
    &makeSeenSkyPass,       // what vertices of smooth dielectrics see of the sky, once transfer has arrived
    &makeGlossyPass,        // transferred light at samples of glossy surfaces, likewise
    &makeNeighborhoodPass,  // changes of light around bodies with grids
    &makeCapturePass,       // light between bodies, which arrives with the next step
};

constexpr MakePass kPicturePasses[] = {
    &makeSkyPass,                     // the sky behind all surfaces
    &makeLocalShadowsPass,            // shadow cubes of lights among the surfaces
    &makeKeyShadowsPass,              // shadow maps of key lights over the visible area
    &makePrefilteredEnvironmentPass,  // the sky as rough mirrors show it
    &makeReflectionProbesPass,        // rooms as mirrors in them show them
    &makeRasterPass,                  // surfaces, sky, blended surfaces: linear radiance
    &makeVolumePass,                  // light in volumes that are in view, as rays look it up
    &makeMarchPass,                   // what volumes scatter and absorb
    &makeToneMapPass,                 // exposure, tone curve, sRGB
    &makeOverlayPass,                 // overlays and wires, not tone-mapped
};

Result<std::vector<std::unique_ptr<FramePass>>> make(std::span<const MakePass> list, const PassSetup& setup) {
  std::vector<std::unique_ptr<FramePass>> passes;
  for (const MakePass one : list) {
    MadePass made = one(setup);
    if (!made) return failAgain(made.error());
    passes.push_back(std::move(*made));
  }
  return passes;
}

}  // namespace

Result<PassList> makePassList(const FrameOptions& options, const lighting::Environment& environment,
                              Blackboard& board) {
  auto modules = std::make_unique<SurfaceModules>();
  board.offer(*modules);
  const PassSetup setup{.options = options, .environment = environment, .board = board};
  auto step = make(kStepPasses, setup);
  if (!step) return failAgain(step.error());
  auto picture = make(kPicturePasses, setup);
  if (!picture) return failAgain(picture.error());
  return PassList{
      .surface_modules = std::move(modules), .step = std::move(*step), .picture = std::move(*picture)};
}

}  // namespace lambent::frame
