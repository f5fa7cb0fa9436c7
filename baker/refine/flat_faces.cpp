#include "baker/refine/flat_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "baker/import/mesh_edits.hpp"
#include "baker/refine/face_grid.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

namespace {

// Vertices are so far apart inside a face, and along its rim and cuts, in extents of what eyes see. Beyond
// that extent both grow with the distance.
constexpr float kInside = 1.0f / 24.0f, kAlong = 1.0f / 96.0f;
// Surfaces cut a face that come so near to it, in extents.
constexpr float kContact = 1.0f / 4096.0f;
// Faces are filled that are larger than so many squares of the grid and take up so much of all pictures.
constexpr double kLeastSquares = 1.5, kLeastOfPictures = 1.5e-3;
constexpr double kLeastSeed = 1e-4;  // squares of the grid in the largest triangle of a face
constexpr float kSameWay = 0.999f;   // cosine between normals, and tangents, of one face
constexpr double kEven = 2e-3;       // of attributes that change evenly across a face
constexpr std::uint32_t kNew = 0xffffffffu;
constexpr std::size_t kMostOnEdge = 1024;  // parts of an edge of a rim

using Edge = std::uint64_t;  // pairOf() places
using TrianglesAtEdges = std::unordered_map<Edge, std::vector<std::uint32_t>>;

// Triangles of one draw in one plane that hang together, and across which what vertices hold changes evenly.
struct FlatFace {
  std::vector<std::uint32_t> triangles;  // into GroupGeometry::triangles
  glm::uvec3 basis{0};                   // three vertices far from each other, of which others are means
  glm::dvec3 origin{0.0}, x{0.0}, y{0.0}, normal{0.0};
  double area = 0.0;       // m^2
  double excess = 0.0;     // sum of SeenTriangle::excess
  bool filled = false;     // with a grid; else only the points on its edges are added
  std::vector<Line> cuts = {};  // where other surfaces meet a filled one

  glm::dvec2 flat(const glm::dvec3& p) const { return {glm::dot(p - origin, x), glm::dot(p - origin, y)}; }
  glm::dvec3 inSpace(const glm::dvec2& p) const { return origin + p.x * x + p.y * y; }
};

// A vertex of a filled face: one that is there, or a mean of three.
struct FaceVertex {
  glm::uvec3 of{0};
  glm::vec3 weights{0.0f};
  std::uint32_t old = kNew;
};

using MeshTriangle = std::array<std::uint32_t, 3>;

struct Change {  // of a mesh
  std::set<MeshTriangle> gone;
  std::vector<std::uint32_t> added;  // indices
};

class FaceFiller {
 public:
  FaceFiller(const RigidGroup& group, const GroupGeometry& geometry, const CopiesOfMeshes& copies,
             const Importance& importance, std::span<const SeenTriangle> seen, std::size_t room,
             std::vector<std::vector<bundle::MeshData>>& meshes)
      : group_(group),
        geometry_(geometry),
        importance_(importance),
        seen_(seen),
        room_(room),
        meshes_(meshes),
        draw_of_(geometry.triangles.size()),
        place_(placesIn(geometry)) {
    const double extent = importance.extent();
    inside_ = double{kInside} * extent, along_ = double{kAlong} * extent,
    beside_ = double{kBeforeCut} * extent, contact_ = double{kContact} * extent;
    for (std::uint32_t d = 0; d < geometry.draws.size(); ++d) {
      const PlannedDraw& draw = group.draws[d];
      const DrawGeometry& shape = geometry.draws[d];
      free_.push_back(!draw.back && copies[draw.mesh][draw.primitive] == 1 && shape.texels == 0);
      std::fill_n(draw_of_.begin() + shape.first_triangle, shape.triangle_count, d);
    }
  }

  void run() {
    findFaces();
    chooseFaces();
    if (faces_.empty()) return;
    addNeighbours();
    for (const FlatFace& face : faces_)
      if (!face.filled || !fill(face))
        for (const std::uint32_t t : face.triangles) fill(ofOne(t));
    writeMeshes();
  }

