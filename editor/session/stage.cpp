#include "editor/session/stage.hpp"

#include <utility>

#include "runtime/scene/instantiate.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::editor {

Stage::Stage(frame::World world, lighting::Environment environment)
    : world_(std::move(world)), environment_(std::move(environment)) {
  environment_entity_ = scene::addEnvironment(world_.registry());
}

Result<Stage> Stage::create(std::uint64_t max_memory_bytes) {
  auto environment = lighting::Environment::create({});
  if (!environment) return failAgain(environment.error());
  return Stage(frame::World({.max_resident_bytes = max_memory_bytes}), std::move(*environment));
}

Result<void> Stage::followLights(const WorldState& state) {
  if (state.lights == words_ && state.fade_lights == fade_words_) return {};
  // The words are stored even if they fail, so that they are not loaded again in every frame.
  words_ = state.lights, fade_words_ = state.fade_lights;
  auto lights = spec::parseLights(state.lights);
  if (!lights) return failAgain(lights.error());
  auto fade_lights = spec::parseLights(state.fade_lights);
  if (!fade_lights) return failAgain(fade_lights.error());
  if (auto done = environment_.setLights(*lights, *fade_lights); !done) return done;
  lights_ = std::move(*lights), fade_lights_ = std::move(*fade_lights);
  followEnvironment();
  return {};
}

std::vector<Error> Stage::follow(const WorldState& state) {
  std::vector<Error> errors;
  if (auto done = followLights(state); !done) errors.push_back(done.error());
  std::vector<spec::KeyEdit> key_edits;
  for (const std::string& word : state.key_edits) {
    const auto edit = spec::parseKeyEdit(word);
    if (edit)
      key_edits.push_back(*edit);
    else
      errors.push_back(edit.error());
  }
  environment_.setKeyEdits(std::move(key_edits));
  frame::FrameSettings settings;
  for (const auto& [name, word] : state.settings)
    if (auto put = frame::putSetting(settings, name, word); !put) errors.push_back(put.error());
  settings.exposure_ev = state.exposure_ev;
  environment_.setMostKeys(settings.mostKeys());
  if (auto checked = frame::checkSettings(settings); checked)
    settings_ = settings;
  else
    errors.push_back(checked.error());
  return errors;
}

void Stage::followEnvironment() {
  const auto* component = world_.registry().tryGet<scene::EnvironmentComponent>(environment_entity_);
  if (!component) return;
  environment_.setTurn(component->rotation_deg);
  environment_.setFade(component->fade);
  environment_.setIntensity(component->intensity);
}

}  // namespace lambent::editor
