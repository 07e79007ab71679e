#include "tables/thesis/experiment.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "app/mesh/sandboxed_mesh.h"
#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/fixed/solver.h"
#include "models/fixed/system.h"
#include "models/fixed/word.h"
#include "models/mesh/region.h"
#include "tables/random.h"

namespace hvp::tables {

namespace {

using Vector = std::vector<double>;

constexpr int kThesisMatrixBits = 12;
constexpr int kThesisVectorBits = 16;
constexpr double kThesisNorm = 2.47e5;

double dot(const Vector& x, const Vector& y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}

double relative_distance(std::span<const double> x, const Vector& exact) {
  double sum = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) sum += (x[i] - exact[i]) * (x[i] - exact[i]);
  return std::sqrt(sum / dot(exact, exact));
}

ThesisMesh make_mesh(mesh::MeshSettings::Shape shape, int wanted_nodes) {
  mesh::MeshSettings settings;
  settings.shape = shape;
  settings.nodes = wanted_nodes;
  const mesh::TetMesh mesh = app::sandboxed_mesh(settings);
  mesh::Region held;
  held.fraction = 0.15;
  fem::Material material;
  material.poisson_ratio = 0.3;
  ThesisMesh result;
  result.nodes = static_cast<int>(mesh.nodes.size());
  result.name = (shape == mesh::MeshSettings::Shape::sphere ? "sphere, " : "cube, ") +
                std::to_string(result.nodes);
  result.stiffness =
      fem::Body(mesh, material, mesh::select_nodes(held, mesh), fem::AnchorTreatment::removed)
          .stiffness();
  result.solver = std::make_unique<fem::DirectSolver>(result.stiffness);
  result.condition = fem::extreme_eigenvalues(result.stiffness, *result.solver).condition();
  const sparse::BlockMatrix rounded =
      fixed::dequantise(fixed::quantise(result.stiffness, kThesisMatrixBits));
  result.condition_rounded =
      fem::extreme_eigenvalues(rounded, fem::DirectSolver(rounded)).condition();
  return result;
}

// One mesh's system in the words of the settings, in units of the integer product A·x.
struct Experiment {
  fixed::System system;
  sparse::BlockMatrix integers;  // the rounded matrix
  Vector b;
  Vector x_rounded;  // of the rounded system
  Vector x_true;     // of the stiffness itself, with the same b
};

Experiment make_experiment(const ThesisMesh& mesh, const fixed::Settings& settings, Load load,
                           std::uint64_t seed) {
  Experiment e;
  e.system = fixed::prepare(mesh.stiffness, settings);
  fixed::QuantisedMatrix unit = e.system.matrix;
  unit.scale = 1;
  e.integers = fixed::dequantise(unit);
  const auto size = static_cast<std::size_t>(unit.rows());
  Random random(seed);
  Vector drawn(size);
  for (double& entry : drawn) entry = random.normal();
  e.b.resize(size);
  if (load == Load::random) {
    e.x_rounded.resize(size);
    fem::DirectSolver(e.integers).solve(drawn, e.x_rounded);
  } else {
    e.x_rounded = drawn;
  }
  // The same share of the word's range for every word length.
  const double norm = std::ldexp(kThesisNorm, settings.vector_bits - kThesisVectorBits);
  const double scale = norm / std::sqrt(dot(e.x_rounded, e.x_rounded));
  for (double& entry : e.x_rounded) entry = std::round(entry * scale);
  e.integers.multiply(e.x_rounded, e.b);

  // With the matrix scaled by S on both sides the board's unknown is S⁻¹·x: what is compared is
  // S·(the words), in the same unit.
  e.x_true = e.b;
  for (std::size_t i = 0; i < size; ++i) e.x_true[i] *= e.system.matrix.scale / e.system.scale[i];
  mesh.solver->solve(e.x_true, e.x_true);
  for (std::size_t i = 0; i < size; ++i) e.x_true[i] /= e.system.scale[i];
  return e;
}

std::vector<std::int32_t> to_words(const Vector& b, const fixed::Settings& s) {
  const auto limit = static_cast<double>(fixed::word_limit(s.residual_bits()));
  std::vector<std::int32_t> words;
  for (const double entry : b) {
    const double word = std::round(std::ldexp(entry, -s.rhs_shift()));
    words.push_back(static_cast<std::int32_t>(std::clamp(word, -limit, limit)));
  }
  return words;
}

// Adds an iteration's errors to the means.
class Recorder : public fixed::Observer {
 public:
  Recorder(const Experiment& experiment, std::span<const int> wanted, double weight, Errors& errors)
      : experiment_(experiment), wanted_(wanted), weight_(weight), errors_(errors) {}