 private:
  glm::dvec3 at(std::uint32_t vertex) const { return glm::dvec3(geometry_.positions[vertex]); }
  Edge edgeOf(std::uint32_t a, std::uint32_t b) const { return pairOf(place_[a], place_[b]); }
  template <typename Visit>  // visit(a, b) gets the vertices at the ends of each edge
  void forEdges(std::uint32_t t, const Visit& visit) const {
    const glm::uvec3& corners = geometry_.triangles[t];
    for (int k = 0; k < 3; ++k) visit(corners[k], corners[(k + 1) % 3]);
  }
  bundle::MeshData& meshOf(std::uint32_t draw) const {
    return meshes_[group_.draws[draw].mesh][group_.draws[draw].primitive];
  }
  // Returns by how much vertices are farther apart at a point beyond what eyes see.
  double scaleAt(const glm::dvec3& p) const {
    return std::max(1.0, glm::distance(p, glm::dvec3(importance_.middle())) / double{importance_.extent()});
  }
  // Returns the share of all pictures that a square metre of a face takes up at a point of it.
  double seenAt(const FlatFace& face, const glm::dvec2& p) const {
    const glm::vec3 on(face.inSpace(p)), normal(face.normal);
    return double{importance_.at({on + standOff(on, static_cast<float>(inside_)) * normal, normal}).seen};
  }

  FlatFace ofOne(std::uint32_t t) const {
    const glm::uvec3 corners = geometry_.triangles[t];
    FlatFace face{.triangles = {t}, .basis = corners, .origin = at(corners.x)};
    const glm::dvec3 along = at(corners.y) - face.origin;
    face.normal = glm::normalize(glm::cross(along, at(corners.z) - face.origin));
    face.x = glm::normalize(along);
    face.y = glm::cross(face.normal, face.x);
    face.area = triangleArea(geometry_, corners);
    return face;
  }

  // Returns the weights of the basis that make a point of the plane.
  glm::dvec3 weightsAt(const FlatFace& face, const glm::dvec2& p) const {
    const glm::dvec2 a = face.flat(at(face.basis.x)), b = face.flat(at(face.basis.y)),
                     c = face.flat(at(face.basis.z));
    const double area = cross(b - a, c - a);
    const double v = cross(p - a, c - a) / area, w = cross(b - a, p - a) / area;
    return {1.0 - v - w, v, w};
  }

  // Returns whether what a triangle's vertices hold is what the basis has there.
  bool isEven(const FlatFace& face, std::uint32_t t) const {
    const std::uint32_t draw = draw_of_[t], first = geometry_.draws[draw].first_vertex;
    const bundle::MeshData& mesh = meshOf(draw);
    const glm::uvec3 of = face.basis - first;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t vertex = geometry_.triangles[t][k], v = vertex - first;
      const glm::dvec3 weights = weightsAt(face, face.flat(at(vertex)));
      if (!mesh.normal_weights.empty() && mesh.normal_weights[v] < kSameWay) return false;
      if (glm::dot(mesh.normals[v], mesh.normals[of.x]) < kSameWay) return false;
      if (!mesh.tangents.empty() &&
          (glm::dot(glm::vec3(mesh.tangents[v]), glm::vec3(mesh.tangents[of.x])) < kSameWay ||
           mesh.tangents[v].w != mesh.tangents[of.x].w))
        return false;
      const auto even = [&]<typename V>(const std::vector<V>& values) {
        if (values.empty()) return true;
        using Wide = glm::vec<V::length(), double>;
        const Wide mean =
            weights.x * Wide(values[of.x]) + weights.y * Wide(values[of.y]) + weights.z * Wide(values[of.z]);
        return glm::distance(mean, Wide(values[v])) <= kEven * std::max(1.0, glm::length(mean));
      };
      if (!even(mesh.texcoords0) || !even(mesh.texcoords1) || !even(mesh.colors)) return false;
    }
    return true;
  }

  // Grows faces from the largest triangles, and keeps those that are worth a grid.
  void findFaces() {
    TrianglesAtEdges at_edge;
    std::vector<std::pair<double, std::uint32_t>> seeds;  // by area, the largest first
    for (std::uint32_t t = 0; t < geometry_.triangles.size(); ++t) {
      if (!free_[draw_of_[t]]) continue;
      forEdges(t, [&](std::uint32_t a, std::uint32_t b) { at_edge[edgeOf(a, b)].push_back(t); });
      if (const double area = triangleArea(geometry_, geometry_.triangles[t]);
          area > kLeastSeed * inside_ * inside_)
        seeds.emplace_back(-area, t);
    }
    std::ranges::sort(seeds);
    std::vector<bool> taken(geometry_.triangles.size(), false);
    for (const auto& [less_area, seed] : seeds) {
      if (taken[seed]) continue;
      FlatFace face = grown(seed, /*evenly=*/false, at_edge, taken);
      // Pictures on a wall may not continue each other. The face then is that of one picture.
      if (!std::ranges::all_of(face.triangles, [&](std::uint32_t t) { return isEven(face, t); }))
        face = grown(seed, /*evenly=*/true, at_edge, taken);
      face.area = 0.0;
      double share = 0.0;
      for (const std::uint32_t t : face.triangles) {
        taken[t] = true;
        face.area += triangleArea(geometry_, geometry_.triangles[t]);
        face.excess += seen_[t].excess, share += seen_[t].share;
      }
      if (face.area > kLeastSquares * inside_ * inside_ && share > kLeastOfPictures && face.excess > 0.0)
        faces_.push_back(std::move(face));
    }
  }

