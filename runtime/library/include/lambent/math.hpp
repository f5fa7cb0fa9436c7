// Plain values, without a library of vectors: copy them to and from those that a program uses. Axes are
// glTF's, right-handed with +Y up; lengths are metres, angles degrees where a name says so.
#pragma once

#include <array>

namespace lambent {

struct Vec3 {
  float x = 0.0f, y = 0.0f, z = 0.0f;
};

// Describes a box with sides parallel to the axes.
struct Box {
  Vec3 min{}, max{};
};

// Holds a matrix column by column, as OpenGL does: entry [4 c + r] stands in row r of column c, and entries
// 12 to 14 are a translation.
using Matrix4 = std::array<float, 16>;

inline constexpr Matrix4 kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

}  // namespace lambent
