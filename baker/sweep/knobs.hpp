// The room baker/sweep owns `lambent accuracy`: it turns one knob at a time, bakes, draws, compares with the
// reference and says what each setting costs and how wrong it is. This file is the table of knobs: a row for
// each option of a bake or a frame that trades accuracy for time or bytes. Only knobs that the scene calls
// for are turned. A scene's facts and the words of the command line come in, a list of settings goes out,
// the base first. Nothing here runs anything; errors name a knob or a value that is not known.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baker/bake/options.hpp"
#include "baker/plan/effect_plan.hpp"
#include "runtime/base/result.hpp"

namespace lambent::baker {

// SceneFacts is what the plan of a scene says about which knobs it has.
struct SceneFacts {
  bool surfaces = false, glossy = false, volumes = false, neighborhoods = false;
  bool many_bodies = false;  // bodies light and shadow each other through captures
  bool many_probes = false;  // light comes near, so it is sampled at several points
};
SceneFacts factsOf(const EffectPlan& plan);

struct Knob {
  enum class Side : std::uint8_t { Bake, Frame };

  std::string_view name;   // as in --knob; for most the option's own name
  std::string_view title;  // as a heading
  std::string_view about;  // what it trades, one sentence
  Side side = Side::Bake;
  bool SceneFacts::*called_for = nullptr;  // null: always
  std::string_view draft_values;           // coarse first, separated by commas
  std::string_view values{};               // for the other qualities; empty: the same
  std::string_view usual{};  // the value that stands for the default, for which no option is given
};

// Returns the knobs in the order of the page.
std::span<const Knob> knobs();

// A Setting is one value of one knob, all others at their base.
struct Setting {
  const Knob* knob = nullptr;
  std::string value;
  BakeOptions bake;
  std::map<std::string, std::string> bake_words;   // options of lambent bake that differ from the base
  std::map<std::string, std::string> frame_words;  // options of lambent-demo
  double memory_share = 1.0;                       // of the GPU memory that planes of transfer take

  std::string name() const;     // as a reader knows it: "draft quality", "rays 512"
  std::string command() const;  // a command line that gives this setting
  bool isPreset() const;        // a --quality of the bake
  bool isBaked() const { return knob->side == Knob::Side::Bake; }
  bool isOfKeyLights() const;  // comes to nothing where no key lights are found
};

// Returns the settings to measure at this quality, the base first. `asked` is a list of KNOB or KNOB=V1,V2;
// if it is empty, all knobs that the scene calls for are turned to their own values.
Result<std::vector<Setting>> settingsOf(const SceneFacts& facts, Quality quality,
                                        std::span<const std::string> asked);

}  // namespace lambent::baker
