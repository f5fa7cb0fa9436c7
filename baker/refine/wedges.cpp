#include "baker/refine/wedges.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <utility>

#include "baker/import/gather_vertices.hpp"

namespace lambent::baker {

namespace {

// Stars with more faces than this, such as poles, are left alone.
constexpr std::size_t kMostFaces = 32;
// Each pass takes the splits that gain at least this share of the least gain taken in the pass before.
constexpr double kStep = 0.6;
constexpr int kPasses = 24;
// Sweeps over all fans settle the values before any split; each roughly halves the remaining change.
constexpr int kSweeps = 6;
constexpr double kGainOfWedge = 3.0 / 8.0;

// Sums what is lacking over some faces: their area, and area times both estimates.
struct Sum {
  double area = 0.0;
  std::vector<double> values;
};

double productOf(const Sum& sum) {
  const std::size_t half = sum.values.size() / 2;
  if (!(sum.area > 0.0)) return 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < half; ++i) product += sum.values[i] * sum.values[half + i];
  return product / sum.area;  // area times the product of the means
}

class FanChooser {
 public:
  FanChooser(FaceLacks lacks, std::size_t stars) : lacks_(std::move(lacks)), offsets_(stars + 1, 0) {
    fans_.of_corner.assign(lacks_.corner_stars.size(), 0);
    for (const std::uint32_t star : lacks_.corner_stars) ++offsets_[star + 1];
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    corners_.resize(lacks_.corner_stars.size());
    std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::uint32_t c = 0; c < corners_.size(); ++c) corners_[next[lacks_.corner_stars[c]]++] = c;
    of_star_.assign(stars, 1);
    changes_.assign(stars, std::vector<float>(2 * lacks_.width, 0.0f));
  }

  Wedges choose(double enough, std::size_t most, const std::stop_token& stop) {
    for (int sweep = 0; sweep < kSweeps && !stop.stop_requested(); ++sweep) settle();
    double least = greatestGain();
    for (int pass = 0; pass < kPasses && least > 0.0 && !stop.stop_requested(); ++pass) {
      least *= kStep;
      for (std::size_t star = 0; star < of_star_.size(); ++star) {
        if (fans_.added >= most) return std::move(fans_);
        splitStar(star, least);
      }
      settle();
      if (left() <= enough) break;
    }
    return std::move(fans_);
  }

 private:
  std::span<const std::uint32_t> cornersOf(std::size_t star) const {
    return std::span(corners_).subspan(offsets_[star], offsets_[star + 1] - offsets_[star]);
  }
  std::span<float> lack(std::uint32_t corner) {
    return std::span(lacks_.values).subspan(corner / 3 * 2 * lacks_.width, 2 * lacks_.width);
  }
  double areaOf(std::uint32_t corner) const { return lacks_.areas[corner / 3]; }

  Sum sumOf(std::span<const std::uint32_t> corners) {
    Sum sum{0.0, std::vector<double>(2 * lacks_.width, 0.0)};
    for (const std::uint32_t corner : corners) {
      const double area = areaOf(corner);
      sum.area += area;
      const auto values = lack(corner);
      for (std::size_t i = 0; i < values.size(); ++i) sum.values[i] += area * double{values[i]};
    }
    return sum;
  }

  // Changes the value of a fan to the optimum while all others stay: by 3/2 of the mean of r less half of its
  // change so far.
  void settle(std::size_t star, std::uint8_t fan) {
    const std::vector<std::uint32_t> own = fanOf(star, fan);
    const Sum sum = sumOf(own);
    if (!(sum.area > 0.0)) return;
    const auto so_far = std::span(changes_[star]).subspan(fan * 2 * lacks_.width, 2 * lacks_.width);
    for (std::size_t i = 0; i < so_far.size(); ++i) {
      const float change = 1.5f * static_cast<float>(sum.values[i] / sum.area) - 0.5f * so_far[i];
      so_far[i] += change;
      for (const std::uint32_t corner : own) lack(corner)[i] -= change / 3.0f;
    }
  }

  std::vector<std::uint32_t> fanOf(std::size_t star, std::uint8_t fan) const {
    std::vector<std::uint32_t> own;
    for (const std::uint32_t corner : cornersOf(star))
      if (fans_.of_corner[corner] == fan) own.push_back(corner);
    return own;
  }

  void settle() {
    for (std::size_t star = 0; star < of_star_.size(); ++star)
      for (std::uint8_t fan = 0; fan < of_star_[star]; ++fan) settle(star, fan);
  }

  // Returns area times square error of one face.
  double errorOf(std::size_t face) const {
    const double area = lacks_.areas[face];
    const float* values = lacks_.values.data() + face * 2 * lacks_.width;
    if (!(area > 0.0)) return 0.0;
    double product = 0.0;
    for (std::size_t i = 0; i < lacks_.width; ++i)
      product += area * double{values[i]} * (area * double{values[lacks_.width + i]});
    return product / area;
  }

  double left() const {
    double sum = 0.0;
    for (std::size_t face = 0; face < lacks_.size(); ++face) sum += errorOf(face);
    return sum;
  }

  double greatestGain() const {
    double most = 0.0;
    for (std::size_t star = 0; star < of_star_.size(); ++star) most = std::max(most, mostOf(cornersOf(star)));
    return kGainOfWedge * most;
  }

