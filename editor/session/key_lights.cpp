#include "editor/session/key_lights.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

#include "editor/session/session.hpp"
#include "runtime/lighting/key_lights.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

namespace {

using FoundKey = lighting::Environment::FoundKey;

double fluxOf(const spec::Disc& disc) {
  return lighting::solidAngle(double{disc.radius_rad}) * lighting::luminance(disc.radiance);
}

// Returns the indices of the lights that are environment maps, or of those that are suns.
std::vector<std::size_t> placesOf(const std::vector<spec::Light>& lights, bool environment_maps) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < lights.size(); ++i)
    if (environment_maps ? std::holds_alternative<spec::EnvironmentMapLight>(lights[i])
                         : std::holds_alternative<spec::SunLight>(lights[i]))
      places.push_back(i);
  return places;
}

const std::vector<std::string>& wordsOf(const Session& session, std::size_t set) {
  const WorldState& world = session.document.world();
  return set == 0 ? world.lights : world.fade_lights;
}

Result<FoundKey> findKey(const Session& session, std::size_t key) {
  const std::vector<FoundKey> found = session.stage.environment().foundKeys();
  if (key >= found.size())
    return fail("key light", fmt::format("there is no key light {}", key),
                fmt::format("there are {}, counted from 0", found.size()));
  return found[key];
}

// Returns the words without that of this edit.
std::vector<std::string> without(const std::vector<std::string>& words, const spec::KeyEdit& edit) {
  std::vector<std::string> kept;
  for (const std::string& word : words)
    if (const auto parsed = spec::parseKeyEdit(word); !parsed || !(*parsed == edit)) kept.push_back(word);
  return kept;
}

void putEdit(Session& session, const FoundKey& found, const spec::KeyEdit& edit, const char* name) {
  session.history.editWorld(name, [&](WorldState& world) {
    if (found.edit) world.key_edits = without(world.key_edits, *found.edit);
    world.key_edits.push_back(spec::keyEditWord(edit));
  });
}

spec::KeyEdit editOf(const FoundKey& found) {
  if (found.edit) return *found.edit;
  return {.set = found.set, .found = found.found.direction, .towards = found.found.direction};
}

struct FoundSun {
  std::size_t place = 0;  // index among the words of its set
  spec::SunLight light;
};

Result<FoundSun> sunOf(const Session& session, std::size_t key) {
  const std::vector<KeyLight> keys = keyLightsOf(session);
  if (key < keys.size() && keys[key].light < wordsOf(session, keys[key].set).size()) {
    const auto light = spec::parseLight(wordsOf(session, keys[key].set)[keys[key].light]);
    if (light && std::holds_alternative<spec::SunLight>(*light))
      return FoundSun{.place = keys[key].light, .light = std::get<spec::SunLight>(*light)};
  }
  return fail("key light", "its sun is not among the lights any more", "wait until the lights are loaded");
}

std::vector<std::string>& wordsOf(WorldState& world, std::size_t set) {
  return set == 0 ? world.lights : world.fade_lights;
}

}  // namespace

std::string KeyLight::source() const {
  if (in_map) return std::filesystem::path(word).filename().string();
  return fmt::format("{}sun {}", piece ? "piece of " : "", light);
}

std::vector<KeyLight> keyLightsOf(const Session& session) {
  const lighting::Environment& environment = session.stage.environment();
  constexpr double kFluxOfBandZero = 3.5449077;  // sqrt(4 pi)
  const double all = kFluxOfBandZero * lighting::luminance(environment.light().c[0]);
  std::vector<KeyLight> keys;
  for (const FoundKey& found : environment.foundKeys()) {
    const std::vector<spec::Light>& lights =
        found.set == 0 ? session.stage.lights() : session.stage.fadeLights();
    const std::vector<std::size_t> places = placesOf(lights, found.origin.in_map);
    const std::vector<std::string>& words = wordsOf(session, found.set);
    const glm::vec3 towards = environment.worldFromLight() * found.now.direction;
    const spec::AzimuthElevation angles = spec::azimuthElevation(towards);
    KeyLight key{.set = found.set,
                 .light = 0,
                 .word = {},
                 .in_map = found.origin.in_map,
                 .piece = found.origin.piece,
                 .edited = found.edit.has_value(),
                 .towards_ws = towards,
                 .azimuth_deg = angles.azimuth_deg,
                 .elevation_deg = angles.elevation_deg,
                 .radius_deg = glm::degrees(found.now.radius_rad),
                 .radiance = environment.shareOf(found.set) * found.now.radiance,
                 .factor = found.edit ? found.edit->factor : glm::vec3(1.0f),
                 .share = all > 0.0 ? double{environment.shareOf(found.set)} * fluxOf(found.now) / all : 0.0};
    if (found.origin.index < places.size()) key.light = places[found.origin.index];
    if (key.light < words.size()) key.word = words[key.light];
    keys.push_back(std::move(key));
  }
  return keys;
}