  void iteration(const fixed::IterationState& state) override {
    if (next_ == wanted_.size() || state.iteration != wanted_[next_]) return;
    add(Vector(state.x.begin(), state.x.end()));
  }
  void add(const Vector& x) {
    errors_.rounded[next_] += weight_ * relative_distance(x, experiment_.x_rounded);
    errors_.true_model[next_] += weight_ * relative_distance(x, experiment_.x_true);
    ++next_;
  }
  std::size_t recorded() const { return next_; }

 private:
  const Experiment& experiment_;
  std::span<const int> wanted_;
  double weight_;
  Errors& errors_;
  std::size_t next_ = 0;
};

Errors no_errors(std::span<const int> iterations) {
  return {.rounded = Vector(iterations.size(), 0.0),
          .true_model = Vector(iterations.size(), 0.0),
          .flags = {}};
}

// Textbook conjugate gradients.
void double_cg(const Experiment& e, bool preconditioned, std::span<const int> wanted,
               Recorder& recorder) {
  const std::size_t size = e.b.size();
  Vector inverse(size, 1.0);
  for (std::size_t i = 0; preconditioned && i < size; ++i) {
    inverse[i] = 1.0 / e.system.matrix.diagonal(static_cast<int>(i));
  }
  Vector x(size, 0.0);
  Vector r = e.b;
  Vector z(size);
  for (std::size_t i = 0; i < size; ++i) z[i] = inverse[i] * r[i];
  Vector d = z;
  Vector q(size);
  double z_r = dot(z, r);
  for (int update = 1; recorder.recorded() < wanted.size(); ++update) {
    e.integers.multiply(d, q);
    const double alpha = z_r / dot(d, q);
    for (std::size_t i = 0; i < size; ++i) x[i] += alpha * d[i];
    for (std::size_t i = 0; i < size; ++i) r[i] -= alpha * q[i];
    for (std::size_t i = 0; i < size; ++i) z[i] = inverse[i] * r[i];
    const double z_r_new = dot(z, r);
    for (std::size_t i = 0; i < size; ++i) d[i] = z[i] + z_r_new / z_r * d[i];
    z_r = z_r_new;
    if (update == wanted[recorder.recorded()]) recorder.add(x);
  }
}

std::uint64_t seed_of(std::size_t mesh) { return 101 + mesh; }

}  // namespace

std::vector<ThesisMesh> thesis_meshes() {
  using Shape = mesh::MeshSettings::Shape;
  std::vector<ThesisMesh> meshes;
  for (const Shape shape : {Shape::sphere, Shape::box}) {
    for (const int nodes : {950, 1000, 1050}) meshes.push_back(make_mesh(shape, nodes));
  }
  return meshes;
}

Errors fixed_point(std::span<const ThesisMesh> meshes, fixed::Settings settings,
                   std::span<const int> iterations, Load load) {
  settings.start = fixed::Start::zero;
  settings.iterations = iterations.back();
  Errors errors = no_errors(iterations);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Experiment e = make_experiment(meshes[m], settings, load, seed_of(m));
    const std::vector<std::int32_t> b = to_words(e.b, e.system.settings);
    std::vector<std::int32_t> x(b.size());
    Recorder recorder(e, iterations, 1.0 / static_cast<double>(meshes.size()), errors);
    const auto solver = fixed::make_solver(e.system.settings);
    errors.flags.merge(solver->solve(e.system.matrix, {.b = b, .x = x}, &recorder).flags);
    // A solve that ends early stays where it is.
    while (recorder.recorded() < iterations.size()) recorder.add(Vector(x.begin(), x.end()));
  }
  return errors;
}

Errors double_precision(std::span<const ThesisMesh> meshes, bool preconditioned,
                        std::span<const int> iterations, Load load) {
  Errors errors = no_errors(iterations);
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Experiment e = make_experiment(meshes[m], fixed::Settings{}, load, seed_of(m));
    Recorder recorder(e, iterations, 1.0 / static_cast<double>(meshes.size()), errors);
    double_cg(e, preconditioned, iterations, recorder);
  }
  return errors;
}

}  // namespace hvp::tables
