#include <algorithm>
#include <array>

#include "editor/commands/rows.hpp"
#include "editor/session/key_lights.hpp"
#include "runtime/spec/light.hpp"

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
};

}  // namespace

std::span<const Command> lightCommands() {
  return kLightRows;
}

}  // namespace lambent::editor
