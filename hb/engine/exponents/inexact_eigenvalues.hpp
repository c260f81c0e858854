// Eigenvalues of a matrix that is known up to a change of given size.
#pragma once

#include <Eigen/Core>

namespace hb {

struct InexactEigenvalues {
  Eigen::VectorXcd value;
  // Every matrix within the change has just as many eigenvalues inside the circle of this radius about `value` as M.
  // Infinite if no such radius was found.
  Eigen::VectorXd radius;
};

// Eigenvalues of diag(value) + C with |C_jk| <= change(j, k): Gershgorin's discs, each scaled so that it stands alone
// where it can; those that cannot be told apart share a disc about each of them that holds their whole group.
[[nodiscard]] Eigen::VectorXd gershgorin_radii(const Eigen::VectorXcd& value, const Eigen::MatrixXd& change);

// `change` is in the 2-norm. Discs by Gershgorin's theorem in the coordinates of the eigenvectors where they are apart;
// otherwise, for eigenvalues that lie close or are defective, circles on which no such matrix has an eigenvalue,
// checked at eight points with a factor of two between them. With `leading_only` those that are small and close share
// one circle, large enough to hold them all (it may hold others).
[[nodiscard]] InexactEigenvalues inexact_eigenvalues(const Eigen::MatrixXd& M, double change,
                                                     bool leading_only = false);

}  // namespace hb
