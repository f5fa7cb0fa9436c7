#include <cmath>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "baker/compress/cpca_clusters.hpp"
#include "tests/baker/compress/evenly.hpp"

namespace lambent::baker {
namespace {

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

}  // namespace
}  // namespace lambent::baker
