#include "baker/refine/group_refiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <utility>

#include <glm/geometric.hpp>

#include "baker/jobs/parallel.hpp"
#include "baker/refine/flat_faces.hpp"
#include "baker/transport/geometry_key.hpp"
#include "baker/transport/samples.hpp"

namespace lambent::baker {

namespace {

// A triangle is probed at n² points if its longest edge is n times this share of the extent of what is seen.
constexpr float kProbeSpacing = 1.0f / 32.0f;
constexpr int kMostProbesAlong = 8;
// Rays of eyes that place further points, where what is seen of a triangle is small beside it.
constexpr std::size_t kSeenPlaces = 8192;
// Triangles that take up less of all pictures than this, a pixel or two of each, are not probed. They are
// most triangles of a furnished room, and show shadows as they are.
constexpr double kLeastShare = 4e-6;
constexpr std::uint32_t kUnused = 0xffffffffu;  // a sample of no triangle that is probed
// Light is never taken to be less than this share of what eyes see on average, of the sky or of lamps.
constexpr double kLeastLight = 0.1;
// Errors at glossy points count by this factor. What few bands leave of a highlight hides them: a body of
// gold has the same picture with a quarter of the samples (docs/design/vertices.md), and each costs a
// matrix.
constexpr double kGlossyCounts = 0.4;
// A split triangle splits its edges of at least this share of the longest one.
constexpr float kSplitShare = 0.6f;
// Edges that are shorter than so many steps of floats at their place are not split: splits would show
// rounding.
constexpr float kFewestSteps = 256.0f;
// Edges of bad triangles are cut up to this share of the extent.
constexpr float kLongestCut = 1.0f / 16.0f;
// Light leaks to a corner that has less than this share of the light of another, if that has at least this
// share of the light that eyes see on average.
constexpr float kDarkShare = 0.25f, kLightShare = 0.1f;
// A round splits triangles until the remaining square error of a region is this share of what is allowed, or
// this share of all of it if that is more, because what the first splits show decides where the next ones go.
constexpr double kLeftOfAllowed = 0.6, kLeftOfAll = 0.35;
// Many rays do not probe the triangles whose errors, as few rays show them with noise, make up this share of
// all error of a region, or of what is allowed if that is more.
// Nor do they where the square error is so many times what noise adds to it: few rays are enough then.
constexpr double kOverlooked = 0.1, kBeyondDoubt = 2.0;

// Returns the centres of n² equal parts of a triangle, by the weights of its corners.
std::vector<glm::vec3> innerPoints(int n) {
  std::vector<glm::vec3> points;
  const float part = 1.0f / (3.0f * static_cast<float>(n));
  for (int i = 0; i < n; ++i)
    for (int j = 0; i + j < n; ++j) {
      const auto add = [&](int a, int b) {
        const float u = static_cast<float>(a) * part, v = static_cast<float>(b) * part;
        points.emplace_back(1.0f - u - v, u, v);
      };
      add(3 * i + 1, 3 * j + 1);
      if (i + j + 1 < n) add(3 * i + 2, 3 * j + 2);
    }
  return points;
}

// Gives samples that cannot be seen the most light of their neighbours, as transfer_field.hpp may, and of
// theirs.
void lightUnseen(const GroupGeometry& geometry, const SampleSet& samples,
                 std::span<const std::uint32_t> triangles, std::span<const std::uint8_t> seen,
                 std::vector<float>& light) {
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<float> before = light;
    for (const std::uint32_t t : triangles) {
      const glm::uvec3 corners = geometry.triangles[t];
      for (int c = 0; c < 3; ++c)
        if (const std::uint32_t s = samples.vertex_sample[corners[c]]; seen[s] == 0)
          for (int k = 1; k < 3; ++k)
            light[s] = std::max(light[s], before[samples.vertex_sample[corners[(c + k) % 3]]]);
    }
  }
}

std::vector<SampleKind> kindsOf(const SampleSet& samples) {
  std::vector<SampleKind> kinds(samples.size());
  for (const SampleCell& cell : samples.cells) std::fill_n(kinds.begin() + cell.first, cell.count, cell.kind);
  return kinds;
}

// Returns the number of each sample at a corner of these triangles as a point that is probed, else kUnused.
std::vector<std::uint32_t> cornerPoints(ProbedPoints& points, const GroupGeometry& geometry,
                                        const SampleSet& samples, std::span<const SampleKind> kinds,
                                        std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> numbers(samples.size(), kUnused);
  for (const std::uint32_t t : triangles)
    for (int c = 0; c < 3; ++c)
      if (const std::uint32_t s = samples.vertex_sample[geometry.triangles[t][c]]; numbers[s] == kUnused)
        numbers[s] =
            points.numberOf(samples.positions[s], samples.normals[s], kinds[s], samples.originsOf(s));
  return numbers;
}

// Squares of what is wrong at a point, relative to the light there.
struct PointError {
  double square = 0.0;      // without bias from noise
  double with_noise = 0.0;  // of what all rays together show
};

double square(double value) {
  return value * value;
}

// Light of the sky and that of lamps may shine without each other, so each is to be right.
PointError pointError(const ShadowProbe::Difference& wrong, const ShadowProbe::Difference& arriving,
                      const SentLight& wrongly_sent, const SentLight& sent, const SurfaceLight& lit) {
  const double light = std::max(ShadowProbe::squareError(arriving), 0.0) + square(double{sent.bounced}) +
                       square(std::max(kLeastLight * double{lit.meanSky()}, 1e-6));
  const double bounced = square(double{wrongly_sent.bounced}) / light;
  PointError error{.square = ShadowProbe::squareError(wrong) / light + bounced, .with_noise = bounced};
  for (std::size_t i = 0; i < ShadowProbe::kMostValues; ++i)
    error.with_noise += square(0.5 * (double{wrong[0][i]} + double{wrong[1][i]})) / light;
  if (lit.meanLamps() > 0.0f) {
    const double lamps = square(double{wrongly_sent.lamps}) /
                         (square(double{sent.lamps}) + square(kLeastLight * double{lit.meanLamps()}));
    error.square = std::max(error.square, lamps);
    error.with_noise = std::max(error.with_noise, lamps);
  }
  return error;
}

Key sceneKey(const RefineScene& from, const GroupGeometry& geometry, std::span<const PlannedLight> lights,
             std::span<const Eye> eyes) {
  KeyMaker key = KeyMaker::ofStage("refinement probes");
  addShape(geometry, key);
  addOpacity(from.scene, geometry, key);
  addLights(from.scene, geometry, lights, key);
  addEyes(eyes, key);
  return key.key();
}

}  // namespace

