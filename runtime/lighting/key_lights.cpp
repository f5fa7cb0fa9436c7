#include "runtime/lighting/key_lights.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

#include <glm/geometric.hpp>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/image_layout.hpp"

namespace lambent::lighting {

namespace {

// SH bands show a wider disc better than the pieces that it would be divided into
// (docs/pictures/penumbra.png).
constexpr float kWidestDisc_rad = 0.79f;

using sh::kPi;
// If the largest number of small pieces does not suffice, pieces grow in these steps from the largest to the
// widest radius.
constexpr std::array<double, 3> kWidths = {0.0, 0.5, 1.0};
// Keys that would lose less than this share of the least loss stay in the rest.
constexpr double kLeastShare = 0.1;
// All keys together must remove this share of the loss, and each of them on average kLeastGainOfKey of the
// least loss; otherwise there are none.
constexpr double kLeastGain = 0.2, kLeastGainOfKey = 0.1;
// A key has the size of the part with at least this share of its light.
constexpr double kCore = 0.85;
// The shape of a divided disc may lose up to this share of the least loss.
constexpr double kShapeShare = 0.25;
// If the losses of two choices differ by less than this factor, the one with less light in its keys is taken.
constexpr double kAlike = 1.05;

// Describes an analytic disc, or one piece of a large one.
struct DiscCandidate {
  spec::Disc disc;
  std::size_t source;
  double flux, luminance, loss;    // the loss is a flux
  std::vector<LightPoint> points;  // of the light that it represents
  bool divided;
};

// Describes a choice of the light that goes into keys, and what it loses.
struct Choice {
  double threshold = 0.0, loss = 0.0;
  std::size_t level = 0;           // index of the threshold
  double radius_rad = 0.0;         // radius within which light was gathered into pieces
  std::vector<std::size_t> discs;  // indices of candidates
  std::vector<LightPiece> pieces;  // from pictures
};

class Parting {
 public:
  Parting(const spec::DistantLights& lights, const KeyLightOptions& options)
      : lights_(lights), options_(options), blocks_(lights.environment_maps) {}
  PartedLights run();

 private:
  void readDiscs();
  void divideDiscs();
  PieceLimits limits(double radius_rad) const;
  Choice choose(std::size_t level, double radius_rad) const;
  double lossOf(const Choice& choice) const;
  Choice best();
  Choice pruned(Choice choice, double allowed) const;
  // Holds a key and the piece that it is made from; a disc has no piece.
  struct Key {
    spec::Disc disc;
    KeyOrigin origin;
    std::optional<std::uint32_t> piece;
  };
  std::vector<Key> takeFrom(const Choice& choice, PartedLights& parted) const;
  void put(std::vector<Key> keys, PartedLights& parted) const;

