#include <algorithm>
#include <array>

#include "editor/commands/rows.hpp"
#include "editor/session/key_lights.hpp"
#include "runtime/frame/frame_settings.hpp"
#include "runtime/spec/light.hpp"
#include "runtime/spec/numbers.hpp"

namespace lambent::editor {

namespace {

Result<std::string> fromInfinity(const std::string& word) {
  const auto light = spec::parseLight(word);
  if (!light) return failAgain(light.error());
  if (!spec::localLights(std::vector{*light}).empty())
    return fail(word, "stands in the scene", "create-sphere and create-disc put lights there");
  if (const auto* environment_map = std::get_if<spec::EnvironmentMapLight>(&*light)) {
    std::error_code ignored;
    if (!std::filesystem::exists(environment_map->file, ignored))
      return fail(word, "is not there", "name an .hdr or .exr file");
  }
  return word;
}

Result<void> addLight(Session& session, Words words) {
  return fromInfinity(words[0]).map([&](const std::string& word) {
    session.history.editWorld("add light", [&](WorldState& world) { world.lights.push_back(word); });
  });
}

Result<void> removeLight(Session& session, Words words) {
  std::vector<std::string> lights = session.document.world().lights;
  const std::size_t index =
      words[0].find_first_not_of("0123456789") == std::string::npos ? std::stoul(words[0]) : lights.size();
  if (index >= lights.size())
    return fail("remove-light", "there is no light " + words[0], fmt::format("there are {}", lights.size()));
  lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(index));
  session.history.editWorld("remove light",
                            [&](WorldState& world) { replaceLights(session, world, lights); });
  return {};
}

std::filesystem::path workingFolder() {
  std::error_code ignored;
  return std::filesystem::current_path(ignored);
}

// Replaces the present environment map, or else all lights, because an environment map has its own sun.
Result<void> setEnvironmentMap(Session& session, Words words) {
  if (words.empty()) {
    session.window.dialog = Dialog{.kind = Dialog::Kind::OpenFile,
                                   .title = "Light from an environment map",
                                   .endings = {".hdr", ".exr"},
                                   .folder = workingFolder(),
                                   .answered = [](Session& s, const std::string& file) {
                                     runOrLog(s, "environment-map", std::array{file});
                                   }};
    return {};
  }
  return fromInfinity(words[0]).map([&](const std::string& word) {
    session.history.editWorld("environment map " + std::filesystem::path(word).stem().string(),
                              [&](WorldState& world) {
                                std::vector<std::string> with = world.lights;
                                const auto there = std::ranges::find_if(with, isEnvironmentMap);
                                if (there != with.end())
                                  *there = word;
                                else
                                  with = {word};
                                replaceLights(session, world, std::move(with));
                              });
  });
}

Result<void> setLights(Session& session, Words words) {
  for (const std::string& word : words)
    if (const auto checked = fromInfinity(word); !checked) return failAgain(checked.error());
  session.history.editWorld("lights", [&](WorldState& world) {
    replaceLights(session, world, {words.begin(), words.end()});
  });
  return {};
}

Result<void> setExposure(Session& session, Words words) {
  const std::optional<float> ev = words[0] == "auto" ? std::nullopt : spec::parseNumber(words[0]);
  if (words[0] != "auto" && !(ev && *ev >= -64.0f && *ev <= 64.0f))
    return fail("exposure", words[0] + " is not a number of stops", "give -64..64 or auto");
  session.history.editWorld("exposure", [&](WorldState& world) { world.exposure_ev = ev; });
  return {};
}

constexpr std::size_t kMostLights = 100;

using nlohmann::json;

json rgb(const glm::vec3& v) {
  return {v.r, v.g, v.b};
}

Answer listKeys(Session& session) {
  session.followDocument();
  json rows = json::array();
  for (const KeyLight& key : keyLightsOf(session))
    rows.push_back({{"azimuth", key.azimuth_deg},
                    {"elevation", key.elevation_deg},
                    {"radius", key.radius_deg},
                    {"radiance", rgb(key.radiance)},
                    {"share", key.share},
                    {"source", key.source()},
                    {"set", key.set},
                    {"edited", key.edited},
                    {"factor", rgb(key.factor)}});
  return rows;
}

Result<std::size_t> keyNumber(Session& session, const std::string& word) {
  session.followDocument();
  if (word.empty() || word.size() > 6 || word.find_first_not_of("0123456789") != std::string::npos)
    return fail("key light", "\"" + word + "\" is no number of one", "\"keys\" lists them, counted from 0");
  return std::stoul(word);
}

Result<std::vector<float>> numbers(Words words) {
  std::vector<float> values;
  for (const std::string& word : words) {
    const auto value = spec::parseNumber(word);
    if (!value) return fail("key light", "\"" + word + "\" is not a number", "give a number");
    values.push_back(*value);
  }
  return values;
}

Result<void> moveKey(Session& session, Words words) {
  const auto key = keyNumber(session, words[0]);
  if (!key) return failAgain(key.error());
  const auto angles = numbers(words.subspan(1));
  if (!angles) return failAgain(angles.error());
  const float azimuth_deg = (*angles)[0], elevation_deg = (*angles)[1];
  if (!(elevation_deg >= -90.0f && elevation_deg <= 90.0f))
    return fail("move-key", words[2] + " is no elevation", "give -90..90 degrees");
  return moveKeyLight(session, *key, spec::directionFromAzimuthElevation(azimuth_deg, elevation_deg));
}

Result<void> dimKey(Session& session, Words words) {
  const auto key = keyNumber(session, words[0]);
  if (!key) return failAgain(key.error());
  const auto factors = numbers(words.subspan(1));
  if (!factors) return failAgain(factors.error());
  if (factors->size() == 2) return fail("dim-key", "needs one factor or three", "give R or R G B");
  const std::vector<float>& f = *factors;
  return dimKeyLight(session, *key, f.size() == 1 ? glm::vec3(f[0]) : glm::vec3(f[0], f[1], f[2]));
}

Result<void> resetKey(Session& session, Words words) {
  if (words.empty()) return resetKeyLights(session, {});
  return keyNumber(session, words[0]).and_then([&](std::size_t key) { return resetKeyLights(session, key); });
}

Result<void> setQuality(Session& session, Words words) {
  frame::FrameSettings settings = session.stage.settings();
  if (auto put = frame::putQuality(settings, words[0]); !put) return put;
  session.history.editWorld("quality " + words[0], [&](WorldState& world) {
    for (const std::string_view name : frame::qualitySettings()) {
      const frame::SettingRow* row = frame::findSetting(name);
      const std::string word = frame::settingWord(*row, settings);
      // Settings with default values are not stored.
      if (word == frame::settingWord(*row, {}))
        world.settings.erase(std::string(name));
      else
        world.settings[std::string(name)] = word;
    }
  });
  session.viewing.changed = true;
  return {};
}

}  // namespace