Result<void> moveKeyLight(Session& session, std::size_t key, const glm::vec3& towards_ws) {
  const auto found = findKey(session, key);
  if (!found) return failAgain(found.error());
  const glm::mat3 light_from_world = glm::transpose(session.stage.environment().worldFromLight());
  const glm::vec3 towards = glm::normalize(light_from_world * towards_ws);
  if (found->origin.in_map) {
    spec::KeyEdit edit = editOf(*found);
    edit.towards = towards;
    putEdit(session, *found, edit, "turn of key light");
    return {};
  }
  const auto sun = sunOf(session, key);
  if (!sun) return failAgain(sun.error());
  spec::SunLight now = sun->light;
  const glm::quat turn(found->now.direction, towards);
  const spec::AzimuthElevation to =
      spec::azimuthElevation(turn * spec::directionFromAzimuthElevation(now.azimuth_deg, now.elevation_deg));
  now.azimuth_deg = to.azimuth_deg, now.elevation_deg = to.elevation_deg;
  const std::string word = sunWord(now);
  session.history.editWorld("turn of sun",
                            [&](WorldState& world) { wordsOf(world, found->set)[sun->place] = word; });
  return {};
}

Result<void> dimKeyLight(Session& session, std::size_t key, const glm::vec3& factor) {
  for (int channel = 0; channel < 3; ++channel)
    if (!(factor[channel] >= 0.0f && factor[channel] <= spec::kMostKeyFactor))
      return fail("key light", fmt::format("{} is no factor of it", factor[channel]), "give 0 to a million");
  const auto found = findKey(session, key);
  if (!found) return failAgain(found.error());
  if (found->origin.in_map) {
    spec::KeyEdit edit = editOf(*found);
    edit.factor = factor;
    putEdit(session, *found, edit, "strength of key light");
    return {};
  }
  const auto sun = sunOf(session, key);
  if (!sun) return failAgain(sun.error());
  spec::SunLight now = sun->light;
  now.radiance *= factor;
  const std::string word = sunWord(now);
  session.history.editWorld("strength of sun",
                            [&](WorldState& world) { wordsOf(world, found->set)[sun->place] = word; });
  return {};
}

Result<void> resetKeyLights(Session& session, std::optional<std::size_t> key) {
  if (!key) {
    if (!session.document.world().key_edits.empty())
      session.history.editWorld("key lights as found", [](WorldState& world) { world.key_edits.clear(); });
    return {};
  }
  const auto found = findKey(session, *key);
  if (!found) return failAgain(found.error());
  if (!found->edit) return {};
  session.history.editWorld("key light as found", [&](WorldState& world) {
    world.key_edits = without(world.key_edits, *found->edit);
  });
  return {};
}

std::string sunWord(const spec::SunLight& sun) {
  return fmt::format("sun:{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g}", sun.azimuth_deg, sun.elevation_deg,
                     sun.angle_deg, sun.radiance.r, sun.radiance.g, sun.radiance.b);
}

bool isEnvironmentMap(const std::string& word) {
  const auto light = spec::parseLight(word);
  return light && std::holds_alternative<spec::EnvironmentMapLight>(*light);
}

void replaceLights(const Session& session, WorldState& world, std::vector<std::string> lights) {
  const auto stays = [&](const std::string& word) { return std::ranges::find(lights, word) != lights.end(); };
  const bool all_stay = std::ranges::all_of(
      world.lights, [&](const std::string& word) { return !isEnvironmentMap(word) || stays(word); });
  if (!all_stay) {
    const std::vector<FoundKey> found = session.stage.environment().foundKeys();
    const std::vector<KeyLight> keys = keyLightsOf(session);
    std::erase_if(world.key_edits, [&](const std::string& word) {
      const auto edit = spec::parseKeyEdit(word);
      if (!edit || edit->set != 0) return !edit;
      for (std::size_t i = 0; i < found.size(); ++i)
        if (found[i].edit == *edit) return !stays(keys[i].word);
      return true;  // an edit of no known key light may belong to an environment map that is removed
    });
  }
  world.lights = std::move(lights);
}

}  // namespace lambent::editor
