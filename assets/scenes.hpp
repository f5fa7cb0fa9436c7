// Makes the scenes that ship. They are in metres, and each has cameras called "main" and "detail". `gallery`,
// shown by scripts/demo, is a museum corner, open to the sky above and in front, with the Utah teapot on a
// column, a torus knot and spheres, about 90,000 vertices. `hello` is a floor, a box and a sphere, a few
// hundred vertices, for tests and first tries. `knot` is a torus knot alone, 19,000 vertices, for lights that
// come near it. In `playroom` a red ball rolls along a white wall, a lamp swings over a teapot, and a screen
// slides between the two, about 20,000 vertices. `field` is 200 bodies on a lawn, 20 of them moving. `metals`
// has a golden teapot, copper balls from polished to rough, brushed steel and glazed clay in front of a white
// wall. In `flight` a flyer with a polished ring for a wing circles over hills, under a cloud. `ring` is a
// polished ring of gold on a white plane of 256 x 256 vertices, on which it gathers light.
#pragma once

#include "assets/glb.hpp"

namespace lambent::assets {

Scene gallery();
Scene hello();
Scene knot();
Scene playroom();
Scene field();
Scene metals();
Scene flight();
Scene ring();

// Returns an sRGB image of seamless stone tiles, `tiles` x `tiles` in two tones with joints.
std::vector<std::uint8_t> stonePng(int tiles, int texels_per_tile);

}  // namespace lambent::assets
