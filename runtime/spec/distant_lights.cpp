#include "runtime/spec/distant_lights.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::spec {

namespace {

using sh::ImageLayout;

struct Texel {
  int x, y;
};

// Filtering next to a seam needs texels beyond it. For each layout a function returns the texel of the
// picture that lies there.

// Lat-long pictures wrap around horizontally. Across a pole the next texel is half a turn away in the same
// row.
Texel besideLatLong(Texel texel, int width, int height) {
  if (texel.y < 0 || texel.y >= height) {
    texel.y = texel.y < 0 ? -1 - texel.y : 2 * height - 1 - texel.y;
    texel.x += width / 2;
  }
  texel.x = (texel.x % width + width) % width;
  return {texel.x, std::clamp(texel.y, 0, height - 1)};
}

bool showsDirection(ImageLayout layout, Texel texel, int width, int height) {
  if (texel.x < 0 || texel.y < 0 || texel.x >= width || texel.y >= height) return false;
  return sh::texelDirection(layout, width, height, texel.x, texel.y) != glm::dvec3(0.0);
}

// The whole rim is the direction +Z, so the texel is moved inwards along its radius.
Texel besideAngularMap(Texel texel, int width, int height) {
  const glm::dvec2 centre = 0.5 * glm::dvec2(width, height);
  const glm::dvec2 outward = glm::normalize(glm::dvec2(texel.x, texel.y) + 0.5 - centre);
  glm::dvec2 at = glm::dvec2(texel.x, texel.y) + 0.5;
  while (!showsDirection(ImageLayout::AngularMap, texel, width, height) &&
         glm::dot(at - centre, outward) > 0.0) {
    at -= 0.5 * outward;
    texel = {static_cast<int>(std::floor(at.x)), static_cast<int>(std::floor(at.y))};
  }
  return texel;
}

// Returns column and row of the square at a position. A direction exactly on an edge may lie beyond the right
// or lower border of its square, where the picture may be blank.
Texel faceOfCross(glm::dvec2 at, int width, int height) {
  const int side = width / 3;
  for (const glm::dvec2 nudge :
       {glm::dvec2(0.0, 0.0), glm::dvec2(0.5, 0.0), glm::dvec2(0.0, 0.5), glm::dvec2(0.5)}) {
    const glm::dvec2 texel = glm::floor(at - nudge);
    if (showsDirection(ImageLayout::VerticalCross, {static_cast<int>(texel.x), static_cast<int>(texel.y)},
                       width, height))
      return {static_cast<int>(texel.x) / side, static_cast<int>(texel.y) / side};
  }
  assert(false && "imageCoordinates points into a blank square");
  return {1, 1};
}

// Returns the centre of a texel on the cube instead of the unit sphere. There texels of a face are equally
// spaced, even beyond its edges.
glm::dvec3 onCube(Texel texel, int width, int height) {
  const glm::dvec3 dir = sh::texelDirection(ImageLayout::VerticalCross, width, height, texel.x, texel.y);
  const glm::dvec3 size = glm::abs(dir);
  return dir / std::max({size.x, size.y, size.z});
}

// The plane of the face is continued beyond its edge and projected onto the adjacent face.
Texel besideCross(Texel texel, Texel face, int width, int height) {
  const int side = width / 3;
  const Texel edge{std::clamp(texel.x, face.x * side, face.x * side + side - 1),
                   std::clamp(texel.y, face.y * side, face.y * side + side - 1)};
  if ((edge.x == texel.x && edge.y == texel.y) || side < 2) return edge;
  const glm::dvec3 at = onCube(edge, width, height);
  const int inward_x = edge.x == face.x * side ? 1 : -1, inward_y = edge.y == face.y * side ? 1 : -1;
  const glm::dvec3 step_x = (onCube({edge.x + inward_x, edge.y}, width, height) - at) * double(inward_x);
  const glm::dvec3 step_y = (onCube({edge.x, edge.y + inward_y}, width, height) - at) * double(inward_y);
  const glm::dvec3 dir = at + double(texel.x - edge.x) * step_x + double(texel.y - edge.y) * step_y;
  const glm::dvec2 there = sh::imageCoordinates(ImageLayout::VerticalCross, width, height, dir);
  const Texel found{static_cast<int>(std::floor(there.x)), static_cast<int>(std::floor(there.y))};
  return showsDirection(ImageLayout::VerticalCross, found, width, height) ? found : edge;
}

}  // namespace