  const spec::DistantLights& lights_;
  const KeyLightOptions& options_;
  LightBlocks blocks_;
  std::vector<DiscCandidate> discs_;
  FluxGrid all_;
  double flux_ = 0.0, brightest_ = 0.0;
};

LightPiece pieceOfDisc(const spec::Disc& disc) {
  const double radius = std::clamp(static_cast<double>(disc.radius_rad), 0.0, kPi);
  const double flux = luminance(disc.radiance) * solidAngle(radius);
  const bool shines = std::isfinite(flux) && flux > 0.0 && glm::length(disc.direction) > 0.0f;
  return {shines ? glm::normalize(glm::dvec3(disc.direction)) : glm::dvec3(0, 1, 0), shines ? flux : 0.0,
          radius};
}

void Parting::readDiscs() {
  for (const spec::Disc& disc : lights_.discs) {
    const LightPiece whole = pieceOfDisc(disc);
    if (whole.flux <= 0.0) continue;
    addDisc(all_, whole, 1.0);
    brightest_ = std::max(brightest_, luminance(disc.radiance));
  }
}

// Divides discs; needs the total flux to be known.
void Parting::divideDiscs() {
  for (std::size_t source = 0; source < lights_.discs.size(); ++source) {
    const spec::Disc& disc = lights_.discs[source];
    const LightPiece whole = pieceOfDisc(disc);
    if (whole.flux <= 0.0 || disc.radius_rad > kWidestDisc_rad) continue;
    const double value = luminance(disc.radiance);
    const auto lossAsFlux = [&](const LightPiece& piece) {
      return piece.flux * discLoss(options_.order, piece.radius_rad);
    };
    if (disc.radius_rad <= options_.largest_radius_rad) {
      discs_.push_back({disc, source, whole.flux, value, lossAsFlux(whole), discPoints(whole), false});
      continue;
    }
    for (DiscPiece& part : dividedDisc(whole, static_cast<double>(options_.largest_radius_rad), options_.most,
                                       kShapeShare * options_.least_loss * flux_)) {
      // The piece has the same flux on its own area.
      const auto share = static_cast<float>(part.piece.flux / whole.flux * solidAngle(whole.radius_rad) /
                                            solidAngle(part.piece.radius_rad));
      const spec::Disc small{glm::vec3(part.piece.dir), static_cast<float>(part.piece.radius_rad),
                             share * disc.radiance};
      discs_.push_back(
          {small, source, part.piece.flux, value, lossAsFlux(part.piece), std::move(part.points), true});
    }
  }
}

PieceLimits Parting::limits(double radius_rad) const {
  return {.order = options_.order,
          .most = options_.most,
          .radius_rad = radius_rad,
          .least_flux = kLeastShare * options_.least_loss * flux_};
}

// Chooses the discs and pieces above the threshold that lose most.
Choice Parting::choose(std::size_t level, double radius_rad) const {
  const double threshold = blocks_.threshold(level);
  struct Candidate {
    double loss;
    std::size_t index;
    bool is_disc;
  };
  const std::vector<LightPiece> pieces = gatherPieces(blocks_.points(), limits(radius_rad));
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < discs_.size(); ++i)
    if (discs_[i].luminance > threshold) candidates.push_back({discs_[i].loss, i, true});
  for (std::size_t i = 0; i < pieces.size(); ++i)
    candidates.push_back({pieces[i].flux * discLoss(options_.order, pieces[i].radius_rad), i, false});
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.loss > b.loss; });
  Choice choice;
  choice.threshold = threshold;
  choice.level = level;
  choice.radius_rad = radius_rad;
  for (const Candidate& candidate : candidates) {
    if (choice.discs.size() + choice.pieces.size() >= options_.most) break;
    if (candidate.loss < kLeastShare * options_.least_loss * flux_) break;
    if (candidate.is_disc)
      choice.discs.push_back(candidate.index);
    else
      choice.pieces.push_back(pieces[candidate.index]);
  }
  choice.loss = lossOf(choice);
  return choice;
}

// Returns the loss of a choice. The blocks must be at its threshold.
double Parting::lossOf(const Choice& choice) const {
  FluxGrid rest = all_, misshapen;
  const auto take = [&](const LightPoint& point) {
    rest.add(point.at, -point.flux);
    misshapen.add(point.at, point.flux);
  };
  const auto give = [&](const LightPiece& piece) { addDisc(misshapen, piece, -1.0); };
  for (const std::size_t i : choice.discs) {
    const DiscCandidate& disc = discs_[i];
    for (const LightPoint& point : disc.points) {
      rest.add(point.at, -point.flux);
      if (disc.divided) misshapen.add(point.at, point.flux);
    }
    if (disc.divided)
      give({glm::dvec3(disc.disc.direction), disc.flux, static_cast<double>(disc.disc.radius_rad)});
  }
  std::vector<LightMoment> sums(choice.pieces.size());
  const PieceLimits limit = limits(choice.radius_rad);
  for (const LightPoint& point : blocks_.points())
    if (const auto owner = pieceOf(choice.pieces, limit, point.dir)) {
      take(point);
      sums[*owner].add(point.dir, point.flux);
    }
  for (const LightMoment& sum : sums) give({sum.direction(), sum.flux, sum.radius()});
  return std::sqrt(rest.lostPower(options_.order) + misshapen.lostPower(1)) / flux_;
}

// Returns the choice with the highest threshold that suffices, with the smallest pieces that do; otherwise
// the first of those that lose about least.
Choice Parting::best() {
  std::vector<Choice> tried;
  const auto largest = static_cast<double>(options_.largest_radius_rad);
  const double more = std::max(0.0, static_cast<double>(options_.widest_radius_rad) - largest);
  for (const double width : kWidths) {
    if (width > 0.0 && more == 0.0) break;
    for (std::size_t level = 0; level < blocks_.levels(); ++level) {
      blocks_.lowerTo(level);
      tried.push_back(choose(level, largest + width * more));
      if (tried.back().loss <= options_.least_loss)
        return pruned(std::move(tried.back()), options_.least_loss);
    }
  }
  double least = tried.front().loss;
  for (const Choice& choice : tried) least = std::min(least, choice.loss);
  const auto found = std::find_if(tried.begin(), tried.end(),
                                  [&](const Choice& choice) { return choice.loss <= kAlike * least; });
  blocks_.lowerTo(found->level);
  return pruned(std::move(*found), kAlike * kAlike * least);
}

