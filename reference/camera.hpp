// Finds the view of a picture exactly as lambent-demo does, with the same bounds, default camera and
// projection, and makes rays through pixel centres.
#pragma once

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

#include "baker/import/scene.hpp"
#include "reference/ray_tracer.hpp"
#include "reference/volumes.hpp"
#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"

namespace lambent::baker::reference {

// Orbit cameras use the bounds of `nodes_at_rest`, so that animated nodes do not move the camera. Errors: no
// camera has that name, or its node or projection is unusable.
Result<spec::View> viewOf(const Scene& scene, const Surfaces& surfaces,
                          const std::vector<gltf::Node>& nodes_at_rest,
                          const std::optional<spec::Camera>& camera, float aspect);

class EyeRays {
 public:
  EyeRays(const spec::View& view, const spec::Size& size);
  // Returns the ray through a pixel's centre. Row 0 is the top. The ray starts on the near plane; the far
  // plane is at ray length 1.
  Ray through(std::uint32_t x, std::uint32_t y) const;
  // Returns the depth of a point along the camera's axis, in metres.
  double depthOf(const glm::dvec3& point_ws) const;
  // Returns the angle of a pixel at the centre of the picture, in radians, as the runtime computes it for its
  // sky.
  float pixelAngle() const { return pixel_angle_rad_; }

 private:
  glm::dmat4 world_from_clip_, view_from_world_;
  spec::Size size_;
  float pixel_angle_rad_;
};

// Integrates the optical depth of the media along one ray from the eye, exactly: between the planes of voxel
// centres, density along the ray is a cubic, which two-point Gauss quadrature integrates exactly. Coverage is
// therefore free of noise, and points that scatter light to the eye can be sampled uniformly. Optical depth
// counts from `begin`. The volumes must outlive this.

class EyeDepth {
 public:
  // Covers the ray from `begin` to `end`, in units of its direction's length.
  EyeDepth(const Volumes& volumes, const Ray& ray, double begin, double end) : volumes_(volumes) {
    std::vector<double> planes;
    for (std::uint32_t v = 0; v < volumes.grids().size(); ++v) {
      const auto inside = volumes.grids()[v].clipped(ray, begin, end);
      if (!inside) continue;
      parts_.push_back({*inside, v});
      planes.insert(planes.end(), {inside->begin, inside->end});
      // Voxel centres are at k + 1/2.
      const glm::dvec3 from = inside->at(inside->begin), to = inside->at(inside->end);
      for (int a = 0; a < 3; ++a) {
        if (inside->dir[a] == 0.0) continue;
        const double last = std::floor(std::max(from[a], to[a]) - 0.5);
        for (double k = std::ceil(std::min(from[a], to[a]) - 0.5); k <= last; k += 1.0)
          planes.push_back(
              std::clamp((k + 0.5 - inside->origin[a]) / inside->dir[a], inside->begin, inside->end));
      }
    }
    std::sort(planes.begin(), planes.end());
    for (std::size_t i = 1; i < planes.size(); ++i) {
      if (!(planes[i - 1] < planes[i])) continue;
      const Segment segment{planes[i - 1], planes[i], whole_};
      const double depth = within(segment, segment.end);
      if (!(depth > 0.0)) continue;
      segments_.push_back(segment);
      whole_ += depth;
    }
  }

  // Returns the optical depth between `begin` and t.
  double to(double t) const {
    const auto after = std::upper_bound(segments_.begin(), segments_.end(), t,
                                        [](double at, const Segment& s) { return at < s.begin; });
    if (after == segments_.begin()) return 0.0;
    const Segment& segment = *(after - 1);
    if (t < segment.end) return segment.depth + within(segment, t);
    return after == segments_.end() ? whole_ : after->depth;
  }
  // Returns the t with this optical depth before it, which is inside a medium.
  double place(double depth) const {
    assert(!segments_.empty());
    auto after = std::upper_bound(segments_.begin(), segments_.end(), depth,
                                  [](double at, const Segment& s) { return at < s.depth; });
    if (after != segments_.begin()) --after;
    const Segment& segment = *after;
    // Newton's method is safeguarded by bisection.
    const double wanted = depth - segment.depth, middle = 0.5 * (segment.begin + segment.end);
    const double all = (after + 1 == segments_.end() ? whole_ : (after + 1)->depth) - segment.depth;
    double low = segment.begin, high = segment.end;
    double t = low + std::clamp(wanted / all, 0.0, 1.0) * (high - low);
    for (int step = 0; step < 30; ++step) {
      const double off = within(segment, t) - wanted;
      if (std::abs(off) <= 1e-7 * all) break;
      (off > 0.0 ? high : low) = t;
      const double newton = t - off / extinction(t, middle);
      t = newton > low && newton < high ? newton : 0.5 * (low + high);
    }
    return t;
  }
  // Selects the volume that scatters at t in proportion to the extinction; `choice` is in [0, 1).
  std::uint32_t pick(double t, double choice) const {
    if (parts_.size() == 1) return parts_.front().volume;
    std::uint32_t last = parts_.front().volume;
    double left = choice * extinction(t, t);
    for (const Part& part : parts_) {
      if (!(t > part.ray.begin && t < part.ray.end)) continue;
      last = part.volume;
      left -= double{volumes_.grids()[part.volume].at(part.ray.at(t))} * part.ray.metres;
      if (left < 0.0) break;
    }
    return last;
  }

 private:
  struct Part {
    GridRay ray;
    std::uint32_t volume;
  };
  struct Segment {
    double begin, end, depth;  // depth: the optical depth before the segment
  };
  // Returns the extinction per t at t, of the volumes that cover the point `middle`.
  double extinction(double t, double middle) const {
    double sum = 0.0;
    for (const Part& part : parts_)
      if (middle > part.ray.begin && middle < part.ray.end)
        sum += double{volumes_.grids()[part.volume].at(part.ray.at(t))} * part.ray.metres;
    return sum;
  }
  // Gauss-Legendre quadrature with two points is exact for cubics.
  double within(const Segment& segment, double t) const {
    const double half = 0.5 * (t - segment.begin), centre = segment.begin + half,
                 aside = half / std::sqrt(3.0);
    const double middle = 0.5 * (segment.begin + segment.end);
    return half * (extinction(centre - aside, middle) + extinction(centre + aside, middle));
  }

  const Volumes& volumes_;
  std::vector<Part> parts_;
  std::vector<Segment> segments_;  // the segments with a medium, in order
  double whole_ = 0.0;
};

}  // namespace lambent::baker::reference
