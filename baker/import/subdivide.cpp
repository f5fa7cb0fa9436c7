#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "baker/import/mesh_edits.hpp"

namespace lambent::baker {
namespace {

using bundle::MeshData;
using CornerVertices = std::array<std::uint32_t, 3>;

// Returns the same number from either end, because differences only change sign.
double squaredLength(const glm::vec3& a, const glm::vec3& b) {
  const glm::dvec3 d = glm::dvec3(a) - glm::dvec3(b);
  return glm::dot(d, d);
}

// An EdgePoint lies between two vertices.
struct EdgePoint {
  std::uint32_t a, b;
  float share;  // of the way from a to b
};

// shareOf(a, b) is 0 if the edge between two vertices is not to be split, else where (EdgePoint::share).
template <typename ShareOf>
class Splitter {
 public:
  Splitter(MeshData& mesh, ShareOf share_of) : mesh_(mesh), share_of_(std::move(share_of)) {}

  // Returns how many triangles one pass would leave; as many as now if no edge is marked.
  std::size_t countAfter() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < mesh_.indices.size(); i += 3) {
      const CornerVertices v = corners(i);
      count += 1u + isMarked(v[0], v[1]) + isMarked(v[1], v[2]) + isMarked(v[2], v[0]);
    }
    return count;
  }

  void pass(std::size_t triangles_after) {
    points_.clear();
    out_.clear();
    out_.reserve(triangles_after * 3);
    for (std::size_t i = 0; i < mesh_.indices.size(); i += 3) split(corners(i));
    mesh_.indices.swap(out_);
  }

 private:
  bool isMarked(std::uint32_t a, std::uint32_t b) const { return share_of_(a, b) > 0.0f; }

  CornerVertices corners(std::size_t i) const {
    return {mesh_.indices[i], mesh_.indices[i + 1], mesh_.indices[i + 2]};
  }

  void split(CornerVertices v) {
    const std::array<bool, 3> marked{isMarked(v[0], v[1]), isMarked(v[1], v[2]), isMarked(v[2], v[0])};
    const int count = marked[0] + marked[1] + marked[2];
    if (count == 0) return emit(v[0], v[1], v[2]);
    // The corners are rotated so that the odd edge has a fixed place: the only marked one first, the only
    // unmarked one last.
    std::size_t turn = 0;
    if (count == 1) turn = marked[0] ? 0 : marked[1] ? 1 : 2;
    if (count == 2) turn = !marked[2] ? 0 : !marked[0] ? 1 : 2;
    v = {v[turn], v[(turn + 1) % 3], v[(turn + 2) % 3]};

    const std::uint32_t m01 = between(v[0], v[1]);
    if (count == 1) {
      emit(v[0], m01, v[2]);
      return emit(m01, v[1], v[2]);
    }
    const std::uint32_t m12 = between(v[1], v[2]);
    emit(m01, v[1], m12);
    if (count == 2) return emitQuad(v[0], m01, m12, v[2]);
    const std::uint32_t m20 = between(v[2], v[0]);
    emit(v[0], m01, m20);
    emit(m20, m12, v[2]);
    emit(m01, m12, m20);
  }

  void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) { out_.insert(out_.end(), {a, b, c}); }

  // Splits along the shorter diagonal. Equal ones are decided by position, so that copies of a triangle split
  // alike.
  void emitQuad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    const auto key = [&](std::uint32_t p, std::uint32_t q) {
      const glm::vec3& from = mesh_.positions[p];
      const glm::vec3& to = mesh_.positions[q];
      const glm::vec3 middle = from + to;
      return std::tuple(squaredLength(from, to), middle.x, middle.y, middle.z);
    };
    if (key(a, c) <= key(b, d)) {
      emit(a, b, c);
      emit(a, c, d);
    } else {
      emit(a, b, d);
      emit(b, c, d);
    }
  }

  // Vertices that are doubled at a seam get the same point to the bit, since positions say which end is
  // first.
  EdgePoint pointOn(std::uint32_t a, std::uint32_t b) const {
    const auto key = [&](std::uint32_t v) {
      const glm::vec3& p = mesh_.positions[v];
      return std::tuple(p.x, p.y, p.z);
    };
    if (key(b) < key(a)) std::swap(a, b);
    return {a, b, share_of_(a, b)};
  }

  std::uint32_t between(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    const auto next = static_cast<std::uint32_t>(mesh_.positions.size());
    const auto [entry, added] = points_.try_emplace((std::uint64_t{low} << 32) | high, next);
    if (!added) return entry->second;
    const EdgePoint at = pointOn(low, high);
    appendMean<2>(mesh_, {at.a, at.b}, {1.0f - at.share, at.share});
    return next;
  }

  MeshData& mesh_;
  ShareOf share_of_;
  std::vector<std::uint32_t> out_;
  std::unordered_map<std::uint64_t, std::uint32_t> points_;
};

}  // namespace

bool splitLongEdges(bundle::MeshData& mesh, float max_edge, std::size_t max_triangles) {
  assert(max_edge > 0.0f);
  MeshData refined = mesh;
  const double limit = static_cast<double>(max_edge) * static_cast<double>(max_edge);
  Splitter splitter(refined, [&](std::uint32_t a, std::uint32_t b) {
    return squaredLength(refined.positions[a], refined.positions[b]) > limit ? 0.5f : 0.0f;
  });
  for (;;) {
    const std::size_t after = splitter.countAfter();
    if (after > max_triangles) return false;
    if (after == refined.indices.size() / 3) break;
    splitter.pass(after);
  }
  mesh = std::move(refined);
  return true;
}

void splitMarkedEdges(bundle::MeshData& mesh,
                      const std::function<float(std::uint32_t a, std::uint32_t b)>& share) {
  Splitter splitter(mesh, std::cref(share));
  splitter.pass(splitter.countAfter());
}

}  // namespace lambent::baker
