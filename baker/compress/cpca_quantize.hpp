// From clusters to integers: the basis, the clusters' means and axes on grids as coarse as the error allows,
// then the weights of every sample by least squares over what those grids left, all with the same step.
#pragma once

#include <vector>

#include "baker/compress/cpca.hpp"
#include "baker/compress/cpca_clusters.hpp"

namespace lambent::baker {

// The basis of the cell, rounded: basis, basis_scales and value_scales of a codebook; `axes` are columns in
// the weighted space, `energies` their mean square coordinates.
bundle::SharedCodebook roundedBasis(const Eigen::MatrixXd& axes, const Eigen::VectorXd& energies,
                                    const std::vector<double>& roots, double step);

// points: coordinates over the rounded basis. Fills everything but `error`.
CodedTransfer quantize(const Points& points, const ClusterIds& ids, const std::vector<Cluster>& clusters,
                       const bundle::SharedCodebook& basis, const bundle::TransferShape& shape, double step);

}  // namespace lambent::baker
