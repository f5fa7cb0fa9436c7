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

Answer addLight(Session& session, Words words) {
  const auto word = fromInfinity(words[0]);
  if (!word) return failAgain(word.error());
  session.history.editWorld("add light", [&](WorldState& world) { world.lights.push_back(*word); });
  return nullptr;
}

Answer removeLight(Session& session, Words words) {
  const auto& lights = session.document.world().lights;
  const std::size_t index =
      words[0].find_first_not_of("0123456789") == std::string::npos ? std::stoul(words[0]) : lights.size();
  if (index >= lights.size())
    return fail("remove-light", "there is no light " + words[0], fmt::format("there are {}", lights.size()));
  std::vector<std::string> left = lights;
  left.erase(left.begin() + static_cast<std::ptrdiff_t>(index));
  session.history.editWorld("remove light", [&](WorldState& world) { replaceLights(session, world, left); });
  return nullptr;
}

// Replaces the present environment map, or else all lights, because an environment map has its own sun.
Answer environmentMap(Session& session, Words words) {
  if (words.empty()) {
    Dialog ask;
    ask.kind = Dialog::Kind::OpenFile;
    ask.title = "Light from an environment map";
    ask.kinds = {{"Environment maps", {".hdr", ".exr"}}};
    std::error_code ignored;
    ask.folder = std::filesystem::current_path(ignored);
    ask.answered = [](Session& s, const std::string& file) {
      if (auto done = runCommand(s, "environment-map", std::array{file}); !done) s.log.error(done.error());
    };
    session.window.dialog = std::move(ask);
    return nullptr;
  }
  const auto word = fromInfinity(words[0]);
  if (!word) return failAgain(word.error());
  session.history.editWorld("environment map " + std::filesystem::path(*word).stem().string(),
                            [&](WorldState& world) {
                              std::vector<std::string> with = world.lights;
                              const auto there = std::ranges::find_if(with, [](const std::string& light) {
                                const auto parsed = spec::parseLight(light);
                                return parsed && std::holds_alternative<spec::EnvironmentMapLight>(*parsed);
                              });
                              if (there != with.end())
                                *there = *word;
                              else
                                with = {*word};
                              replaceLights(session, world, std::move(with));
                            });
  return nullptr;
}

Answer environmentMapFolder(Session& session, Words words) {
  if (!words.empty()) {
    session.environment_maps.addFolder(words[0]);
    return nullptr;
  }
  Dialog ask;
  ask.kind = Dialog::Kind::Folder;
  ask.title = "Folder of environment maps";
  std::error_code ignored;
  ask.folder = std::filesystem::current_path(ignored);
  ask.answered = [](Session& s, const std::string& folder) { s.environment_maps.addFolder(folder); };
  session.window.dialog = std::move(ask);
  return nullptr;
}

Answer lights(Session& session, Words words) {
  std::vector<std::string> checked;
  for (const std::string& given : words) {
    const auto word = fromInfinity(given);
    if (!word) return failAgain(word.error());
    checked.push_back(*word);
  }
  session.history.editWorld("lights", [&](WorldState& world) { replaceLights(session, world, checked); });
  return nullptr;
}

Answer exposure(Session& session, Words words) {
  std::optional<float> ev;
  if (words[0] != "auto") {
    char* end = nullptr;
    ev = std::strtof(words[0].c_str(), &end);
    if (*end != '\0' || !(*ev >= -64.0f && *ev <= 64.0f))
      return fail("exposure", words[0] + " is not a number of stops", "give -64..64 or auto");
  }
  session.history.editWorld("exposure", [&](WorldState& world) { world.exposure_ev = ev; });
  return nullptr;
}

constexpr std::size_t kMostLights = 100;

using nlohmann::json;

json rgb(const glm::vec3& v) {
  return {v.r, v.g, v.b};
}