Result<void> GroupRefiner::prepare(const RigidGroup& group) {
  auto rays = RayScene::build(geometry_, from_.scene, from_.images);
  if (!rays) return failAgain(rays.error());
  rays_.emplace(std::move(*rays));
  const std::vector<Eye> cameras = cameraEyes(from_.scene, group, geometry_);
  lights_ = findGroupLights(from_.scene, group);
  importance_ = Importance(geometry_, *rays_, cameras);
  auto colors = SurfaceColors::load(from_.scene, geometry_, lights_, from_.images);
  if (!colors) return failAgain(colors.error());
  colors_.emplace(std::move(*colors));
  light_.emplace(from_.scene, geometry_, *rays_, *colors_, lights_, importance_, few_.shadowProbe());
  key_ = sceneKey(from_, geometry_, lights_, cameras);
  for (const SeenPoint& seen : importance_.look(kSeenPlaces, geometry_, *rays_)) {
    const glm::vec3 weights(1.0f - seen.hit.u - seen.hit.v, seen.hit.u, seen.hit.v);
    seen_.push_back({facePoint(geometry_, geometry_.triangles[seen.hit.triangle], weights), seen.ray,
                     static_cast<std::uint32_t>(importance_.regions().at(seen.position)), seen.share});
  }
  return {};
}

