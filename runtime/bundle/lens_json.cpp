// Writes and reads cameras and punctual lights.
#include <algorithm>
#include <array>
#include <numbers>

#include "runtime/bundle/gltf_parts.hpp"

namespace lambent::bundle {
namespace {

constexpr std::array kLightTypes = {"directional", "point", "spot"};

float atLeastZero(const Field& field) {
  const float value = field.number();
  if (value < 0.0f) field.fault("is negative");
  return value;
}

}  // namespace

Json cameraJson(const gltf::Camera& camera) {
  Json json = Json::object();
  if (!camera.name.empty()) json["name"] = camera.name;
  json["type"] = camera.perspective ? "perspective" : "orthographic";
  Json& lens = json[camera.perspective ? "perspective" : "orthographic"];
  lens["znear"] = camera.znear;
  if (camera.zfar > 0.0f) lens["zfar"] = camera.zfar;
  if (camera.perspective) {
    lens["yfov"] = camera.yfov_rad;
    if (camera.aspect > 0.0f) lens["aspectRatio"] = camera.aspect;
  } else {
    lens["xmag"] = camera.xmag;
    lens["ymag"] = camera.ymag;
  }
  return json;
}

gltf::Camera readCamera(const Field& field) {
  gltf::Camera camera;
  if (field.has("name")) camera.name = field["name"].text();
  camera.perspective = field["type"].text() == "perspective";
  const Field lens = field[camera.perspective ? "perspective" : "orthographic"];
  camera.znear = lens["znear"].number();
  if (lens.has("zfar")) camera.zfar = lens["zfar"].number();
  if (camera.perspective) {
    camera.yfov_rad = lens["yfov"].number();
    if (lens.has("aspectRatio")) camera.aspect = lens["aspectRatio"].number();
  } else {
    camera.xmag = lens["xmag"].number();
    camera.ymag = lens["ymag"].number();
  }
  return camera;
}

Json lightJson(const gltf::Light& light) {
  Json json = Json::object();
  if (!light.name.empty()) json["name"] = light.name;
  json["type"] = kLightTypes[static_cast<std::size_t>(light.type)];
  json["color"] = vectorJson(light.color);
  json["intensity"] = light.intensity;
  if (light.range_m > 0.0f) json["range"] = light.range_m;
  if (light.type == gltf::Light::Type::Spot)
    json["spot"] = {{"innerConeAngle", light.inner_cone_rad}, {"outerConeAngle", light.outer_cone_rad}};
  return json;
}

gltf::Light readLight(const Field& field) {
  gltf::Light light;
  if (field.has("name")) light.name = field["name"].text();
  const std::string type = field["type"].text();
  const auto found = std::find(kLightTypes.begin(), kLightTypes.end(), type);
  if (found == kLightTypes.end()) field["type"].fault("is not directional, point or spot");
  light.type = static_cast<gltf::Light::Type>(found - kLightTypes.begin());
  light.color = field["color"].vector<glm::vec3>();
  if (light.color.x < 0.0f || light.color.y < 0.0f || light.color.z < 0.0f)
    field["color"].fault("is negative");
  light.intensity = atLeastZero(field["intensity"]);
  if (field.has("range")) light.range_m = atLeastZero(field["range"]);
  if (light.type == gltf::Light::Type::Spot) {
    light.inner_cone_rad = atLeastZero(field["spot"]["innerConeAngle"]);
    light.outer_cone_rad = atLeastZero(field["spot"]["outerConeAngle"]);
    if (light.inner_cone_rad >= light.outer_cone_rad || light.outer_cone_rad > std::numbers::pi_v<float> / 2)
      field["spot"].fault("is not a cone inside a cone of at most 90 degrees");
  }
  return light;
}

}  // namespace lambent::bundle
