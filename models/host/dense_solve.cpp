#include "models/host/dense_solve.h"

#include <algorithm>
#include <numeric>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::host {

namespace {

std::vector<int> all_nodes(const sparse::BlockMatrix& a) {
  std::vector<int> nodes(at(a.block_rows()));
  std::iota(nodes.begin(), nodes.end(), 0);
  return nodes;
}

std::vector<int> nodes_or_all(std::span<const int> nodes, const sparse::BlockMatrix& a) {
  return nodes.empty() ? all_nodes(a) : std::vector<int>(nodes.begin(), nodes.end());
}

std::vector<int> nodes_without(const sparse::BlockMatrix& a, std::span<const int> nodes) {
  std::vector<int> others;
  std::ranges::set_difference(all_nodes(a), nodes, std::back_inserter(others));
  return others;
}

std::unique_ptr<fem::DirectSolver> positive_factors(const sparse::BlockMatrix& a) {
  auto solver = std::make_unique<fem::DirectSolver>(a);
  if (!solver->positive_definite()) {
    throw InputError(
        "the matrix is not positive definite; host.solver = \"inverse\", \"superposition\" and "
        "\"condensed\" need one");
  }
  return solver;
}

// Factors, and a pair of triangular solves for each column.
SolveWork columns_work(const fem::DirectSolver& solver, std::size_t columns) {
  return factor_work(solver) + static_cast<int>(columns) * triangular_work(solver);
}

// A's blocks in the rows of `rows` and the columns of `columns`, numbered by their places there.
sparse::BlockMatrix blocks_between(const sparse::BlockMatrix& a, std::span<const int> rows,
                                   std::span<const int> columns) {
  std::vector<int> place(at(a.block_rows()), -1);
  for (std::size_t i = 0; i < columns.size(); ++i) place[at(columns[i])] = static_cast<int>(i);
  sparse::BlockMatrix part;
  for (const int row : rows) {
    for (int k = a.row_begin[at(row)]; k < a.row_begin[at(row) + 1]; ++k) {
      const int column = place[at(a.column[at(k)])];
      if (column < 0) continue;
      part.column.push_back(column);
      const double* block = a.block(at(k));
      part.value.insert(part.value.end(), block, block + 9);
    }
    part.row_begin.push_back(static_cast<int>(part.column.size()));
  }
  return part;
}

// y += Bᵀ·x, B's blocks between rows and columns that are numbered apart.
void add_transposed(const sparse::BlockMatrix& b, std::span<const double> x, std::span<double> y) {
  for (std::size_t row = 0; row + 1 < b.row_begin.size(); ++row) {
    for (int k = b.row_begin[row]; k < b.row_begin[row + 1]; ++k) {
      const double* entry = b.block(at(k));
      double* target = &y[3 * at(b.column[at(k)])];
      for (std::size_t i = 0; i < 3; ++i) {
        target[i] +=
            entry[i] * x[3 * row] + entry[3 + i] * x[3 * row + 1] + entry[6 + i] * x[3 * row + 2];
      }
    }
  }
}

// y −= B·x.
template <class Real>
void subtract(const sparse::BlockMatrix& b, std::span<const Real> x, std::span<double> y) {
  for (std::size_t row = 0; row + 1 < b.row_begin.size(); ++row) {
    for (int k = b.row_begin[row]; k < b.row_begin[row + 1]; ++k) {
      const double* entry = b.block(at(k));
      const Real* source = &x[3 * at(b.column[at(k)])];
      const double v[3] = {static_cast<double>(source[0]), static_cast<double>(source[1]),
                           static_cast<double>(source[2])};
      for (std::size_t i = 0; i < 3; ++i) {
        y[3 * row + i] -= entry[3 * i] * v[0] + entry[3 * i + 1] * v[1] + entry[3 * i + 2] * v[2];
      }
    }
  }
}

// Of so many numbers to single precision and back; none in double precision.
template <class Real>
double conversions(double numbers) {
  return sizeof(Real) == sizeof(float) ? numbers : 0;
}

// So many operations on dense vectors in this precision, and the bytes that they move.
template <class Real>
SolveWork dense_work(double operations, double bytes) {
  SolveWork work{.bytes = bytes};
  (sizeof(Real) == sizeof(float) ? work.dense_single : work.dense) = operations;
  return work;
}

double rows_of(std::span<const double> f) { return static_cast<double>(f.size()); }

}  // namespace

template <class Real>
DenseInverse<Real>::DenseInverse(const sparse::BlockMatrix& a)
    : inverse_([&] {
        const std::unique_ptr<fem::DirectSolver> solver = positive_factors(a);
        set_up_ = columns_work(*solver, at(a.rows()));
        factors_ = factor_bytes(*solver);
        const std::vector<int> nodes = all_nodes(a);
        return ComplianceColumns<Real>(*solver, nodes, nodes);
      }()),
      x_(inverse_.rows()) {}

template <class Real>
void DenseInverse<Real>::move_contact(std::span<const int> nodes) {
  inverse_.prescribe(nodes);
  contact_work_ = small_factor_work(inverse_.prescribed_unknowns());
}

