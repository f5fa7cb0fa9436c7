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

// An axis of a cluster whose weights span more steps than a code of 16 bits has values. The weights were
// coded with longer steps there, so the bound may be missed however small the step is.
struct WideAxis {
  std::uint32_t cluster = 0;  // index into the clusters given
  Eigen::Index axis = 0;
};

struct Quantized {
  CodedTransfer transfer;      // all but `error`
  std::vector<WideAxis> wide;  // at most one of each cluster, its widest
};

// `points` are coordinates over the rounded basis.
Quantized quantize(const Points& points, const ClusterIds& ids, const std::vector<Cluster>& clusters,
                   const transfer::SharedCodebook& basis, const transfer::TransferShape& shape, double step);

}  // namespace lambent::baker
