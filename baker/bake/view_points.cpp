#include "baker/bake/view_points.hpp"

#include <glm/geometric.hpp>

namespace lambent::baker {

namespace {

constexpr std::size_t kRays = 1536;  // of all eyes together

// A Seer collects what eyes see.
class Seer {
 public:
  explicit Seer(const TracedScene& scene) : scene_(scene) {
    for (ViewPoints* points : {&view_.diffuse, &view_.glossy})
      points->points.samples.origin_offsets.push_back(0);
  }

  void add(const SeenPoint& seen_point) {
    const GroupGeometry& geometry = scene_.geometry;
    const FirstHit& hit = seen_point.hit;
    const glm::uvec3 corners = geometry.triangles[hit.triangle];
    const std::uint32_t sample = scene_.samples.vertex_sample[corners.x];
    const auto in = [&](const SampleStretch& stretch) {
      return sample >= stretch.begin && sample < stretch.end;
    };
    const bool glossy = in(scene_.samples.glossy);
    const FacePoint point = facePoint(geometry, corners, {1.0f - hit.u - hit.v, hit.u, hit.v});
    if (!(glm::dot(point.normal, point.origin.geometric_normal) > 0.0f)) return;
    const Seen seen{hit, seen_point.to_eye, seen_point.eye, point};
    if (glossy)
      glossy_.push_back(seen);
    else
      add(seen, view_.diffuse);
  }

  View finish() {
    const std::size_t step = (glossy_.size() + kMostGlossyPoints - 1) / kMostGlossyPoints;
    for (std::size_t i = 0; i < glossy_.size(); i += step) add(glossy_[i], view_.glossy);
    view_.glossy.stands_for = static_cast<std::uint32_t>(step);
    SampleSet &diffuse = view_.diffuse.points.samples, &glossy = view_.glossy.points.samples;
    diffuse.diffuse = {0, diffuse.size()};
    diffuse.normal_mapped = diffuse.glossy = {diffuse.size(), diffuse.size()};
    glossy.glossy = {0, glossy.size()};
    return std::move(view_);
  }

 private:
  struct Seen {
    FirstHit hit;
    glm::vec3 to_eye;
    std::uint32_t eye;
    FacePoint point;
  };

  static void add(const Seen& seen, ViewPoints& out) {
    SampleSet& set = out.points.samples;
    out.points.triangles.push_back(seen.hit.triangle);
    set.positions.push_back(seen.point.position);
    set.normals.push_back(seen.point.normal);
    set.origins.push_back(seen.point.origin);
    set.origin_offsets.push_back(static_cast<std::uint32_t>(set.origins.size()));
    out.weights.emplace_back(1.0f - seen.hit.u - seen.hit.v, seen.hit.u, seen.hit.v);
    out.to_eyes.push_back(seen.to_eye);
    out.eyes.push_back(seen.eye);
  }

  const TracedScene& scene_;
  View view_;
  std::vector<Seen> glossy_;
};

}  // namespace

View viewPoints(const TracedScene& scene, const Importance& importance) {
  Seer seer(scene);
  for (const SeenPoint& seen : importance.look(kRays, scene.geometry, scene.rays)) seer.add(seen);
  View view = seer.finish();
  for (const Eye& eye : importance.eyes()) view.eye_weights.push_back(eye.weight);
  return view;
}

}  // namespace lambent::baker