template <class Real>
void DenseInverse<Real>::solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
                               std::span<double> u) {
  std::ranges::fill(x_, Real{0});
  for (std::size_t i = 0; i < f.size(); ++i) inverse_.note(i, f[i]);
  inverse_.add_noted(x_);
  inverse_.impose(held, x_);
  std::ranges::copy(x_, u.begin());
  work_ = most_work() + prescribed_work(inverse_.prescribed_unknowns(), rows_of(f), sizeof(Real));
}

template <class Real>
SolveWork DenseInverse<Real>::most_work() const {
  const auto n = static_cast<double>(x_.size());
  SolveWork work = dense_work<Real>(2 * n * n, inverse_.bytes() + 2 * n * sizeof(Real));
  work.sparse = conversions<Real>(2 * n);
  work.barriers = 1;
  return work;
}

template <class Real>
SolveMemory DenseInverse<Real>::memory() const {
  const double vector = static_cast<double>(x_.size() * sizeof(Real));
  return {inverse_.bytes(), inverse_.bytes() + 2 * vector, vector, vector, factors_};
}

template <class Real>
Superposition<Real>::Superposition(const sparse::BlockMatrix& a, std::span<const int> touchable)
    : solver_(positive_factors(a)),
      columns_(*solver_, nodes_or_all(touchable, a), all_nodes(a)),
      set_up_(columns_work(*solver_, columns_.count() + 1)),
      first_x_(at(a.rows())),
      x_(first_x_.size()),
      elsewhere_(first_x_.size()) {}

template <class Real>
void Superposition<Real>::move_contact(std::span<const int> nodes) {
  columns_.prescribe(nodes);
  contact_work_ = small_factor_work(columns_.prescribed_unknowns());
}

template <class Real>
void Superposition<Real>::solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
                                std::span<double> u) {
  if (first_f_.empty()) {
    first_f_.assign(f.begin(), f.end());
    solver_->solve(f, elsewhere_);
    std::ranges::transform(elsewhere_, first_x_.begin(),
                           [](double x) { return static_cast<Real>(x); });
    std::ranges::fill(elsewhere_, 0.0);
  }
  std::ranges::copy(first_x_, x_.begin());
  double added = 0;
  bool rest = false;
  for (std::size_t i = 0; i < f.size(); ++i) {
    const double change = f[i] - first_f_[i];
    if (change == 0) continue;
    const int place = columns_.place(static_cast<int>(i / 3));
    if (place >= 0) {
      columns_.note(3 * at(place) + i % 3, change);
      ++added;
    } else {
      elsewhere_[i] = change;
      rest = true;
    }
  }
  columns_.add_noted(x_);
  work_ = superposed_work(added);
  touched_ = added + columns_.prescribed_unknowns();
  if (rest) {
    solver_->solve(elsewhere_, elsewhere_);
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] += static_cast<Real>(elsewhere_[i]);
    std::ranges::fill(elsewhere_, 0.0);
    work_ += triangular_work(*solver_) + SolveWork{.dense = rows_of(f)};
  }
  columns_.impose(held, x_);
  work_ += prescribed_work(columns_.prescribed_unknowns(), rows_of(f), sizeof(Real));
  std::ranges::copy(x_, u.begin());
}

// The loads are compared with the first, and so many columns are added to the first solution.
template <class Real>
SolveWork Superposition<Real>::superposed_work(double columns) const {
  const auto n = static_cast<double>(x_.size());
  SolveWork work{
      .sparse = n + conversions<Real>(n), .bytes = 2 * n * sizeof(double), .barriers = 1};
  return work += dense_work<Real>(2 * n * columns, (columns + 2) * n * sizeof(Real));
}

template <class Real>
SolveWork Superposition<Real>::most_work() const {
  return superposed_work(kOfAFacet);
}

template <class Real>
SolveMemory Superposition<Real>::memory() const {
  const double vector = static_cast<double>(x_.size() * sizeof(Real));
  const double loads = 2 * static_cast<double>(x_.size() * sizeof(double));
  // A frame touches the columns that it adds, and mostly those of the frame before.
  return {columns_.bytes() + loads + 2 * vector, (touched_ + 3) * vector + loads, vector, vector,
          factor_bytes(*solver_)};
}

template <class Real>
Condensed<Real>::Condensed(const sparse::BlockMatrix& a, std::span<const int> touchable,
                           bool all_loads_change)
    : all_loads_change_(all_loads_change),
      touchable_(nodes_or_all(touchable, a)),
      interior_(nodes_without(a, touchable_)),
      coupling_(blocks_between(a, interior_, touchable_)),
      inverse_([&] {
        const std::unique_ptr<fem::DirectSolver> solver = positive_factors(a);
        set_up_ = columns_work(*solver, 3 * touchable_.size());
        all_factors_ = factor_bytes(*solver);
        return ComplianceColumns<Real>(*solver, touchable_, touchable_);
      }()),
      interior_load_(3 * interior_.size()),
      free_x_(interior_load_.size()),
      coupled_(3 * touchable_.size()),
      rest_(interior_load_.size()),
      x_(3 * touchable_.size()) {
  if (interior_.empty()) return;
  factors_ = std::make_unique<fem::DirectSolver>(a.submatrix(interior_));
  set_up_ += factor_work(*factors_);
}

