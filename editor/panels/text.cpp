#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "editor/panels/panel.hpp"

namespace lambent::editor {

namespace {

std::string scaled(double value, double step, const std::array<const char*, 4>& units) {
  std::size_t unit = 0;
  while (value >= step && unit + 1 < units.size()) value /= step, ++unit;
  return fmt::format("{:.{}f}{}", value, unit == 0 || value >= 100.0 ? 0 : 1, units[unit]);
}

}  // namespace

std::string countText(double count) {
  return scaled(count, 1000.0, {"", " k", " M", " G"});
}
std::string bytesText(double bytes) {
  return scaled(bytes, 1024.0, {" B", " KiB", " MiB", " GiB"});
}
std::string timeText(double seconds) {
  if (seconds < 1.0) return fmt::format("{:.0f} ms", 1000.0 * seconds);
  if (seconds < 60.0) return fmt::format("{:.0f} s", seconds);
  const auto whole = static_cast<long>(seconds + 0.5);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

ImVec4 severityColor(Severity severity) {
  return std::array{kNoteColor, kWarningColor, kErrorColor}[static_cast<std::size_t>(severity)];
}

ImVec4 standingColor(Standing standing) {
  return std::array{kGoodColor, kNoteColor, kWarningColor, kErrorColor}[static_cast<std::size_t>(standing)];
}

namespace {

struct FieldWords {
  std::string_view component, field, label, help;
};

// Fields whose names do not make a good label, or need a sentence.
constexpr std::array kWords = {
    FieldWords{"Transform", "translation", "Position", "Relative to the parent, in metres"},
    FieldWords{"Transform", "rotation", "Rotation", "Degrees about x, then y, then z"},
    FieldWords{"Light", "range", "Range", "Where the light has faded out; 0: nowhere"},
    FieldWords{"Light", "inner_cone", "Inner cone", "Half the angle within which the light is full"},
    FieldWords{"Light", "outer_cone", "Outer cone", "Half the angle at which the light ends"},
    FieldWords{"Light", "enabled", "On", ""},
    FieldWords{"Lamp", "enabled", "On", ""},
    FieldWords{"Lamp", "strength", "Strength", "Factor on the color; the product is the lamp's radiance"},
    FieldWords{"Camera", "yfov", "Field of view", "Vertical angle"},
    FieldWords{"Camera", "aspect", "Aspect", "Width over height; 0: that of the picture"},
    FieldWords{"Camera", "xmag", "Half width", ""},
    FieldWords{"Camera", "ymag", "Half height", ""},
    FieldWords{"Camera", "znear", "Near plane", ""},
    FieldWords{"Camera", "zfar", "Far plane", "0: infinitely far"},
    FieldWords{"Material", "alpha", "Opacity", ""},
    FieldWords{"Material", "ior", "Refractive index", "1.5 for glass, lacquer and most plastics"},
    FieldWords{"Material", "specular", "Specular", "Share of the mirrored light of a dielectric"},
    FieldWords{"Material", "brdf", "Measured BRDF", "Replaces all of the reflection"},
    FieldWords{"Material", "normal_scale", "Bumpiness", "Factor on the slopes of the normal map"},
    FieldWords{"Material", "alpha_cutoff", "Cutoff", "Masked surfaces are open where they are less opaque"},
};

const FieldWords* find(std::string_view component, std::string_view field) {
  const auto found = std::ranges::find_if(
      kWords, [&](const FieldWords& words) { return words.component == component && words.field == field; });
  return found == kWords.end() ? nullptr : &*found;
}

}  // namespace

std::string fieldLabel(std::string_view component, std::string_view field) {
  if (const FieldWords* words = find(component, field)) return std::string(words->label);
  std::string label(field.ends_with("_texture") ? field.substr(0, field.rfind('_')) : field);
  std::ranges::replace(label, '_', ' ');
  if (!label.empty()) label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
  return label;
}

std::string_view fieldHelp(std::string_view component, std::string_view field) {
  const FieldWords* words = find(component, field);
  return words ? words->help : std::string_view();
}

}  // namespace lambent::editor