// Removes keys that are not needed, the weakest first.
Choice Parting::pruned(Choice choice, double allowed) const {
  const auto tryWithout = [&](auto& list) {
    for (std::size_t i = list.size(); i-- > 0;) {
      const auto taken = list[i];
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
      const double loss = lossOf(choice);
      if (loss <= allowed)
        choice.loss = loss;
      else
        list.insert(list.begin() + static_cast<std::ptrdiff_t>(i), taken);
    }
  };
  tryWithout(choice.pieces);
  tryWithout(choice.discs);
  return choice;
}

struct TakenTexel {
  glm::vec3 dir;
  float flux;
};

struct Taken {
  LightMoment moment;
  glm::dvec3 flux{0.0};
  double texel_sr = 0.0;  // sum weighted with the flux
  std::vector<TakenTexel> texels;
  std::vector<double> of_map;  // luminous flux taken from each picture
};

// Returns a radius without the glow. A sun's glow has little of its light but would make its disc several
// times too large, and its shadows too soft. So light twice as far out as the disc reaches is removed
// repeatedly, as long as that is little.
double radiusWithoutGlow(const Taken& taken) {
  LightMoment kept = taken.moment;
  for (int round = 0; round < 8; ++round) {
    const glm::dvec3 middle = kept.direction();
    const double cos_reach = std::cos(std::min(2.0 * kept.radius(), kPi));
    LightMoment inside;
    for (const TakenTexel& texel : taken.texels) {
      const glm::dvec3 dir = glm::normalize(glm::dvec3(texel.dir));
      if (glm::dot(dir, middle) >= cos_reach) inside.add(dir, static_cast<double>(texel.flux));
    }
    if (inside.flux < kCore * taken.moment.flux || inside.flux >= kept.flux * (1.0 - 1e-6)) break;
    kept = inside;
  }
  return kept.radius();
}

spec::Disc discOf(const Taken& taken) {
  const double texel_radius = std::min(std::sqrt(taken.texel_sr / taken.moment.flux / kPi), kPi);
  const auto radius = static_cast<float>(std::clamp(radiusWithoutGlow(taken), texel_radius, kPi));
  return {glm::vec3(taken.moment.direction()), radius,
          glm::vec3(taken.flux / solidAngle(static_cast<double>(radius)))};
}

// Takes light texel by texel: the rest keeps the threshold's luminance in the texel's own colour. The noted
// texels name their piece until put() knows its key.
std::vector<Parting::Key> Parting::takeFrom(const Choice& choice, PartedLights& parted) const {
  std::vector<Taken> taken(choice.pieces.size());
  for (Taken& piece : taken) piece.of_map.resize(lights_.environment_maps.size());
  const PieceLimits limit = limits(choice.radius_rad);
  for (std::size_t k = 0; k < lights_.environment_maps.size() && !choice.pieces.empty(); ++k) {
    const spec::EnvironmentMap& environment_map = lights_.environment_maps[k];
    const int width = static_cast<int>(environment_map.image.width),
              height = static_cast<int>(environment_map.image.height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const std::size_t i =
            static_cast<std::size_t>(y) * environment_map.image.width + static_cast<std::size_t>(x);
        const glm::vec3 whole = environment_map.image.texels[i];
        const double value = luminance(whole);
        if (!(value > choice.threshold)) continue;
        const double sr = sh::texelSolidAngle(environment_map.layout, width, height, x, y);
        if (sr <= 0.0) continue;
        const glm::dvec3 dir = sh::texelDirection(environment_map.layout, width, height, x, y);
        const auto owner = pieceOf(choice.pieces, limit, dir);
        if (!owner) continue;
        std::optional<spec::EnvironmentMap>& rest = parted.environment_maps[k];
        if (!rest) rest = environment_map;
        glm::vec3 kept;
        for (int channel = 0; channel < 3; ++channel)  // a negative value cannot belong to a key
          kept[channel] = whole[channel] > 0.0f
                              ? whole[channel] * static_cast<float>(choice.threshold / value)
                              : whole[channel];
        rest->image.texels[i] = kept;
        Taken& piece = taken[*owner];
        const double flux = sr * luminance(whole - kept);
        piece.flux += sr * (glm::dvec3(whole) - glm::dvec3(kept));
        piece.moment.add(dir, flux);
        piece.texel_sr += sr * flux;
        piece.texels.push_back({glm::vec3(dir), static_cast<float>(flux)});
        piece.of_map[k] += flux;
        parted.texels.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(i),
                                 static_cast<std::uint32_t>(*owner)});
      }
  }
  std::vector<Key> keys;
  for (std::size_t i = 0; i < taken.size(); ++i) {
    if (!(taken[i].moment.flux > 0.0)) continue;
    const auto most = std::ranges::max_element(taken[i].of_map) - taken[i].of_map.begin();
    keys.push_back({.disc = discOf(taken[i]),
                    .origin = {.in_map = true, .index = static_cast<std::size_t>(most)},
                    .piece = static_cast<std::uint32_t>(i)});
  }
  return keys;
}