  FlatFace grown(std::uint32_t seed, bool evenly, const TrianglesAtEdges& at_edge,
                 const std::vector<bool>& taken) const {
    FlatFace face = ofOne(seed);
    std::unordered_set<std::uint32_t> in = {seed};
    for (std::size_t i = 0; i < face.triangles.size(); ++i)
      forEdges(face.triangles[i], [&](std::uint32_t a, std::uint32_t b) {
        for (const std::uint32_t t : at_edge.at(edgeOf(a, b)))
          if (!taken[t] && draw_of_[t] == draw_of_[seed] && liesIn(face, t) && (!evenly || isEven(face, t)) &&
              in.insert(t).second)
            face.triangles.push_back(t);
      });
    const glm::dvec2 a = face.flat(at(face.basis.x));
    const std::uint32_t b = farthest(face, [&](const glm::dvec2& p) { return glm::distance(a, p); });
    const glm::dvec2 way = face.flat(at(b)) - a;
    const std::uint32_t c = farthest(face, [&](const glm::dvec2& p) { return std::abs(cross(way, p - a)); });
    face.basis = {face.basis.x, b, c};
    return face;
  }

  bool liesIn(const FlatFace& face, std::uint32_t t) const {
    const glm::uvec3& corners = geometry_.triangles[t];
    if (!(glm::dot(glm::dvec3(areaNormal(geometry_, corners)), face.normal) > 0.0)) return false;
    for (int k = 0; k < 3; ++k)
      if (std::abs(glm::dot(at(corners[k]) - face.origin, face.normal)) > 0.5 * beside_) return false;
    return true;
  }

  // Returns the vertex of a face of which `measure` is greatest.
  template <typename Measure>
  std::uint32_t farthest(const FlatFace& face, const Measure& measure) const {
    std::uint32_t best = face.basis.x;
    double most = -1.0;
    for (const std::uint32_t t : face.triangles)
      for (int k = 0; k < 3; ++k)
        if (const double far = measure(face.flat(at(geometry_.triangles[t][k]))); far > most)
          most = far, best = geometry_.triangles[t][k];
    return best;
  }