float GroupRefiner::seenAt(const FacePoint& point) {
  const auto [entry, is_new] = seen_at_.try_emplace(vertexKey(point.position, point.normal, {}), 0.0f);
  if (is_new) entry->second = importance_.at({point.origin.position, point.origin.geometric_normal}).seen;
  return entry->second;
}

void GroupRefiner::addEvenly(const GroupGeometry& geometry, std::uint32_t t, int along) {
  const glm::uvec3 corners = geometry.triangles[t];
  const std::vector<glm::vec3> points = innerPoints(along);
  const auto area = static_cast<float>(triangleArea(geometry, corners) / static_cast<double>(points.size()));
  const std::size_t first = inner_.size();
  float share = 0.0f;
  for (const glm::vec3& weights : points) {
    Inner inner{.triangle = t, .weights = weights, .point = facePoint(geometry, corners, weights)};
    inner.share = area * seenAt(inner.point);
    inner.region = static_cast<std::uint32_t>(importance_.regions().at(inner.point.position));
    share += inner.share;
    if (inner.share > 0.0f) inner_.push_back(inner);
  }
  if (double{share} < kLeastShare) inner_.resize(first);
}

Result<void> GroupRefiner::placeInner(const GroupGeometry& geometry) {
  inner_.clear(), parts_.clear();
  // Rays of eyes find the triangles that lie at the seen places now. Splits only add triangles, so that a
  // group with as many as before any split is the same.
  std::optional<RayScene> split;
  if (geometry.triangles.size() != geometry_.triangles.size()) {
    auto built = RayScene::build(geometry, from_.scene, from_.images);
    if (!built) return failAgain(built.error());
    split = std::move(*built);
  }
  const RayScene& now = split ? *split : *rays_;
  std::vector<std::vector<Inner>> seen_in(geometry.triangles.size());
  auto place = seen_.begin();
  for (const SeenPoint& seen : importance_.look(kSeenPlaces, geometry, now)) {
    while (place != seen_.end() && place->ray < seen.ray) ++place;
    if (place == seen_.end() || place->ray != seen.ray) continue;
    seen_in[seen.hit.triangle].push_back({seen.hit.triangle,
                                          place->region,
                                          {1.0f - seen.hit.u - seen.hit.v, seen.hit.u, seen.hit.v},
                                          place->point,
                                          place->share});
  }
  for (const DrawGeometry& draw : geometry.draws) {
    if (draw.texels > 0 || (draw.kind == SampleKind::Glossy && !with_glossy_)) continue;
    for (std::uint32_t t = draw.first_triangle; t < draw.first_triangle + draw.triangle_count; ++t) {
      const glm::uvec3 corners = geometry.triangles[t];
      const double area = triangleArea(geometry, corners);
      if (!(area > 0.0)) continue;
      const float spacing = kProbeSpacing * importance_.extent();
      const int along = std::clamp(static_cast<int>(std::ceil(longestEdge(geometry, corners) / spacing)), 1,
                                   kMostProbesAlong);
      if (seen_in[t].size() > static_cast<std::size_t>(along * along)) {
        inner_.insert(inner_.end(), seen_in[t].begin(), seen_in[t].end());
        continue;
      }
      const FacePoint middle = facePoint(geometry, corners, glm::vec3(1.0f / 3.0f));
      const double most =
          area * double{importance_.mostSeen({middle.origin.position, middle.origin.geometric_normal})};
      if (along == 1 && most < kLeastShare) continue;
      addEvenly(geometry, t, along);
    }
  }
  std::ranges::stable_sort(inner_, {},
                           [](const Inner& inner) { return std::pair(inner.triangle, inner.region); });
  for (std::size_t first = 0, last = 0; first < inner_.size(); first = last) {
    while (last < inner_.size() && inner_[last].triangle == inner_[first].triangle &&
           inner_[last].region == inner_[first].region)
      ++last;
    parts_.push_back({inner_[first].triangle, inner_[first].region, first, last});
  }
  return {};
}