  // Returns an upper bound, but for noise, of what a split of these corners can gain.
  double mostOf(std::span<const std::uint32_t> corners) const {
    if (corners.size() < 2 || corners.size() > kMostFaces) return 0.0;
    double most = 0.0;
    for (const std::uint32_t corner : corners) most += std::max(0.0, errorOf(corner / 3));
    return most;
  }

  // Returns whether any of these faces around a star share an edge there.
  bool touch(std::size_t star, std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) const {
    const auto neighbours = [&](std::uint32_t corner) {
      const std::uint32_t face = corner / 3 * 3;
      return std::array{lacks_.corner_stars[face + (corner + 1) % 3],
                        lacks_.corner_stars[face + (corner + 2) % 3]};
    };
    for (const std::uint32_t ca : a)
      for (const std::uint32_t cb : b)
        for (const std::uint32_t na : neighbours(ca))
          for (const std::uint32_t nb : neighbours(cb))
            if (na == nb && na != star) return true;
    return false;
  }

  // Divides a fan in two by joining single faces at the least loss (Ward). Returns what that split gains.
  double partsOf(std::size_t star, std::span<const std::uint32_t> corners,
                 std::vector<std::uint32_t>& apart) {
    struct Part {
      Sum sum;
      double product;
      std::vector<std::uint32_t> corners;
    };
    std::vector<Part> parts;
    for (const std::uint32_t& corner : corners) {
      Sum sum = sumOf(std::span(&corner, 1));
      const double product = productOf(sum);
      parts.push_back({std::move(sum), product, {corner}});
    }
    const auto joined = [](const Sum& a, const Sum& b) {
      Sum sum = a;
      sum.area += b.area;
      for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += b.values[i];
      return sum;
    };
    while (parts.size() > 2) {
      std::size_t best_a = 0, best_b = 0;
      double least = 0.0;
      for (std::size_t a = 0; a < parts.size(); ++a)
        for (std::size_t b = a + 1; b < parts.size(); ++b) {
          if (!touch(star, parts[a].corners, parts[b].corners)) continue;
          const double loss =
              parts[a].product + parts[b].product - productOf(joined(parts[a].sum, parts[b].sum));
          if (best_b == 0 || loss < least) least = loss, best_a = a, best_b = b;
        }
      if (best_b == 0) return 0.0;  // the surfaces only touch at the vertex
      parts[best_a].sum = joined(parts[best_a].sum, parts[best_b].sum);
      parts[best_a].product = productOf(parts[best_a].sum);
      parts[best_a].corners.insert(parts[best_a].corners.end(), parts[best_b].corners.begin(),
                                   parts[best_b].corners.end());
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(best_b));
    }
    apart = parts[1].corners;
    return kGainOfWedge *
           (parts[0].product + parts[1].product - productOf(joined(parts[0].sum, parts[1].sum)));
  }

  void splitStar(std::size_t star, double least) {
    if (of_star_[star] == 255) return;
    for (std::uint8_t fan = 0; fan < of_star_[star]; ++fan) {
      const std::vector<std::uint32_t> own = fanOf(star, fan);
      if (kGainOfWedge * mostOf(own) < least) continue;
      std::vector<std::uint32_t> apart;
      if (partsOf(star, own, apart) < least) continue;
      for (const std::uint32_t corner : apart) fans_.of_corner[corner] = of_star_[star];
      ++of_star_[star];
      ++fans_.added;
      const auto whole = std::span(changes_[star]).subspan(fan * 2 * lacks_.width, 2 * lacks_.width);
      const std::vector<float> inherited(whole.begin(), whole.end());
      changes_[star].insert(changes_[star].end(), inherited.begin(), inherited.end());
      settle(star, static_cast<std::uint8_t>(of_star_[star] - 1));
      settle(star, fan);
      return;
    }
  }

  FaceLacks lacks_;
  Wedges fans_;
  std::vector<std::uint32_t> offsets_, corners_;  // corners of each star
  std::vector<std::uint8_t> of_star_;             // number of fans
  std::vector<std::vector<float>> changes_;       // per star: [fan][estimate][width]
};

}  // namespace

Wedges chooseWedges(FaceLacks lacks, std::size_t stars, double enough, std::size_t most,
                    const std::stop_token& stop) {
  return FanChooser(std::move(lacks), stars).choose(enough, most, stop);
}

void splitIntoWedges(bundle::MeshData& mesh, std::span<const std::uint8_t> of_corner) {
  std::vector<std::uint32_t> sources(mesh.positions.size());
  std::iota(sources.begin(), sources.end(), 0u);
  std::vector<std::uint8_t> fans(sources.size(), 0);
  std::map<std::pair<std::uint32_t, std::uint8_t>, std::uint32_t> copies;
  for (std::size_t c = 0; c < mesh.indices.size(); ++c) {
    if (of_corner[c] == 0) continue;
    const std::uint32_t vertex = mesh.indices[c];
    const auto [entry, is_new] =
        copies.try_emplace({vertex, of_corner[c]}, static_cast<std::uint32_t>(sources.size()));
    mesh.indices[c] = entry->second;
    if (!is_new) continue;
    sources.push_back(vertex);
    fans.push_back(of_corner[c]);
  }
  if (copies.empty()) return;
  gatherVertices(mesh, sources);
  mesh.fans = std::move(fans);
}

}  // namespace lambent::baker
