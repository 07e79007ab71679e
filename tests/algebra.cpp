#include "tests/algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

namespace hvp::test {

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

SymmetricModes symmetric_modes(const Eigen::MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricModes generalised_modes(const Eigen::MatrixXd& k, const Eigen::MatrixXd& m) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(k, m);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::VectorXd generalised_eigenvalues(const Eigen::MatrixXd& k, const Eigen::MatrixXd& m) {
  return generalised_modes(k, m).values;
}

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& a) { return a.eigenvalues(); }

double spectral_radius(const Eigen::MatrixXd& a) { return eigenvalues(a).cwiseAbs().maxCoeff(); }

Eigen::MatrixXd exponential(const Eigen::MatrixXd& a) { return a.exp(); }

Eigen::MatrixXd inverse(const Eigen::MatrixXd& a) { return a.fullPivLu().inverse(); }

Eigen::VectorXd solve(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.fullPivLu().solve(b);
}

}  // namespace hvp::test