std::vector<std::uint32_t> GroupRefiner::seenTriangles() const {
  std::vector<std::uint32_t> triangles;
  for (const Part& part : parts_)
    if (triangles.empty() || triangles.back() != part.triangle) triangles.push_back(part.triangle);
  return triangles;
}

GroupRefiner::RegionSums GroupRefiner::sumRegions() const {
  const std::size_t count = importance_.regions().size();
  RegionSums sums{std::vector<double>(count, 0.0), std::vector<double>(count, 0.0)};
  for (const Part& part : parts_) {
    sums.square_error[part.region] += part.square_error;
    sums.seen[part.region] += part.seen;
  }
  return sums;
}

double GroupRefiner::relativeError() const {
  const RegionSums sums = sumRegions();
  std::vector<double> errors;
  for (std::size_t r = 0; r < sums.seen.size(); ++r)
    errors.push_back(sums.seen[r] > 0.0 ? std::sqrt(std::max(0.0, sums.square_error[r]) / sums.seen[r])
                                        : 0.0);
  return boundingError(errors, sums.seen);
}

Result<bool> GroupRefiner::measure(const GroupGeometry& geometry, double bound, const BakeContext& context) {
  const SampleSet samples = buildSamples(geometry, /*with_texels=*/false);
  if (auto placed = placeInner(geometry); !placed) return failAgain(placed.error());
  if (!measureBy(few_, geometry, samples, seenTriangles(), context)) return false;
  if (!chosen_ && relativeError() <= bound) return true;
  std::vector<std::uint32_t> again = trianglesThatMatter(bound);
  std::erase_if(again, [&](std::uint32_t t) {
    return samples.vertex_sample[geometry.triangles[t].x] >= samples.glossy.begin;
  });
  return measureBy(many_, geometry, samples, again, context);
}

std::vector<std::uint32_t> GroupRefiner::trianglesThatMatter(double bound) const {
  const RegionSums sums = sumRegions();
  std::vector<double> overlooked(sums.seen.size(), 0.0);
  std::vector<const Part*> order;
  for (const Part& part : parts_) order.push_back(&part);
  std::ranges::stable_sort(order, {}, &Part::with_noise);
  std::vector<std::uint32_t> matter;
  for (const Part* part : order) {
    const double allowed = std::max(bound * bound * sums.seen[part->region], sums.square_error[part->region]);
    overlooked[part->region] += part->with_noise;
    if (overlooked[part->region] <= kOverlooked * allowed) continue;
    if (part->square_error > kBeyondDoubt * std::max(part->with_noise - part->square_error, 0.0)) continue;
    matter.push_back(part->triangle);
  }
  std::ranges::sort(matter);
  matter.erase(std::unique(matter.begin(), matter.end()), matter.end());
  return matter;
}