std::vector<Command> lightCommands() {
  return {scripted("lights", "The lights from infinity, in place of those there are", "LIGHT...", 1,
                   kMostLights, setLights),
          scripted("add-light", "One more light from infinity", "LIGHT", 1, 1, addLight),
          scripted("remove-light", "Take one away, counted from 0", "NUMBER", 1, 1, removeLight),
          scripted("environment-map", "Light from this environment map; without a name a dialog asks",
                   "[FILE]", 0, 1, setEnvironmentMap),
          scripted("exposure", "Stops above radiance 1 = white", "EV|auto", 1, 1, setExposure),
          scripted("keys", "The key lights that were found: where they stand, how strong they are", "", 0, 0,
                   listKeys),
          scripted("move-key", "A key light stands there, in degrees of the world", "NUMBER AZ EL", 3, 3,
                   moveKey),
          scripted("dim-key",
                   "Factors on a key light: of what was found in an environment map, of what a sun has",
                   "NUMBER R [G B]", 2, 4, dimKey),
          scripted("reset-key", "A key light of an environment map, or all of them, as found", "[NUMBER]", 0,
                   1, resetKey),
          scripted("quality", "How many key lights there are and how finely they shadow", "low|default|high",
                   1, 1, setQuality)};
}

}  // namespace lambent::editor
