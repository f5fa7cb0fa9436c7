// Mends punctual lights and cameras.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "baker/import/mend.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::baker {
namespace {

using nlohmann::json;

// Returns a number, or `fallback` if there is none.
double numberOf(const Entry& entry, const char* key, double fallback) {
  const json* value = entry.find(key);
  return value != nullptr && value->is_number() ? value->get<double>() : fallback;
}

void mendCones(const Entry& light) {
  if (!light.object("spot")) {
    light.warn("it has no spot, so its cone is that of the default");
    light.json["spot"] = json::object();
  }
  // What has no width gives no light.
  constexpr double kThinnest_rad = 1e-3, kRightAngle_rad = std::numbers::pi / 2;
  const Entry spot = *light.object("spot");
  spot.clamp("outerConeAngle", kThinnest_rad, kRightAngle_rad);
  // Exporters write equal cones for a hard edge.
  const double outer = numberOf(spot, "outerConeAngle", std::numbers::pi / 4);
  spot.clamp("innerConeAngle", 0.0, outer);
}

void mendLight(const Entry& light) {
  light.clamp("intensity", 0.0, double{spec::kMostRadiance});
  light.clampAll("color", 3, 0.0, double{spec::kMostRadiance});
  double largest = 1.0;
  if (const json* color = light.find("color"))
    for (const json& value : *color) largest = std::max(largest, value.get<double>());
  light.clamp("intensity", 0.0, double{spec::kMostRadiance} / largest);
  if (const double range = numberOf(light, "range", 1.0); !(range > 0.0))
    light.leaveOut("range", fmt::format("is {:g}, which counts as no limit,", range));
  light.clamp("range", 0.0, kAnyNumber);
  if (light.json["type"] == "spot") mendCones(light);
}

void mendCamera(const Entry& camera) {
  if (const json* type = camera.find("type");
      type == nullptr || (*type != "perspective" && *type != "orthographic")) {
    const char* kind = camera.find("orthographic") ? "orthographic" : "perspective";
    camera.warn(fmt::format("its type is not known, so it counts as {}", kind));
    camera.json["type"] = kind;
  }
  const bool perspective = camera.json["type"] == "perspective";
  const char* kind = perspective ? "perspective" : "orthographic";
  if (!camera.object(kind)) camera.json[kind] = json::object();
  const Entry lens = *camera.object(kind);
  // Sets a number that is not what a lens can have.
  const auto replace = [&](const char* key, double now, auto good) {
    const json* value = lens.find(key);
    if (value != nullptr && value->is_number() && std::isfinite(value->get<float>()) &&
        good(value->get<float>()))
      return;
    lens.warn(fmt::format("{} is {}, which counts as {:g}", key, value ? value->dump() : "missing", now));
    lens.json[key] = now;
  };
  const auto drop = [&](const char* key, auto good) {
    const json* value = lens.find(key);
    if (value != nullptr && !(value->is_number() && good(value->get<double>())))
      lens.leaveOut(key, fmt::format("is {}", value->dump()));
  };
  if (perspective) {
    replace("yfov", 0.8, [](float v) { return v > 0.0f && v < std::numbers::pi_v<float>; });
    replace("znear", 0.01, [](float v) { return v > 0.0f; });
    drop("aspectRatio", [](double v) { return v > 0.0 && v < kAnyNumber; });
  } else {
    replace("xmag", 1.0, [](float v) { return v != 0.0f; });
    replace("ymag", 1.0, [](float v) { return v != 0.0f; });
    replace("znear", 0.0, [](float v) { return v >= 0.0f; });
  }
  const double near = numberOf(lens, "znear", 0.0);
  drop("zfar", [&](double v) { return float(v) > float(near) && v < kAnyNumber; });
  // tinygltf refuses orthographic cameras without it; 0 stands for no end.
  if (!perspective && lens.find("zfar") == nullptr) lens.json["zfar"] = 0;
}

}  // namespace

void mendLights(const Entry& root) {
  const auto extension = root.extension("KHR_lights_punctual");
  if (!extension) return;
  std::set<std::size_t> unknown;
  std::size_t number = 0;
  forEachEntry(*extension, "lights", "light", [&](const Entry& light) {
    const json* type = light.find("type");
    const bool known = type != nullptr && (*type == "directional" || *type == "point" || *type == "spot");
    if (!known) {
      light.warn(fmt::format("its type {} is not known, so it does not shine",
                             type ? type->dump() : "is missing and"));
      unknown.insert(number);
      light.json["type"] = "point";
    }
    mendLight(light);
    ++number;
  });
  forEachEntry(root, "nodes", "node", [&](const Entry& node) {
    const auto use = node.extension("KHR_lights_punctual");
    const json* light = use ? use->find("light") : nullptr;
    if (use &&
        (light == nullptr || (light->is_number_unsigned() && unknown.contains(light->get<std::size_t>()))))
      node.json["extensions"].erase("KHR_lights_punctual");
  });
}

void mendCameras(const Entry& root) {
  forEachEntry(root, "cameras", "camera", mendCamera);
}

}  // namespace lambent::baker
