#pragma once

#include <Eigen/Core>

// Decompositions of small dense matrices for the tests, compiled once: each source that
// instantiates Eigen's own takes half a minute longer.
namespace hvp::test {

// Of a symmetric matrix, whose lower triangle is read; ascending.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);
struct SymmetricModes {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  // columns, of length one
};
SymmetricModes symmetric_modes(const Eigen::MatrixXd& a);
// λ of K·v = λ·M·v, both symmetric and M positive definite; ascending.
Eigen::VectorXd generalised_eigenvalues(const Eigen::MatrixXd& k, const Eigen::MatrixXd& m);
SymmetricModes generalised_modes(const Eigen::MatrixXd& k, const Eigen::MatrixXd& m);

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a);
// The largest |λ|.
double spectral_radius(const Eigen::MatrixXd& a);

// e^A.
Eigen::MatrixXd exponential(const Eigen::MatrixXd& a);

// By LU with full pivoting.
Eigen::MatrixXd inverse(const Eigen::MatrixXd& a);
Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace hvp::test
