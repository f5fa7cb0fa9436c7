// Tests the coding of what glossy surfaces need: visibility, and matrices of bounced light.
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>
#include <vector>

#include <Eigen/SVD>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "baker/compress/cpca.hpp"
#include "baker/compress/cpca_clusters.hpp"
#include "baker/compress/kept_transfer.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "tests/support/heaps.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lambent::baker {

namespace {

// Returns importances with which errors of all samples count alike.
std::vector<float> evenly(const Points& points) {
  return std::vector<float>(static_cast<std::size_t>(points.cols()), 1.0f);
}

// Makes Gaussian points, whose coordinate r has mean `r` and standard deviation 1/(1+r).
Points falling(Eigen::Index rank, Eigen::Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  Points points(rank, count);
  for (Eigen::Index s = 0; s < count; ++s)
    for (Eigen::Index r = 0; r < rank; ++r)
      points(r, s) = static_cast<float>(r) + normal(random) / static_cast<float>(1 + r);
  return points;
}

std::vector<std::uint32_t> allOf(const Points& points) {
  std::vector<std::uint32_t> members(static_cast<std::size_t>(points.cols()));
  std::iota(members.begin(), members.end(), 0u);
  return members;
}

Eigen::MatrixXd covarianceOf(const Spectrum& spectrum) {
  return spectrum.axes * spectrum.variances.asDiagonal() * spectrum.axes.transpose();
}

TEST(SpectrumAbout, IsTheSameByProductsOfSamplesAsByCovariance) {
  for (const Eigen::Index count : {2, 7, 25, 39, 40, 90}) {
    const Points points = falling(40, count, 3);
    const auto members = allOf(points);
    const Eigen::VectorXf mean = points.rowwise().mean();
    const Spectrum own = spectrumAbout(points, members, mean);
    const Eigen::MatrixXd covariance = secondMoment(points, members, mean);
    const Spectrum all = spectrumOf(covariance);
    ASSERT_EQ(own.axes.rows(), 40);
    ASSERT_EQ(own.axes.cols(), own.variances.size());
    EXPECT_LE(own.variances.size(), std::min<Eigen::Index>(count, 40));
    EXPECT_GE(own.variances.size(), std::min<Eigen::Index>(count - 1, 40)) << "no true axis is lost";
    // Sums are in float, and coordinates go up to 40.
    const double rounding = 1e-5 * all.variances(0);
    EXPECT_LT((own.variances - all.variances.head(own.variances.size())).cwiseAbs().maxCoeff(), rounding);
    EXPECT_LT((covarianceOf(own) - covariance).norm(), 10.0 * rounding) << count;
    // Only axes whose variance exceeds the rounding of the mean are compared.
    const Eigen::MatrixXd axes = own.axes.leftCols(std::min<Eigen::Index>(count - 1, 40));
    EXPECT_LT((axes.transpose() * axes - Eigen::MatrixXd::Identity(axes.cols(), axes.cols())).norm(), 1e-6);
    for (Eigen::Index j = 1; j < own.variances.size(); ++j) EXPECT_LE(own.variances(j), own.variances(j - 1));
  }
}

TEST(SpectrumAbout, OfOneSampleOrEqualOnesHasNoAxes) {
  Points points = falling(40, 6, 5);
  for (Eigen::Index s = 1; s < 6; ++s) points.col(s) = points.col(0);
  for (const auto& members : {std::vector<std::uint32_t>{3}, allOf(points)}) {
    const Spectrum spectrum = spectrumAbout(points, members, points.col(0));
    EXPECT_EQ(spectrum.variances.size(), 0);
    EXPECT_EQ(spectrum.axes.rows(), 40);
    EXPECT_EQ(spectrum.axes.cols(), 0);
  }
}

TEST(Clusters, OfFewerSamplesThanCoordinatesHaveNoMoreAxesThanThose) {
  Points points = falling(40, 60, 7);
  points.col(59).setConstant(100.0f);
  ClusterIds ids(60, 0);
  for (std::size_t s = 50; s < 59; ++s) ids[s] = 1;
  ids[59] = 2;
  auto clusters = fitClusters(points, ids, /*held_out=*/true, evenly(points));
  ASSERT_EQ(clusters.size(), 3u);
  EXPECT_EQ(clusters[0].axes.cols(), 40);
  EXPECT_LE(clusters[1].axes.cols(), 9);
  EXPECT_EQ(clusters[2].axes.cols(), 0);
  for (const Cluster& cluster : clusters) {
    EXPECT_EQ(cluster.axes.rows(), 40);
    EXPECT_EQ(cluster.variances.size(), cluster.axes.cols());
    EXPECT_EQ(cluster.innovation.size(), cluster.axes.cols());
    EXPECT_TRUE(cluster.variances.allFinite() && cluster.innovation.allFinite());
  }
  const double step = stepFor(clusters, 1e-3);
  EXPECT_TRUE(std::isfinite(step) && step > 0.0);
  EXPECT_EQ(assignClusters(points, clusters, step, ids, evenly(points)).size(), 60u);
}

constexpr transfer::TransferShape kVisibility{.order = 5, .outputs = 25, .visibility_bands = 9};
constexpr transfer::TransferShape kBounced{
    .order = 5, .shadowed_channels = 0, .full_channels = 3, .outputs = 25};

// Returns the decoded means and axes.
std::size_t expandedBytes(const CodedTransfer& coded) {
  std::size_t count = coded.codebook.axis_counts.size();
  for (const auto axes : coded.codebook.axis_counts) count += axes;
  return count * coded.shape.size() * sizeof(float);
}

// Makes an open sky with a few round blockers that move over it: smooth along a path of samples, but never
// the same twice.
std::vector<float> wanderingVisibility(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> out;
  std::array<glm::vec3, 3> blockers;
  for (glm::vec3& blocker : blockers)
    blocker = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
  for (std::size_t s = 0; s < count; ++s) {
    std::array<float, 81> vector{}, y{};
    vector[0] = 3.5449077f;
    for (std::size_t b = 0; b < blockers.size(); ++b) {
      blockers[b] =
          glm::normalize(blockers[b] + 0.1f * glm::vec3(normal(random), normal(random), normal(random)));
      sh::evaluate(9, blockers[b], y);
      const float size = 0.3f + 0.1f * static_cast<float>(b);
      for (int i = 0; i < 81; ++i)
        vector[static_cast<std::size_t>(i)] -=
            size * std::exp(-0.05f * static_cast<float>(sh::bandOf(i) * sh::bandOf(i))) *
            y[static_cast<std::size_t>(i)];
    }
    out.insert(out.end(), vector.begin(), vector.end());
  }
  return out;
}

// Makes reflections of low rank plus a little noise.
std::vector<float> bouncedMatrices(std::size_t count, unsigned seed, float noise) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::array<std::vector<float>, 6> parts;
  for (auto& part : parts)
    for (std::uint32_t i = 0; i < kBounced.size(); ++i) part.push_back(0.1f * normal(random));
  std::vector<float> out;
  for (std::size_t s = 0; s < count; ++s)
    for (std::uint32_t i = 0; i < kBounced.size(); ++i) {
      float value = noise * normal(random);
      for (std::size_t p = 0; p < parts.size(); ++p)
        value += std::sin(0.003f * static_cast<float>(s * (p + 1))) * parts[p][i];
      out.push_back(value);
    }
  return out;
}