template <class Real>
void Condensed<Real>::move_contact(std::span<const int> nodes) {
  inverse_.prescribe(nodes);
  contact_work_ = small_factor_work(inverse_.prescribed_unknowns());
}

// With i the interior and s what can be touched: x_s = S⁻¹(f_s − A_si·A_ii⁻¹·f_i), S⁻¹ the part of
// A⁻¹ at s; and x_i = A_ii⁻¹(f_i − A_is·x_s).
template <class Real>
void Condensed<Real>::solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
                            std::span<double> u) {
  bool changed = false;
  for (std::size_t i = 0; i < interior_load_.size(); ++i) {
    const double load = f[3 * at(interior_[i / 3]) + i % 3];
    changed = changed || load != interior_load_[i];
    interior_load_[i] = load;
  }
  work_ = touchable_work();
  if (changed) {
    factors_->solve(interior_load_, free_x_);
    std::ranges::fill(coupled_, 0.0);
    add_transposed(coupling_, free_x_, coupled_);
    work_ += triangular_work(*factors_) + product_work(coupling_);
  }
  std::ranges::fill(x_, Real{0});
  for (std::size_t i = 0; i < x_.size(); ++i) {
    inverse_.note(i, f[3 * at(touchable_[i / 3]) + i % 3] - coupled_[i]);
  }
  inverse_.add_noted(x_);
  inverse_.impose(held, x_);
  work_ +=
      prescribed_work(inverse_.prescribed_unknowns(), static_cast<double>(x_.size()), sizeof(Real));
  for (std::size_t i = 0; i < x_.size(); ++i) {
    u[3 * at(touchable_[i / 3]) + i % 3] = static_cast<double>(x_[i]);
  }
  if (factors_ == nullptr) return;
  std::ranges::copy(interior_load_, rest_.begin());
  subtract<Real>(coupling_, x_, rest_);
  factors_->solve(rest_, rest_);
  for (std::size_t i = 0; i < rest_.size(); ++i) {
    u[3 * at(interior_[i / 3]) + i % 3] = rest_[i];
  }
}

template <class Real>
SolveWork Condensed<Real>::rest_work() const {
  if (factors_ == nullptr) return {};
  return product_work(coupling_) + triangular_work(*factors_);
}

// The interior's loads are compared, the others lessened by what they do, and multiplied.
template <class Real>
SolveWork Condensed<Real>::touchable_work() const {
  const auto n = static_cast<double>(x_.size());
  const auto others = static_cast<double>(interior_load_.size());
  SolveWork work{.sparse = others + n + conversions<Real>(2 * n),
                 .bytes = 2 * others * sizeof(double),
                 .barriers = 1};
  return work += dense_work<Real>(2 * n * n, inverse_.bytes() + 2 * n * sizeof(Real));
}

template <class Real>
SolveWork Condensed<Real>::most_work() const {
  SolveWork work = touchable_work();
  if (factors_ != nullptr && all_loads_change_)
    work += triangular_work(*factors_) + product_work(coupling_);
  return work;
}

template <class Real>
SolveMemory Condensed<Real>::memory() const {
  const double vector = static_cast<double>(x_.size() * sizeof(Real));
  double kept = inverse_.bytes();
  if (factors_ != nullptr) {
    kept += static_cast<double>(factors_->factor_nonzeros()) * (sizeof(double) + sizeof(int)) +
            product_work(coupling_).bytes;
  }
  return {kept, kept + 2 * vector, vector, vector, all_factors_};
}

template class DenseInverse<float>;
template class DenseInverse<double>;
template class Superposition<float>;
template class Superposition<double>;
template class Condensed<float>;
template class Condensed<double>;

namespace {

template <class Real>
std::unique_ptr<HostSolve> make_with(const SolverChoice& choice, const sparse::BlockMatrix& a) {
  switch (choice.by) {
    case SolvedBy::inverse:
      return std::make_unique<DenseInverse<Real>>(a);
    case SolvedBy::superposition:
      return std::make_unique<Superposition<Real>>(a, choice.touchable);
    case SolvedBy::condensed:
      return std::make_unique<Condensed<Real>>(a, choice.touchable, choice.all_loads_change);
    case SolvedBy::board:
    case SolvedBy::cg:
    case SolvedBy::cholesky:
    case SolvedBy::steps:
      break;
  }
  return nullptr;
}

}  // namespace

std::vector<int> touchable_nodes(const fem::Body& body) {
  std::vector<int> nodes;
  for (const auto& triangle : body.mesh().boundary) {
    for (const int node : triangle) {
      if (const int active = body.active_index(node); active >= 0) nodes.push_back(active);
    }
  }
  std::ranges::sort(nodes);
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

std::unique_ptr<HostSolve> make_dense_solve(const SolverChoice& choice,
                                            const sparse::BlockMatrix& a) {
  return choice.precision == Precision::single_precision ? make_with<float>(choice, a)
                                                         : make_with<double>(choice, a);
}

}  // namespace hvp::host