bool GroupRefiner::measureBy(ProbedPoints& points, const GroupGeometry& geometry, const SampleSet& samples,
                             std::span<const std::uint32_t> triangles, const BakeContext& context) {
  const std::vector<SampleKind> kinds = kindsOf(samples);
  const std::vector<std::uint32_t> of_sample = cornerPoints(points, geometry, samples, kinds, triangles);
  std::vector<std::uint32_t> number(inner_.size(), kUnused);
  const auto kindOf = [&](std::uint32_t t) { return kinds[samples.vertex_sample[geometry.triangles[t].x]]; };
  const auto listed = [&](std::uint32_t t) { return std::ranges::binary_search(triangles, t); };
  for (std::size_t i = 0; i < inner_.size(); ++i)
    if (const Inner& inner = inner_[i]; listed(inner.triangle))
      number[i] = points.numberOf(inner.point.position, inner.point.normal, kindOf(inner.triangle),
                                  std::span(&inner.point.origin, 1));
  if (!points.probe(key_, *rays_, *light_, context)) return false;

  const ShadowProbe& probe = points.shadowProbe();
  std::vector<PointError> error_at(inner_.size());
  std::vector<std::uint8_t> seen_at(inner_.size(), 0);
  // Points that cannot be seen have no error, and unseen corners take the values of their neighbours
  // (transfer_field.hpp).
  const auto measureAt = [&](std::size_t i) {
    const Inner& inner = inner_[i];
    if (number[i] == kUnused || !points.seen(number[i])) return;
    std::array<HiddenFrom, 3> corners;
    std::array<std::uint32_t, 3> at{};
    float shares = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t sample = samples.vertex_sample[geometry.triangles[inner.triangle][c]];
      HiddenFrom& corner = corners[static_cast<std::size_t>(c)];
      at[static_cast<std::size_t>(c)] = of_sample[sample];
      corner = {points.masksAt(of_sample[sample]), samples.normals[sample],
                points.seen(of_sample[sample]) ? inner.weights[c] : 0.0f};
      shares += corner.share;
    }
    if (!(shares > 0.0f)) return;
    const SentLight& sent = points.lightAt(number[i]);
    SentLight wrongly{-sent.lamps, -sent.bounced};
    for (std::size_t c = 0; c < 3; ++c) {
      corners[c].share /= shares;
      wrongly.lamps += corners[c].share * points.lightAt(at[c]).lamps;
      wrongly.bounced += corners[c].share * points.lightAt(at[c]).bounced;
    }
    const HiddenFrom truth{points.masksAt(number[i]), inner.point.normal};
    const SampleKind kind = kindOf(inner.triangle);
    const auto wrong = probe.difference(corners, truth, kind);
    error_at[i] = pointError(wrong, probe.arriving(truth, kind), wrongly, sent, *light_);
    if (kind == SampleKind::Glossy) {
      error_at[i].square *= square(kGlossyCounts);
      error_at[i].with_noise *= square(kGlossyCounts);
    }
    seen_at[i] = 1;
  };
  const bool done =
      parallelRanges(inner_.size(), kPointsPerRange, context.stop, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) measureAt(i);
      });
  if (!done) return false;
  for (Part& part : parts_) {
    if (!listed(part.triangle)) continue;
    part.square_error = part.with_noise = part.seen = 0.0;
    for (std::size_t i = part.first; i < part.last; ++i) {
      const double share = double{inner_[i].share};
      part.square_error += share * error_at[i].square;
      part.with_noise += share * error_at[i].with_noise;
      if (seen_at[i] != 0) part.seen += share;
    }
  }
  return true;
}

void GroupRefiner::fillFaces(const RigidGroup& group, const GroupGeometry& geometry, double bound,
                             const CopiesOfMeshes& copies, std::size_t room,
                             std::vector<std::vector<bundle::MeshData>>& meshes) const {
  std::vector<SeenTriangle> seen(geometry.triangles.size());
  for (const Part& part : parts_) {
    seen[part.triangle].share += part.seen;
    seen[part.triangle].excess += part.square_error - bound * bound * part.seen;
  }
  fillFlatFaces(group, geometry, copies, importance_, seen, room, meshes);
}

