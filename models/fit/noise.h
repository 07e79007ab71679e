#pragma once

#include <Eigen/Core>
#include <vector>

namespace hvp::fit {

using Series = std::vector<Eigen::VectorXd>;  // the residuals of each stretch

// An autoregressive model of the residuals, r_t = Σ φ_k·r_{t−k} + e_t, from the autocovariance of
// all stretches (Yule & Walker; Levinson & Durbin). Its order follows from Schwarz' criterion, and
// is at most 20 and a tenth of the residuals.
struct Noise {
  std::vector<double> coefficients;  // φ; empty: white
  double innovation = 0;             // the variance of e

  // Jᵀ·Γ·J for one stretch's J (residuals × parameters), Γ the covariance of its residuals.
  Eigen::MatrixXd between(const Eigen::MatrixXd& jacobian) const;
  // The same without the assumption that e is equally large everywhere: Σ e_t²·y_t·y_tᵀ, where y is
  // the contribution of e to Jᵀ·r (White 1980, with the noise's colour taken out first: Andrews &
  // Monahan 1992).
  Eigen::MatrixXd between(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residuals) const;
};

// The noise of residuals to which so many `unknowns` were fitted; the variance takes account of
// their number.
Noise noise_of(const Series& residuals, int unknowns);

// The test for whiteness of Ljung & Box (1978): n·(n+2)·Σ ρ_k²/(n−k) over `lags`, and the
// probability of at least that value if the residuals were white.
struct Whiteness {
  int lags = 0;
  double statistic = 0;
  double probability = 1;
  bool white() const { return probability >= 0.01; }
};
Whiteness whiteness_of(const Series& residuals);

// The two-sided 95 % point of Student's t distribution.
double t_95(double degrees_of_freedom);

}  // namespace hvp::fit
