// Triangulates points of a plane so that no circle around a triangle holds another point (Delaunay), but for
// edges that must be there (constrained; Sloan 1993). Points lie on a lattice of integers, on which all
// decisions are exact.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

class Triangulation {
 public:
  // Coordinates of points lie strictly between -kMost and kMost.
  static constexpr std::int32_t kMost = 1 << 26;

  Triangulation();

  // Returns the number of the point, counted from 0, which is that of an earlier one in the same place. All
  // points come before all edges.
  std::uint32_t add(const glm::ivec2& point);
  // Makes the straight way between two points an edge, or several where points lie on it. Edges of an outline
  // divide inside from outside. Stops where it crosses an earlier one, and returns false then.
  bool constrain(std::uint32_t from, std::uint32_t to, bool outline);
  const glm::ivec2& at(std::uint32_t point) const { return points_[point + kCorners]; }
  // Returns the triangles that an odd number of edges of outlines divides from what is far away,
  // counter-clockwise; none if an outline is open.
  std::vector<glm::uvec3> inside() const;

 private:
  enum class Edge : std::uint8_t { Free, Kept, Outline };
  struct Triangle {  // counter-clockwise
    std::array<std::uint32_t, 3> points;
    std::array<std::uint32_t, 3> across;  // the triangle beyond the edge that faces a point, or kNone
    std::array<Edge, 3> edges = {};
  };
  struct Side {  // the edge of a triangle that faces its point `k`
    std::uint32_t triangle;
    std::size_t k;
  };

  static constexpr std::uint32_t kNone = 0xffffffffu, kCorners = 4;

  // Is above 0 if c lies to the left of the way from a to b.
  std::int64_t turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  bool inCircle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const;
  Side otherSide(const Side& side) const;
  void link(const Side& side, std::uint32_t across, Edge edge);
  // Turns the edge between two triangles into the other diagonal, which leaves the new edge facing point 0 of
  // the first and of the second.
  void flip(const Side& side);
  void makeDelaunay(std::vector<Side> sides);
  std::uint32_t triangleAt(std::uint32_t point) const;
  // Returns the side between two points; the triangle is kNone if there is none.
  Side between(std::uint32_t a, std::uint32_t b) const;

  std::vector<glm::ivec2> points_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> of_point_;  // a triangle at each point
  std::uint32_t last_ = 0;
};

}  // namespace lambent::baker