Answer keys(Session& session, Words) {
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

Answer moveKey(Session& session, Words words) {
  const auto key = keyNumber(session, words[0]);
  if (!key) return failAgain(key.error());
  const auto angles = numbers(words.subspan(1));
  if (!angles) return failAgain(angles.error());
  if (!((*angles)[1] >= -90.0f && (*angles)[1] <= 90.0f))
    return fail("move-key", words[2] + " is no elevation", "give -90..90 degrees");
  return answerOf(
      moveKeyLight(session, *key, spec::directionFromAzimuthElevation((*angles)[0], (*angles)[1])));
}

Answer dimKey(Session& session, Words words) {
  const auto key = keyNumber(session, words[0]);
  if (!key) return failAgain(key.error());
  const auto factors = numbers(words.subspan(1));
  if (!factors) return failAgain(factors.error());
  if (factors->size() == 2) return fail("dim-key", "needs one factor or three", "give R or R G B");
  const std::vector<float>& f = *factors;
  return answerOf(dimKeyLight(session, *key, f.size() == 1 ? glm::vec3(f[0]) : glm::vec3(f[0], f[1], f[2])));
}

Answer resetKey(Session& session, Words words) {
  if (words.empty()) return answerOf(resetKeyLights(session, {}));
  const auto key = keyNumber(session, words[0]);
  if (!key) return failAgain(key.error());
  return answerOf(resetKeyLights(session, *key));
}

Answer quality(Session& session, Words words) {
  frame::FrameSettings settings = session.stage.settings();
  if (auto put = frame::putQuality(settings, words[0]); !put) return failAgain(put.error());
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
  return nullptr;
}

Answer measureQuality(Session& session, Words) {
  session.qualities.measure();
  return nullptr;
}

Answer qualityCosts(Session& session, Words) {
  json rows = json::array();
  for (const QualityStudy::Row& row : session.qualities.rows())
    rows.push_back({{"quality", row.quality},
                    {"error", row.error},
                    {"ms", row.cost.milliseconds()},
                    {"keyShadowsMs", row.cost.milliseconds("key shadows")},
                    {"rasterMs", row.cost.milliseconds("raster")}});
  const spec::Size size = session.qualities.size();
  return json{{"qualities", rows}, {"width", size.width}, {"height", size.height}};
}

constexpr std::array kLightRows = {
    scripted("lights", "The lights from infinity, in place of those there are", "LIGHT...", 1, kMostLights,
             &lights),
    scripted("add-light", "One more light from infinity", "LIGHT", 1, 1, &addLight),
    scripted("remove-light", "Take one away, counted from 0", "NUMBER", 1, 1, &removeLight),
    formerly("probe",
             scripted("environment-map", "Light from this environment map; without a name a dialog asks",
                      "[FILE]", 0, 1, &environmentMap)),
    formerly("probe-folder", scripted("environment-map-folder", "Show the environment maps of a folder",
                                      "[FOLDER]", 0, 1, &environmentMapFolder)),
    scripted("exposure", "Stops above radiance 1 = white", "EV|auto", 1, 1, &exposure),
    scripted("keys", "The key lights that were found: where they stand, how strong they are", "", 0, 0,
             &keys),
    scripted("move-key", "A key light stands there, in degrees of the world", "NUMBER AZ EL", 3, 3, &moveKey),
    scripted("dim-key", "Factors on a key light: of what was found in an environment map, of what a sun has",
             "NUMBER R [G B]", 2, 4, &dimKey),
    scripted("reset-key", "A key light of an environment map, or all of them, as found", "[NUMBER]", 0, 1,
             &resetKey),
    scripted("quality", "How many key lights there are and how finely they shadow", "low|default|high", 1, 1,
             &quality),
    scripted("measure-quality", "What each quality costs and loses in this view", "", 0, 0, &measureQuality),
    scripted("quality-costs", "What was measured of them", "", 0, 0, &qualityCosts),
};

}  // namespace

std::span<const Command> lightCommands() {
  return kLightRows;
}

}  // namespace lambent::editor