PartedLights Parting::run() {
  PartedLights parted;
  parted.discs = lights_.discs;
  parted.environment_maps.resize(lights_.environment_maps.size());
  blocks_.addTo(all_);
  brightest_ = blocks_.brightest();
  readDiscs();
  flux_ = all_.flux() + 4 * kPi * luminance(lights_.constant);
  if (!(flux_ > 0.0) || !std::isfinite(flux_) || !(brightest_ > 0.0)) return parted;
  parted.loss_before = parted.loss_after = std::sqrt(all_.lostPower(options_.order)) / flux_;
  if (options_.most == 0 || !(parted.loss_before > options_.least_loss)) return parted;

  divideDiscs();
  // Nothing can stand out below the mean.
  blocks_.setLevels(brightest_, std::min(flux_ / (4 * kPi), brightest_));
  const Choice choice = best();
  const double gain = parted.loss_before - choice.loss;
  const auto count = static_cast<double>(choice.pieces.size() + choice.discs.size());
  if (choice.loss > options_.least_loss &&
      (gain < kLeastGain * parted.loss_before || gain < kLeastGainOfKey * count * options_.least_loss))
    return parted;
  parted.loss_after = choice.loss;
  std::vector<Key> keys = takeFrom(choice, parted);
  if (!keys.empty()) parted.threshold = static_cast<float>(choice.threshold);
  // A disc stays whole if none of its pieces is a key.
  std::vector<bool> broken(lights_.discs.size());
  std::vector<bool> is_key(discs_.size());
  for (const std::size_t i : choice.discs) {
    keys.push_back({.disc = discs_[i].disc,
                    .origin = {.in_map = false, .index = discs_[i].source, .piece = discs_[i].divided},
                    .piece = {}});
    is_key[i] = true;
    broken[discs_[i].source] = true;
  }
  parted.discs.clear();
  for (std::size_t source = 0; source < lights_.discs.size(); ++source)
    if (!broken[source]) parted.discs.push_back(lights_.discs[source]);
  for (std::size_t i = 0; i < discs_.size(); ++i)
    if (!is_key[i] && broken[discs_[i].source]) parted.discs.push_back(discs_[i].disc);
  put(std::move(keys), parted);
  return parted;
}

// Stores the keys ordered by falling loss.
void Parting::put(std::vector<Key> keys, PartedLights& parted) const {
  const auto loss = [&](const spec::Disc& disc) {
    const auto radius = static_cast<double>(disc.radius_rad);
    return luminance(disc.radiance) * solidAngle(radius) * discLoss(options_.order, radius);
  };
  std::stable_sort(keys.begin(), keys.end(),
                   [&](const Key& a, const Key& b) { return loss(a.disc) > loss(b.disc); });
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> key_of_piece;
  for (const Key& key : keys) {
    if (key.piece) {
      if (key_of_piece.size() <= *key.piece) key_of_piece.resize(*key.piece + 1, kNone);
      key_of_piece[*key.piece] = static_cast<std::uint32_t>(parted.keys.size());
    }
    parted.keys.push_back(key.disc);
    parted.origins.push_back(key.origin);
  }
  for (KeyTexel& texel : parted.texels)
    texel.key = texel.key < key_of_piece.size() ? key_of_piece[texel.key] : kNone;
  std::erase_if(parted.texels, [](const KeyTexel& texel) { return texel.key == kNone; });
}

}  // namespace

PartedLights partLights(const spec::DistantLights& lights, const KeyLightOptions& options) {
  return Parting(lights, options).run();
}

}  // namespace lambent::lighting