Points pointsOf(const std::vector<float>& vectors, std::uint32_t size) {
  return Eigen::Map<const Eigen::MatrixXf>(vectors.data(), size,
                                           static_cast<Eigen::Index>(vectors.size() / size));
}

TEST(MatrixCoding, KeepsItsBoundOnVisibility) {
  const auto vectors = wanderingVisibility(3000, 1);
  for (const float bound : {0.03f, 0.01f, 0.003f}) {
    const CodedTransfer coded = codeTransfer(vectors, 3000, kVisibility, {.bound = bound});
    EXPECT_LE(coded.error, bound);
    EXPECT_NEAR(radianceError(vectors, decodeTransfer(coded), kVisibility), double{coded.error}, 1e-7);
  }
}

TEST(MatrixCoding, WeighsVisibilityByTheErrorsThatItMakesInReflectedLight) {
  // A lobe and a light are rotated randomly, so their coefficients are independent and have the power of
  // their bands.
  const auto visibility = wanderingVisibility(1, 7);
  const sh::GauntTable table = sh::makeGauntTable(5, 5);
  std::vector<float> matrix(625, 0.0f);
  sh::addVisibilityMatrix(table, visibility, matrix);
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  constexpr int kTrials = 40000;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::array<double, 25> lobe{}, light{};
    for (int i = 0; i < 25; ++i) {
      const auto band = static_cast<std::size_t>(sh::bandOf(i));
      lobe[static_cast<std::size_t>(i)] = std::sqrt(kLobePower[band]) * normal(random);
      light[static_cast<std::size_t>(i)] = std::sqrt(kBandPower[band]) * normal(random);
    }
    double reflected = 0.0;
    for (std::size_t i = 0; i < 25; ++i)
      for (std::size_t j = 0; j < 25; ++j) reflected += lobe[i] * double{matrix[25 * i + j]} * light[j];
    sum += reflected * reflected;
  }
  // For a single function V the diagonal is not the whole quadratic form; for its mean over rotations of V it
  // is, and bands 0..8 add up.
  double turned = 0.0;
  std::vector<double> powers(81, 0.0);
  for (std::size_t i = 0; i < 25; ++i)
    for (std::uint32_t t = table.offsets[i]; t < table.offsets[i + 1]; ++t)
      powers[table.terms[t].k] += kLobePower[static_cast<std::size_t>(sh::bandOf(static_cast<int>(i)))] *
                                  kBandPower[static_cast<std::size_t>(sh::bandOf(table.terms[t].j))] *
                                  double{table.terms[t].value} * double{table.terms[t].value};
  for (std::size_t k = 0; k < 81; ++k) turned += powers[k] * double{visibility[k]} * double{visibility[k]};
  EXPECT_NEAR(sum / kTrials / turned, 1.0, 0.03)
      << "lobes and lights alike in all directions: no cross terms";
  EXPECT_NEAR(transferEnergy(visibility, kVisibility) / (3.0 * turned), 1.0, 1e-6) << "three channels";
}