std::size_t GroupRefiner::markWorst(std::size_t group, const GroupGeometry& geometry, double bound,
                                    std::size_t& room, MarkedEdges& edges) {
  if (relativeError() <= bound) return 0;
  chosen_ = true;
  const RegionSums sums = sumRegions();
  std::vector<double> left = sums.square_error;
  std::vector<const Part*> order;
  for (const Part& part : parts_)
    if (sums.square_error[part.region] > bound * bound * sums.seen[part.region]) order.push_back(&part);
  std::ranges::stable_sort(order, std::greater(), &Part::square_error);
  std::vector<FaceEdge> marked;
  for (const Part* part : order) {
    if (room < 3) break;
    const double enough = std::max(kLeftOfAllowed * bound * bound * sums.seen[part->region],
                                   kLeftOfAll * sums.square_error[part->region]);
    if (left[part->region] <= enough) continue;
    left[part->region] -= part->square_error;
    const glm::uvec3 corners = geometry.triangles[part->triangle];
    const float longest = longestEdge(geometry, corners);
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t a = corners[c], b = corners[(c + 1) % 3];
      const glm::vec3 place = glm::abs(geometry.origin + geometry.positions[a]);
      const float step = std::numeric_limits<float>::epsilon() * std::max({place.x, place.y, place.z});
      if (glm::distance(geometry.positions[a], geometry.positions[b]) <
          std::max(kSplitShare * longest, kFewestSteps * step))
        continue;
      const auto added = edges.mark(group, a, b);
      if (!added) continue;
      marked.push_back({a, b, part->triangle});
      room -= std::min(room, *added);
    }
  }
  // Longer edges are halved: light changes on both sides of a cut, too.
  const std::vector<float> cuts = cutShares(geometry_, *rays_, importance_.extent(), geometry, marked,
                                            kLongestCut * importance_.extent());
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (cuts[i] > 0.0f) edges.splitAt(group, marked[i].a, marked[i].b, cuts[i]);
  return marked.size();
}

std::optional<std::size_t> GroupRefiner::markLeaks(std::size_t group, const GroupGeometry& geometry,
                                                   std::size_t& room, MarkedEdges& edges,
                                                   const BakeContext& context) {
  const SampleSet samples = buildSamples(geometry, /*with_texels=*/false);
  const std::vector<SampleKind> kinds = kindsOf(samples);
  const std::vector<std::uint32_t> probed = seenTriangles();
  const std::vector<std::uint32_t> number = cornerPoints(few_, geometry, samples, kinds, probed);
  if (!few_.probe(key_, *rays_, *light_, context)) return std::nullopt;
  std::vector<float> light(samples.size(), 0.0f);
  std::vector<std::uint8_t> seen(samples.size(), 0);
  const auto lightAt = [&](std::size_t s) {
    if (number[s] == kUnused || !few_.seen(number[s])) return;
    seen[s] = 1;
    light[s] = few_.shadowProbe().openShare({few_.masksAt(number[s]), samples.normals[s]}) +
               few_.lightAt(number[s]).bounced;
  };
  const bool done =
      parallelRanges(samples.size(), kPointsPerRange, context.stop, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) lightAt(s);
      });
  if (!done) return std::nullopt;
  lightUnseen(geometry, samples, probed, seen, light);
  const float least = kLightShare * light_->meanSky();
  std::vector<FaceEdge> between;
  std::set<std::pair<std::uint32_t, std::uint32_t>> met;
  for (const std::uint32_t t : probed)
    for (int c = 0; c < 3; ++c) {
      std::uint32_t dark = geometry.triangles[t][c], lit = geometry.triangles[t][(c + 1) % 3];
      if (light[samples.vertex_sample[dark]] > light[samples.vertex_sample[lit]]) std::swap(dark, lit);
      const std::uint32_t in_dark = samples.vertex_sample[dark], in_light = samples.vertex_sample[lit];
      if (seen[in_dark] != 0 && light[in_light] > least && light[in_dark] < kDarkShare * light[in_light] &&
          met.emplace(std::minmax(dark, lit)).second)
        between.push_back({dark, lit, t});
    }
  const std::vector<float> cuts = cutShares(geometry_, *rays_, importance_.extent(), geometry, between,
                                            std::numeric_limits<float>::max());
  std::size_t marked = 0;
  for (std::size_t i = 0; i < between.size() && room > 0; ++i) {
    if (cuts[i] == 0.0f) continue;
    const auto added = edges.mark(group, between[i].a, between[i].b);
    if (!added) continue;
    edges.splitAt(group, between[i].a, between[i].b, cuts[i]);
    ++marked, room -= std::min(room, *added);
  }
  return marked;
}

}  // namespace lambent::baker