  // Returns the edges that belong to one triangle of the face, in its direction. Empty if one belongs to more
  // than two.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rimOf(const FlatFace& face) const {
    std::unordered_map<Edge, int> count;
    int most = 0;
    for (const std::uint32_t t : face.triangles)
      forEdges(t, [&](std::uint32_t a, std::uint32_t b) { most = std::max(most, ++count[edgeOf(a, b)]); });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> rim;
    for (const std::uint32_t t : face.triangles)
      forEdges(t, [&](std::uint32_t a, std::uint32_t b) {
        if (most <= 2 && count[edgeOf(a, b)] == 1) rim.emplace_back(a, b);
      });
    return rim;
  }

  // Divides the edges of rims, unless a mesh shares them which has to stay as it is, and drops faces for
  // which there is no room: those that are most wrong come first.
  void chooseFaces() {
    std::unordered_set<Edge> fixed;
    for (std::uint32_t t = 0; t < geometry_.triangles.size(); ++t)
      if (!free_[draw_of_[t]] && !group_.draws[draw_of_[t]].back)
        forEdges(t, [&](std::uint32_t a, std::uint32_t b) { fixed.insert(edgeOf(a, b)); });
    std::ranges::stable_sort(faces_, std::ranges::greater(), &FlatFace::excess);
    std::vector<FlatFace> chosen;
    for (FlatFace& face : faces_) {
      std::vector<Edge> divided;
      for (const auto& [a, b] : rimOf(face)) {
        const glm::dvec3 from = at(a), to = at(b);
        const double apart = (isSeen(face, from, to) ? along_ : inside_) * scaleAt(0.5 * (from + to));
        const auto parts = static_cast<std::size_t>(std::ceil(glm::distance(from, to) / apart));
        if (parts > 1 && !fixed.contains(edgeOf(a, b)) &&
            parts_.try_emplace(edgeOf(a, b), std::min(parts, kMostOnEdge)).second)
          divided.push_back(edgeOf(a, b));
      }
      face.filled = true;
      face.cuts = cutsOf(face);
      std::vector<FaceVertex> vertices;
      const std::vector<glm::uvec3> triangles = triangulated(face, vertices);
      const auto added = static_cast<std::size_t>(std::ranges::count(vertices, kNew, &FaceVertex::old));
      if (!triangles.empty() && added <= room_) {
        room_ -= added;
        chosen.push_back(std::move(face));
      } else {
        for (const Edge edge : divided) parts_.erase(edge);
      }
    }
    faces_ = std::move(chosen);
  }

  // Returns whether eyes see anything of a face along an edge of its rim.
  bool isSeen(const FlatFace& face, const glm::dvec3& a, const glm::dvec3& b) const {
    constexpr int kPlaces = 8;
    const glm::dvec2 from = face.flat(a), way = face.flat(b) - from;
    const double length = glm::length(way);
    if (!(length > 0.0)) return false;
    const glm::dvec2 inwards = glm::dvec2(-way.y, way.x) * (std::min(4.0 * beside_, 0.1 * length) / length);
    for (int i = 0; i < kPlaces; ++i)
      if (seenAt(face, from + way * ((i + 0.5) / kPlaces) + inwards) > 0.0) return true;
    return false;
  }

  // Adds the triangles of no face that have a divided edge.
  void addNeighbours() {
    std::vector<bool> in_face(geometry_.triangles.size(), false);
    for (const FlatFace& face : faces_)
      for (const std::uint32_t t : face.triangles) in_face[t] = true;
    for (std::uint32_t t = 0; t < geometry_.triangles.size(); ++t) {
      bool divided = false;
      forEdges(t, [&](std::uint32_t a, std::uint32_t b) { divided |= parts_.contains(edgeOf(a, b)); });
      if (divided && !in_face[t] && free_[draw_of_[t]]) faces_.push_back(ofOne(t));
    }
  }

  // Finds where other surfaces meet the plane of a face. Those that lie in it do not cut it.
  std::vector<Line> cutsOf(const FlatFace& face) const {
    std::vector<bool> own(geometry_.triangles.size(), false);
    for (const std::uint32_t t : face.triangles) own[t] = true;
    std::vector<Line> cuts;
    for (std::uint32_t t = 0; t < geometry_.triangles.size(); ++t) {
      if (own[t] || group_.draws[draw_of_[t]].back) continue;
      glm::dmat3 corners;  // by columns
      glm::dvec3 height;
      for (int k = 0; k < 3; ++k) {
        corners[k] = at(geometry_.triangles[t][k]);
        height[k] = glm::dot(corners[k] - face.origin, face.normal);
      }
      const auto [least, most] = std::minmax({height.x, height.y, height.z});
      if (least > contact_ || most < -contact_ || std::max(most, -least) <= 3.0 * contact_) continue;
      std::vector<glm::dvec2> ends;
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        if (std::abs(height[k]) <= contact_) ends.push_back(face.flat(corners[k]));
        if (std::min(height[k], height[next]) < -contact_ && std::max(height[k], height[next]) > contact_)
          ends.push_back(
              face.flat(glm::mix(corners[k], corners[next], height[k] / (height[k] - height[next]))));
      }
      if (ends.size() >= 2) cuts.push_back({ends[0], ends[1]});
    }
    return cuts;
  }

  // Returns the triangles that take the place of a face's, and their vertices. Nothing if its rim crosses
  // itself, or more than two of its triangles share an edge.
  std::vector<glm::uvec3> triangulated(const FlatFace& face, std::vector<FaceVertex>& vertices) const {
    const std::uint32_t first = geometry_.draws[draw_of_[face.triangles.front()]].first_vertex;
    Outline outline;
    std::unordered_map<std::uint32_t, std::uint32_t> corner_at;  // by place
    const auto add = [&](const glm::dvec3& p, const FaceVertex& vertex) {
      outline.points.push_back(face.flat(p));
      vertices.push_back(vertex);
      return static_cast<std::uint32_t>(vertices.size() - 1);
    };
    const auto corner = [&](std::uint32_t v) {
      const auto [found, is_new] = corner_at.try_emplace(place_[v], 0);
      if (is_new) found->second = add(at(v), {.old = v - first});
      return found->second;
    };
    for (auto [a, b] : rimOf(face)) {
      const auto divided = parts_.find(edgeOf(a, b));
      const std::size_t parts = divided == parts_.end() ? 1 : divided->second;
      // Both faces at the edge put its vertices in the same places.
      if (place_[a] > place_[b]) std::swap(a, b);
      std::uint32_t last = corner(a);
      for (std::size_t i = 1; i <= parts; ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(parts);
        const std::uint32_t next =
            i == parts ? corner(b)
                       : add(glm::mix(at(a), at(b), t),
                             {.of = glm::uvec3(a, b, b) - first, .weights = {1.0 - t, t, 0.0}});
        outline.edges.emplace_back(last, next);
        last = next;
      }
    }
    const GridRules rules{.inside = inside_,
                          .along = along_,
                          .beside = beside_,
                          .scale = [&](const glm::dvec2& p) { return scaleAt(face.inSpace(p)); },
                          .seen = [&](const glm::dvec2& p) { return seenAt(face, p); }};
    const auto mesh = fillOutline(outline, face.cuts, face.filled ? &rules : nullptr);
    if (!mesh) return {};
    double area = 0.0;
    for (const glm::uvec3& t : mesh->triangles)
      area += 0.5 * cross(mesh->points[t.y] - mesh->points[t.x], mesh->points[t.z] - mesh->points[t.x]);
    if (face.filled && std::abs(area - face.area) > 1e-3 * face.area) return {};  // its triangles overlap
    for (std::size_t i = vertices.size(); i < mesh->points.size(); ++i)
      vertices.push_back({.of = face.basis - first, .weights = weightsAt(face, mesh->points[i])});
    return mesh->triangles;
  }

  // Takes the triangles of a face away and adds others, and their vertices. Returns false, with nothing
  // changed, if there are none.
  bool fill(const FlatFace& face) {
    std::vector<FaceVertex> vertices;
    const std::vector<glm::uvec3> triangles = triangulated(face, vertices);
    if (triangles.empty()) return false;
    const std::uint32_t draw = draw_of_[face.triangles.front()];
    bundle::MeshData& mesh = meshOf(draw);
    for (FaceVertex& vertex : vertices)
      if (vertex.old == kNew) {
        vertex.old = static_cast<std::uint32_t>(mesh.positions.size());
        appendMean<3>(mesh, {vertex.of.x, vertex.of.y, vertex.of.z},
                      {vertex.weights.x, vertex.weights.y, vertex.weights.z});
      }
    const auto inMesh = [mirrored = glm::determinant(glm::mat3(group_.draws[draw].group_from_mesh)) <
                                    0.0f](const glm::uvec3& t) {
      return mirrored ? MeshTriangle{t.x, t.z, t.y} : MeshTriangle{t.x, t.y, t.z};
    };
    Change& change = changes_[draw];
    for (const glm::uvec3& t : triangles)
      for (const std::uint32_t v : inMesh(t)) change.added.push_back(vertices[v].old);
    for (const std::uint32_t t : face.triangles)
      change.gone.insert(inMesh(geometry_.triangles[t] - geometry_.draws[draw].first_vertex));
    return true;
  }

  // Writes the triangles that stay and those that were added.
  void writeMeshes() {
    for (const auto& [draw, change] : changes_) {
      bundle::MeshData& mesh = meshOf(draw);
      std::vector<std::uint32_t> indices;
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const MeshTriangle corners = {mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]};
        if (!change.gone.contains(corners)) indices.insert(indices.end(), corners.begin(), corners.end());
      }
      indices.insert(indices.end(), change.added.begin(), change.added.end());
      mesh.indices = std::move(indices);
      dropUnusedVertices(mesh);
    }
  }

  const RigidGroup& group_;
  const GroupGeometry& geometry_;
  const Importance& importance_;
  std::span<const SeenTriangle> seen_;
  std::size_t room_;
  std::vector<std::vector<bundle::MeshData>>& meshes_;
  double inside_ = 0.0, along_ = 0.0, beside_ = 0.0, contact_ = 0.0;  // metres
  std::vector<bool> free_;                                            // by draw: its mesh may change
  std::vector<std::uint32_t> draw_of_, place_;                        // by triangle, by vertex
  std::vector<FlatFace> faces_;
  std::unordered_map<Edge, std::size_t> parts_;  // into which edges are divided
  std::map<std::uint32_t, Change> changes_;      // by draw
};

}  // namespace

void fillFlatFaces(const RigidGroup& group, const GroupGeometry& geometry, const CopiesOfMeshes& copies,
                   const Importance& importance, std::span<const SeenTriangle> seen, std::size_t room,
                   std::vector<std::vector<bundle::MeshData>>& meshes) {
  if (importance.extent() > 0.0f) FaceFiller(group, geometry, copies, importance, seen, room, meshes).run();
}

}  // namespace lambent::baker