TEST(MatrixCoding, BoundsBouncedLightRelativeToAllThatIsShown) {
  const auto vectors = bouncedMatrices(1500, 3, 1e-4f);
  const double own = transferEnergy(vectors, kBounced);
  for (const double beside : {1.0, 100.0}) {
    const CodedTransfer coded =
        codeTransfer(vectors, 1500, kBounced, {.bound = 0.01f, .shown_energy = beside * own});
    EXPECT_LE(coded.error, 0.01f);
    EXPECT_NEAR(radianceError(vectors, decodeTransfer(coded), kBounced, beside * own), double{coded.error},
                1e-7);
    EXPECT_GT(coded.error, 0.005f) << "what is allowed is made use of";
  }
}

// On the GPU a cell must fit into one page; a larger bundle could not be shown.
TEST(MatrixCoding, KeepsToItsMemoryWithFewerClusters) {
  // There are sixteen clusters with the same three directions: coded apart they need 16 x (1 + 3) vectors, as
  // one about 1 + 18.
  constexpr std::size_t kCount = 16000, kHeaps = 16;
  const std::uint32_t size = kVisibility.size();
  const std::vector<float> vectors = testing::heaps(kCount, kHeaps, size, 29);
  const CodedTransfer free = codeTransfer(vectors, kCount, kVisibility, {.bound = 0.01f});
  const std::size_t most = 32 * size * sizeof(float);
  ASSERT_GT(expandedBytes(free), most) << "or nothing is asked of the other";
  const CodedTransfer coded =
      codeTransfer(vectors, kCount, kVisibility, {.bound = 0.01f, .most_expanded_bytes = most});
  EXPECT_LE(expandedBytes(coded), most);
  EXPECT_LE(coded.error, 0.0101f) << "with more axes in each";
}

