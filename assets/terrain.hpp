// A piece of hilly land, for things to fly over: heights by fractal noise, a mesh, and its colours as a
// picture (grass in the valleys, rock where it is steep, snow on the peaks).
#pragma once

#include <cstdint>
#include <vector>

#include "assets/mesh.hpp"

namespace lambent::assets {

struct Terrain {
  float side_m = 40.0f;   // a square about the origin
  float height_m = 5.0f;  // of the highest peaks, about
  float bowl_m = 11.0f;   // radius of the valley in the middle
  std::uint32_t seed = 5;

  // At a place in metres.
  float height(float x, float z) const;
};

// cells x cells; texture coordinates 0..1 over the square.
Mesh terrainMesh(const Terrain& terrain, int cells);
// sRGB PNG of side x side texels.
std::vector<std::uint8_t> terrainPng(const Terrain& terrain, int side);

}  // namespace lambent::assets
