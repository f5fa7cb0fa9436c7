// Makes a piece of hilly land to fly over: heights by fractal noise, a mesh, and an image of its colours
// (grass in the valleys, rock where it is steep, snow on the peaks).
#pragma once

#include <cstdint>
#include <vector>

#include "assets/mesh.hpp"

namespace lambent::assets {

struct Terrain {
  float side_m = 40.0f;   // of a square about the origin
  float height_m = 5.0f;  // approximate height of the highest peaks
  float bowl_m = 11.0f;   // radius of the valley in the middle
  std::uint32_t seed = 5;

  // Returns the height at (x, z), all in metres.
  float height(float x, float z) const;
};

// Makes a mesh of cells x cells cells, with texture coordinates 0..1 over the square.
Mesh terrainMesh(const Terrain& terrain, int cells);
// Returns an sRGB PNG of side x side texels.
std::vector<std::uint8_t> terrainPng(const Terrain& terrain, int side);

}  // namespace lambent::assets