TEST(MatrixCoding, FindsTheLeadingComponentsOfLongMatrices) {
  const Points points = pointsOf(bouncedMatrices(700, 17, 1e-4f), kBounced.size());
  double left_out = -1.0;
  const double energy = double{points.squaredNorm()} / 700.0;
  const Spectrum leading = leadingSpectrum(points, 1e-3 * energy, 128, left_out);
  ASSERT_GE(leading.variances.size(), 6);
  ASSERT_LT(leading.variances.size(), static_cast<Eigen::Index>(kBounced.size()));
  EXPECT_NEAR((leading.variances.sum() + left_out) / energy, 1.0, 1e-4);
  EXPECT_LT(left_out, 1e-3 * energy);
  const Eigen::MatrixXd gram = leading.axes.transpose() * leading.axes;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).norm(), 1e-3);
  const Eigen::MatrixXf best = leading.axes.leftCols(6).cast<float>();
  const Points rest = points - best * (best.transpose() * points);
  EXPECT_LT(double{rest.squaredNorm()} / 700.0, 1e-3 * energy) << "six parts were mixed";
}

TEST(MatrixCoding, StaysFiniteAndTheSameOnDegenerateInput) {
  const std::vector<float> dark(81 * 40, 0.0f), alike = [] {
    std::vector<float> all;
    const auto one = wanderingVisibility(1, 19);
    for (int s = 0; s < 40; ++s) all.insert(all.end(), one.begin(), one.end());
    return all;
  }();
  const auto few = wanderingVisibility(3, 23);
  for (const std::vector<float>* vectors : {&dark, &alike, &few})
    for (const std::uint32_t clusters : {0u, 1u, 512u}) {
      const CodingSettings settings{.bound = 0.01f, .clusters = clusters};
      const CodedTransfer a = codeTransfer(*vectors, vectors->size() / 81, kVisibility, settings);
      const CodedTransfer b = codeTransfer(*vectors, vectors->size() / 81, kVisibility, settings);
      for (const float value : decodeTransfer(a)) ASSERT_TRUE(std::isfinite(value));
      EXPECT_EQ(decodeTransfer(a), decodeTransfer(b));
      EXPECT_LE(a.error, 0.01f);
    }
}

// Tests that transfers are coded once, and that the cache keeps them only until all of them are.

constexpr std::size_t kCount = 6000, kHeaps = 24;

std::vector<float> heaps() {
  return testing::heaps(kCount, kHeaps, kVisibility.size(), 31);
}

std::vector<std::byte> keptBytes(const CodedTransfer& coded) {
  ByteWriter out;
  write(coded, out);
  return out.take();
}

std::size_t entriesIn(const std::filesystem::path& folder) {
  std::size_t entries = 0;
  for (const auto& at : std::filesystem::recursive_directory_iterator(folder))
    entries += at.is_regular_file();
  return entries;
}

}  // namespace

TEST(CachedCoding, FindsWhatWasCodedUntilItIsDropped) {
  const std::vector<float> vectors = heaps();
  const testing::TemporaryFolder folder;
  auto cache = Cache::open(folder.path());
  ASSERT_TRUE(cache);
  Progress progress;
  const BakeContext context{progress, {}, &*cache};
  CachedCoding coding(context);
  const CodedTransfer coded = coding.code(vectors, kCount, kVisibility, {.bound = 0.01f});
  EXPECT_EQ(entriesIn(folder.path()), 1u) << "the codes";
  const auto before = cache->figures().stored;
  const CodedTransfer found = CachedCoding(context).code(vectors, kCount, kVisibility, {.bound = 0.01f});
  EXPECT_EQ(cache->figures().stored, before) << "found";
  EXPECT_EQ(keptBytes(found), keptBytes(coded));
  coding.drop();
  EXPECT_EQ(entriesIn(folder.path()), 0u);
}

}  // namespace lambent::baker
