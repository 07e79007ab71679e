#include "tests/fixed/double_cg.h"

namespace hvp::fixed::test {

std::vector<Eigen::VectorXd> double_cg(const Eigen::SparseMatrix<double>& a,
                                       const Eigen::VectorXd& b, bool preconditioned,
                                       std::span<const int> updates) {
  Eigen::VectorXd inverse = Eigen::VectorXd::Ones(b.size());
  if (preconditioned) inverse = a.diagonal().cwiseInverse();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
  Eigen::VectorXd r = b;
  Eigen::VectorXd z = inverse.cwiseProduct(r);
  Eigen::VectorXd d = z;
  double z_r = z.dot(r);
  std::vector<Eigen::VectorXd> result;
  for (int update = 1; result.size() < updates.size(); ++update) {
    const Eigen::VectorXd q = a * d;
    const double alpha = z_r / d.dot(q);
    x += alpha * d;
    r -= alpha * q;
    z = inverse.cwiseProduct(r);
    const double z_r_new = z.dot(r);
    d = z + z_r_new / z_r * d;
    z_r = z_r_new;
    if (update == updates[result.size()]) result.push_back(x);
  }
  return result;
}

}  // namespace hvp::fixed::test
