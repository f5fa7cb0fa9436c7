// Turns clusters into integers. The basis and the clusters' means and axes are rounded to grids as coarse as
// the error allows; then the weights of every sample are fitted by least squares to the rounded axes, all
// with the same step.
#pragma once

#include <vector>

#include "baker/compress/cpca.hpp"
#include "baker/compress/cpca_clusters.hpp"

namespace lambent::baker {

// Rounds the basis of the cell and returns the codebook's basis, basis_scales and value_scales. `axes` are
// columns in the weighted space, `energies` their mean square coordinates, and `roots` those of
// WeightedSpace.
transfer::SharedCodebook roundedBasis(const Eigen::MatrixXd& axes, const Eigen::VectorXd& energies,
                                      const std::vector<double>& roots, double step);

// `points` are coordinates over the rounded basis. Fills in everything but `error`.
CodedTransfer quantize(const Points& points, const ClusterIds& ids, const std::vector<Cluster>& clusters,
                       const transfer::SharedCodebook& basis, const transfer::TransferShape& shape,
                       double step);

}  // namespace lambent::baker