Result<EnvironmentMap> loadEnvironmentMap(const EnvironmentMapLight& light) {
  Result<RgbImage> image = readLightImage(light.file);
  if (!image) return failAgain(std::move(image.error()));
  const int width = static_cast<int>(image->width), height = static_cast<int>(image->height);
  const std::optional<ImageLayout> of_shape = sh::layoutOfShape(width, height),
                                   layout = light.layout ? light.layout : of_shape;
  const std::string shape = std::to_string(width) + " x " + std::to_string(height);
  if (!layout)
    return fail(
        light.file.string(),
        "its shape (" + shape + ") is neither lat-long (2:1), angular map (1:1) nor vertical cross (3:4)",
        "say what it is with --light-layout lat-long, or crop it to its layout");
  if (layout != ImageLayout::LatLong && layout != of_shape)
    return fail(light.file.string(),
                "its shape (" + shape + ") cannot be read as " + std::string(sh::name(*layout)),
                "choose another --light-layout, or leave it out");
  return EnvironmentMap{std::move(*image), *layout};
}

glm::vec3 radiance(const EnvironmentMap& environment_map, glm::vec3 dir) {
  const int width = static_cast<int>(environment_map.image.width),
            height = static_cast<int>(environment_map.image.height);
  const glm::dvec2 at = sh::imageCoordinates(environment_map.layout, width, height, glm::dvec3(dir));
  const double left = std::floor(at.x - 0.5), top = std::floor(at.y - 0.5);
  const Texel face =
      environment_map.layout == ImageLayout::VerticalCross ? faceOfCross(at, width, height) : Texel{0, 0};
  glm::dvec3 sum(0.0);
  for (int corner = 0; corner < 4; ++corner) {
    const int right = corner & 1, below = corner >> 1;
    Texel texel{static_cast<int>(left) + right, static_cast<int>(top) + below};
    if (environment_map.layout == ImageLayout::LatLong) texel = besideLatLong(texel, width, height);
    if (environment_map.layout == ImageLayout::AngularMap) texel = besideAngularMap(texel, width, height);
    if (environment_map.layout == ImageLayout::VerticalCross) texel = besideCross(texel, face, width, height);
    const double weight_x = right ? at.x - 0.5 - left : left + 1.5 - at.x;
    const double weight_y = below ? at.y - 0.5 - top : top + 1.5 - at.y;
    const std::size_t index =
        static_cast<std::size_t>(texel.y) * environment_map.image.width + static_cast<std::size_t>(texel.x);
    sum += weight_x * weight_y * glm::dvec3(environment_map.image.texels[index]);
  }
  return glm::vec3(sum);
}

Result<DistantLights> loadDistantLights(
    const std::vector<Light>& lights,
    const std::function<Result<EnvironmentMap>(const EnvironmentMapLight&)>& load) {
  DistantLights out;
  for (const Light& light : lights) {
    if (const auto* constant = std::get_if<ConstantLight>(&light)) {
      out.constant += constant->radiance;
    } else if (const auto* sun = std::get_if<SunLight>(&light)) {
      out.discs.push_back({.direction = directionFromAzimuthElevation(sun->azimuth_deg, sun->elevation_deg),
                           .radius_rad = glm::radians(sun->angle_deg),
                           .radiance = sun->radiance});
    } else if (const auto* file = std::get_if<EnvironmentMapLight>(&light)) {
      Result<EnvironmentMap> environment_map = load(*file);
      if (!environment_map) return failAgain(environment_map.error());
      for (const std::string& notice : environment_map->image.notices)
        out.notices.push_back(file->file.string() + ": " + notice);
      out.environment_maps.push_back(std::move(*environment_map));
    }
  }
  return out;
}

sh::LightVector DistantLights::lightVector() const {
  sh::LightVector light = sh::constantLight(sh::kMaxOrder, constant);
  for (const EnvironmentMap& environment_map : environment_maps)
    light +=
        sh::projectImage(sh::kMaxOrder, environment_map.layout, static_cast<int>(environment_map.image.width),
                         static_cast<int>(environment_map.image.height), environment_map.image.texels);
  return light + discVector(discs);
}

sh::LightVector discVector(std::span<const Disc> discs) {
  sh::LightVector light{.order = sh::kMaxOrder};
  for (const Disc& disc : discs)
    light +=
        sh::discLight(sh::kMaxOrder, disc.direction, static_cast<double>(disc.radius_rad), disc.radiance);
  return light;
}

sh::LightVector turned(const sh::LightVector& light, float degrees) {
  const Result<glm::dmat3> rotation = sh::orthonormalised(glm::dmat3(lightRotation(degrees)));
  return rotation ? sh::Rotation(*rotation, light.order).apply(light) : light;
}

}  // namespace lambent::spec
