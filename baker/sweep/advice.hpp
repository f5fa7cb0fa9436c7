// Says which setting to take, and why: along each cost, the front of what was measured and its knee
// (pareto.hpp). Only settings that can change a cost compete: frames do not change how long a bake takes.
// Pure.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "baker/sweep/sweep.hpp"

namespace lambent::baker {

struct Cost {
  const char* id;     // of its files
  const char* title;  // as an axis
  const char* words;  // within a sentence
  const char* verb;   // how its setting is used
  std::string (*text)(double);
  double (*of)(const Measured&);
  bool (*competes)(const Measured& setting, const Measured& base);
};

// Returns time of a bake, time of a frame, bytes of a bundle, bytes on the GPU.
std::span<const Cost> costs();

struct Advice {
  std::vector<std::size_t> competing;  // indices of the settings, equal ones once
  std::vector<std::size_t> front;      // of these, in the order of cost
  std::optional<std::size_t> chosen;   // of these
  std::string reason;                  // plain sentences
};

Advice adviceOn(const Cost& cost, std::span<const Measured> settings);

// Returns the setting as a reader knows it: "draft quality", "rays 512".
std::string titleOf(const Measured& measured);

// Returns what one knob does to the error, in one sentence. The settings are those of the knob.
std::string effectOf(std::span<const Measured* const> of_knob);

}  // namespace lambent::baker
