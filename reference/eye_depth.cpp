#include "reference/eye_depth.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace lambent::baker::reference {

EyeDepth::EyeDepth(const Volumes& volumes, const Ray& ray, double begin, double end) : volumes_(volumes) {
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

double EyeDepth::extinction(double t, double middle) const {
  double sum = 0.0;
  for (const Part& part : parts_)
    if (middle > part.ray.begin && middle < part.ray.end)
      sum += double{volumes_.grids()[part.volume].at(part.ray.at(t))} * part.ray.metres;
  return sum;
}

// Gauss-Legendre quadrature with two points is exact for cubics.
double EyeDepth::within(const Segment& segment, double t) const {
  const double half = 0.5 * (t - segment.begin), centre = segment.begin + half, aside = half / std::sqrt(3.0);
  const double middle = 0.5 * (segment.begin + segment.end);
  return half * (extinction(centre - aside, middle) + extinction(centre + aside, middle));
}

double EyeDepth::to(double t) const {
  const auto after = std::upper_bound(segments_.begin(), segments_.end(), t,
                                      [](double at, const Segment& s) { return at < s.begin; });
  if (after == segments_.begin()) return 0.0;
  const Segment& segment = *(after - 1);
  if (t < segment.end) return segment.depth + within(segment, t);
  return after == segments_.end() ? whole_ : after->depth;
}

double EyeDepth::place(double depth) const {
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

std::uint32_t EyeDepth::pick(double t, double choice) const {
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

}  // namespace lambent::baker::reference
