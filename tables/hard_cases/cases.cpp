#include "tables/hard_cases/cases.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "models/fem/locking.h"
#include "models/mesh/quality.h"
#include "tables/hard_cases/bodies.h"
#include "tables/random.h"

namespace hvp::tables {

namespace {

using Eigen::Vector3d;
using fixed::Plan;
using stability::Flag;

constexpr int kNodes = 500;
constexpr double kHeld = 0.15;  // of the nodes, the lowest
constexpr double kRadius = 0.05;
const Vector3d kTop(0, 0, kRadius);
const Vector3d kPress(0, 0, -0.1 * kRadius);

stability::Flags flags_of_model(const mesh::TetMesh& mesh, double poisson_ratio) {
  stability::Flags flags;
  if (mesh::measure(mesh).slivers > 0) flags.raise(Flag::poor_elements);
  if (poisson_ratio > fem::kLockingPoissonRatio) flags.raise(Flag::locking);
  return flags;
}

// The sphere's lowest nodes are held and its top is pressed down by a tenth of its radius.
Problem pressed(const Body& body) {
  return {.matrix = body.stiffness,
          .load = std::vector<double>(3 * body.free_nodes.size(), 0.0),
          .contact = {body.nearest(kTop)},
          .displacement = kPress};
}

Body sphere_body(const Solid& solid = {}) {
  const mesh::TetMesh& mesh = sphere(kNodes);
  return make_body(mesh, solid, lowest_nodes(mesh, kHeld));
}

std::unique_ptr<CaseScene> pressed_scene(const Body& body, double poisson_ratio) {
  auto result = make_scene(pressed(body));
  result->model = flags_of_model(body.mesh, poisson_ratio);
  return result;
}

Case of_solid(std::string name, std::string expected, Ending ending, std::optional<Flag> flag,
              const Solid& solid) {
  return {.name = std::move(name),
          .expected = std::move(expected),
          .ending = ending,
          .flag = flag,
          .plan = first_plan(),
          .make = [solid] { return pressed_scene(sphere_body(solid), solid.poisson_ratio); }};
}

Group poisson_ratios() {
  const auto ratio = [](double nu, std::string expected, Flag flag) {
    return of_solid(fmt::format("ν = {}", nu), std::move(expected), Ending::remedied, flag,
                    {.poisson_ratio = nu});
  };
  return {"Poisson's ratio",
          {ratio(0.3, "the rounding of K shows, a few per cent", Flag::matrix_rounding),
           ratio(0.45, "8 % from the true model", Flag::matrix_rounding),
           ratio(0.49, "80 iterations too few", Flag::not_converged),
           ratio(0.499, "the rounded matrix is indefinite", Flag::negative_curvature),
           ratio(0.4999, "the rounded matrix is indefinite", Flag::negative_curvature)}};
}

// The half above the equator is `contrast` times as stiff as the half that is held.
Case stiff_on_soft(double contrast, std::string expected, Ending ending, Flag flag) {
  Solid solid{.poisson_ratio = 0.3};
  solid.contrast = [contrast](const Vector3d& p) { return p.z() > 0 ? contrast : 1.0; };
  return of_solid(fmt::format("stiff on soft, {:.0f}", contrast), std::move(expected), ending, flag,
                  solid);
}

Case soft_on_stiff(double contrast, std::string expected, Flag flag) {
  Solid solid{.poisson_ratio = 0.3};
  solid.contrast = [contrast](const Vector3d& p) { return p.z() > 0 ? 1.0 : contrast; };
  return of_solid(fmt::format("soft on stiff, {:.0f}", contrast), std::move(expected),
                  Ending::remedied, flag, solid);
}

Group contrasts() {
  return {
      "Contrast of Young's moduli",
      {stiff_on_soft(1, "a body of one stiffness", Ending::remedied, Flag::matrix_rounding),
       stiff_on_soft(10, "the soft half has seven bits", Ending::remedied, Flag::matrix_rounding),
       stiff_on_soft(100, "the soft half has four bits: indefinite", Ending::remedied,
                     Flag::negative_curvature),
       stiff_on_soft(1e3, "diagonals round to zero", Ending::remedied, Flag::zero_diagonal),
       stiff_on_soft(1e4, "diagonals round to zero", Ending::remedied, Flag::zero_diagonal),
       stiff_on_soft(1e5, "diagonals round to zero", Ending::remedied, Flag::zero_diagonal),
       stiff_on_soft(1e6, "a rigid body on a cushion: beyond 24 bits", Ending::hopeless,
                     Flag::zero_diagonal),
       soft_on_stiff(1e3, "diagonals round to zero, scaling brings them back", Flag::zero_diagonal),
       soft_on_stiff(1e6, "diagonals round to zero, scaling brings them back",
                     Flag::zero_diagonal)}};
}

// `depth` is that of the press, and its range, in parts of the usual one.
Case of_mesh(std::string name, std::string expected, Flag flag,
             std::function<mesh::TetMesh()> make_mesh, double depth = 1) {
  Plan plan = first_plan();
  plan.settings.displacement_range *= depth;
  return {.name = std::move(name),
          .expected = std::move(expected),
          .ending = Ending::remedied,
          .flag = flag,
          .plan = plan,
          .make = [make_mesh = std::move(make_mesh), depth] {
            const mesh::TetMesh mesh = make_mesh();
            const Solid solid;
            Problem problem = pressed(make_body(mesh, solid, lowest_nodes(mesh, kHeld)));
            problem.displacement *= depth;
            auto result = make_scene(std::move(problem));
            result->model = flags_of_model(mesh, solid.poisson_ratio);
            return result;
          }};
}

Group meshes() {
  const auto slivers = [](double angle, std::string expected, Flag flag) {
    return of_mesh(fmt::format("five slivers, {}°", angle), std::move(expected), flag,
                   [angle] { return with_slivers(sphere(kNodes), 5, angle); });
  };
  constexpr double kFlat = 0.03;
  return {"Meshes",
          {slivers(0.5, "they take the scale: indefinite", Flag::negative_curvature),
           slivers(0.05, "they take the scale: indefinite", Flag::negative_curvature),
           slivers(0.005, "diagonals round to zero", Flag::zero_diagonal),
           of_mesh(
               "squashed, z × 0.03", "all alike: only the rounding of K shows",
               Flag::matrix_rounding, [] { return squashed(sphere(kNodes), kFlat); }, kFlat)}};
}

Case five_anchors() {
  return {.name = "five anchored nodes",
          .expected = "κ of 2e5: far from the true model",
          .ending = Ending::remedied,
          .flag = Flag::not_converged,
          .plan = first_plan(),
          .make = [] {
            const mesh::TetMesh& mesh = sphere(kNodes);
            std::vector<int> five = lowest_nodes(mesh, 0.01);
            five.resize(5);
            return pressed_scene(make_body(mesh, {}, five), 0.45);
          }};
}

Case beside_an_anchor() {
  return {.name = "contact node next to an anchor",
          .expected = "a local dent: 80 iterations too few",
          .ending = Ending::remedied,
          .flag = Flag::not_converged,
          .plan = first_plan(),
          .make = [] {
            const mesh::TetMesh& mesh = sphere(kNodes);
            const std::vector<int> held = lowest_nodes(mesh, kHeld);
            const auto is_held = [&held](int n) {
              return std::binary_search(held.begin(), held.end(), n);
            };
            const Body body = make_body(mesh, {}, held);
            Problem problem = pressed(body);
            // The first free node on the boundary that shares a triangle with a held one.
            const auto beside = std::ranges::find_if(mesh.boundary, [&](const auto& t) {
              return is_held(t[0]) && is_held(t[1]) && !is_held(t[2]);
            });
            const Vector3d& place = mesh.nodes[static_cast<std::size_t>((*beside)[2])];
            problem.contact = {body.nearest(place)};
            problem.displacement = -0.02 * place;
            auto result = make_scene(std::move(problem));
            result->model = flags_of_model(mesh, 0.45);
            return result;
          }};
}

Case diagonal(std::string name, std::string expected, bool of_largest, Flag flag) {
  return {.name = std::move(name),
          .expected = std::move(expected),
          .ending = Ending::remedied,
          .flag = flag,
          .plan = first_plan(),
          .make = [of_largest] {
            const Body body = sphere_body();
            Problem problem = pressed(body);
            double sum = 0;
            double largest = 0;
            for (int i = 0; i < problem.matrix.block_rows(); ++i) {
              const double* block =
                  problem.matrix.block(static_cast<std::size_t>(problem.matrix.find(i, i)));
              for (int e = 0; e < 9; e += 4) {
                sum += block[e];
                largest = std::max(largest, block[e]);
              }
            }
            const double mean = sum / problem.matrix.rows();
            problem.diagonal = 30 * (of_largest ? largest / mean : 1.0);
            return make_scene(std::move(problem));
          }};
}

Group constraints() {
  return {
      "Anchors and contact",
      {five_anchors(), beside_an_anchor(),
       diagonal("constraint's diagonal 30 × the mean",
                "it takes three bits of the matrix: indefinite", false, Flag::negative_curvature),
       diagonal("constraint's diagonal 30 × the largest",
                "it takes five bits of the matrix: indefinite", true, Flag::negative_curvature)}};
}

std::shared_ptr<const fem::Body> moving_body() {
  const mesh::TetMesh& mesh = sphere(kNodes);
  return std::make_shared<const fem::Body>(mesh, fem::Material{}, lowest_nodes(mesh, kHeld),
                                           fem::AnchorTreatment::removed);
}

// Half of the frames with 10 cm/s, a tenth of the radius at most.
Vector3d at_hand_speed(double time_step_s) {
  constexpr double kSpeed = 0.1;  // m/s
  return kPress * std::min(1.0, kSpeed * 15 * time_step_s / kPress.norm());
}

// A trajectory of 30 frames, in contact for the first half; every frame starts from the last one.
Case motion(std::string name, std::string expected, Ending ending, std::optional<Flag> flag,
            double time_step_s, bool (*touches)(int), const fem::Dynamics& dynamics = {}) {
  Plan plan = first_plan();
  plan.settings.start = fixed::Start::warm;
  return {.name = std::move(name),
          .expected = std::move(expected),
          .ending = ending,
          .flag = flag,
          .plan = plan,
          .make = [time_step_s, touches, dynamics] {
            Motion motion{.body = moving_body(),
                          .dynamics = dynamics,
                          .time_step_s = time_step_s,
                          .displacement = at_hand_speed(time_step_s),
                          .touches = touches};
            const std::vector<int>& nodes = motion.body->node_of_active();
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i < nodes.size(); ++i) {
              const double distance =
                  (motion.body->mesh().nodes[static_cast<std::size_t>(nodes[i])] - kTop).norm();
              if (distance >= least) continue;
              least = distance;
              motion.contact = static_cast<int>(i);
            }
            return make_scene(std::move(motion));
          }};
}

bool in_the_first_half(int frame) { return frame <= 15; }
bool in_every_other_frame(int frame) { return frame % 2 == 1; }

Group motions() {
  const auto step = [](std::string dt, double seconds, std::string expected, Flag flag) {
    return motion("Δt = " + std::move(dt), std::move(expected), Ending::remedied, flag, seconds,
                  in_the_first_half);
  };
  // Prescribing every other frame's place feeds energy into the average-acceleration rule; this
  // one takes it out of the highest modes at once.
  fem::Dynamics dissipative;
  dissipative.newmark_gamma = 1.5;
  dissipative.newmark_beta = 2;
  return {
      "Newmark steps, a trajectory of 30 frames",
      {step("1 µs", 1e-6, "a range far above displacements of 1.5 µm", Flag::not_converged),
       step("100 µs", 1e-4, "masses alone, whose rounding moves the body", Flag::matrix_rounding),
       step("2 ms", 2e-3, "the rounding of Â and of u", Flag::not_converged),
       step("100 ms", 0.1, "nearly static", Flag::matrix_rounding),
       step("10 s", 10, "static in every frame", Flag::matrix_rounding),
       motion("2 ms, contact made and broken every frame", "as with the other steps",
              Ending::remedied, Flag::not_converged, 2e-3, in_every_other_frame, dissipative)}};
}

// A force on the top node in place of the contact.
Case load(std::string name, std::string expected, Ending ending, std::optional<Flag> flag,
          double newtons) {
  return {.name = std::move(name),
          .expected = std::move(expected),
          .ending = ending,
          .flag = flag,
          .plan = first_plan(),
          .make = [newtons] {
            const Body body = sphere_body({.poisson_ratio = 0.3});
            Problem problem = pressed(body);
            problem.load[static_cast<std::size_t>(3 * problem.contact.front() + 2)] = -newtons;
            problem.contact.clear();
            return make_scene(std::move(problem));
          }};
}

Group loads() {
  return {"Right-hand sides",
          {load("zero", "zero", Ending::converges, std::nullopt, 0),
           load("denormal, 4.9e-324 N", "zero, right below the least normal number",
                Ending::converges, std::nullopt, std::numeric_limits<double>::denorm_min()),
           load("1e-9 N", "rounds to nothing in the range's unit", Ending::remedied,
                Flag::not_converged, 1e-9),
           load("1e300 N", "beyond every word", Ending::remedied, Flag::range_exceeded, 1e300),
           load("NaN", "refused: no setting of the board helps", Ending::refused, std::nullopt,
                std::numeric_limits<double>::quiet_NaN()),
           load("infinite", "refused: no setting of the board helps", Ending::refused, std::nullopt,
                std::numeric_limits<double>::infinity())}};
}

Case with_settings(std::string name, std::string expected, Flag flag,
                   const std::function<void(fixed::Settings&)>& change, double poisson_ratio) {
  Case result = of_solid(std::move(name), std::move(expected), Ending::remedied, flag,
                         {.poisson_ratio = poisson_ratio});
  change(result.plan.settings);
  return result;
}

// A load on every node fills all words of r alike: 30 bits each, 60 their squares.
Case overflowing_scalars() {
  Case result;
  result.name = "plain CG, 32-bit vectors, 64-bit scalars";
  result.expected = "the squares of full words overflow";
  result.ending = Ending::remedied;
  result.flag = Flag::scalar_overflow;
  result.plan = first_plan();
  result.plan.settings.method = fixed::Method::cg;
  result.plan.settings.vector_bits = 32;
  result.make = [] {
    Problem problem = pressed(sphere_body({.poisson_ratio = 0.3}));
    problem.contact.clear();
    Random random(1);
    for (double& entry : problem.load) entry = 1e-3 * (random.symmetric() > 0 ? 1 : -1);
    return make_scene(std::move(problem));
  };
  return result;
}

Group settings() {
  using fixed::Method;
  using fixed::Settings;
  return {"Settings",
          {with_settings(
               "8-bit matrix", "indefinite only after rounding", Flag::negative_curvature,
               [](Settings& s) { s.matrix_bits = 8; }, 0.45),
           with_settings(
               "plain CG, ν = 0.49", "words of b and x too short", Flag::not_converged,
               [](Settings& s) { s.method = Method::cg; }, 0.49),
           with_settings(
               "plain CG, m = 7", "b does not fit", Flag::range_exceeded,
               [](Settings& s) {
                 s.method = Method::cg;
                 s.static_shift = 7;
               },
               0.3),
           with_settings(
               "range of 1 mm for 5 mm, words wrap", "high bits lost", Flag::wrapped,
               [](Settings& s) {
                 s.displacement_range = 1e-3;
                 s.overflow = fixed::Overflow::wrap;
               },
               0.3),
           with_settings(
               "range of 1 mm for 5 mm", "x does not fit", Flag::saturation,
               [](Settings& s) { s.displacement_range = 1e-3; }, 0.3),
           with_settings(
               "range of 1 km", "x rounds to nothing", Flag::not_converged,
               [](Settings& s) { s.displacement_range = 1e3; }, 0.3),
           with_settings(
               "no dynamic scaling, 12-bit vectors", "r runs out of bits", Flag::not_converged,
               [](Settings& s) {
                 s.dynamic_scaling = false;
                 s.vector_bits = 12;
               },
               0.3),
           overflowing_scalars(),
           with_settings(
               "α in 8 bits with 4 behind the point", "α rounds to zero", Flag::stagnation,
               [](Settings& s) {
                 s.method = Method::cg;
                 s.coefficient_format = fixed::CoefficientFormat::fixed;
                 s.coefficient_bits = 8;
                 s.alpha_fraction_bits = 4;
               },
               0.3),
           with_settings(
               "pipelined CG", "the recurrences lose their digits", Flag::not_converged,
               [](Settings& s) { s.method = Method::pipelined_cg; }, 0.3)}};
}

Case refused(std::string name, std::string expected, std::function<void()> make) {
  return {.name = std::move(name),
          .expected = std::move(expected),
          .ending = Ending::refused,
          .flag = std::nullopt,
          .plan = first_plan(),
          .make = [make = std::move(make)]() -> std::unique_ptr<CaseScene> {
            make();
            return make_scene(pressed(sphere_body()));
          }};
}

void build(const mesh::TetMesh& mesh, const std::vector<int>& held) {
  const fem::Body body(mesh, fem::Material{}, held, fem::AnchorTreatment::removed);
}

Group bodies() {
  return {"Bodies that are no model",
          {refused("an inverted tetrahedron", "refused: no setting of the board helps",
                   [] {
                     mesh::TetMesh mesh = sphere(kNodes);
                     std::swap(mesh.tetrahedra[0][0], mesh.tetrahedra[0][1]);
                     build(mesh, lowest_nodes(mesh, kHeld));
                   }),
           refused("a tetrahedron without volume", "refused: no setting of the board helps",
                   [] {
                     mesh::TetMesh mesh = sphere(kNodes);
                     const auto& t = mesh.tetrahedra[0];
                     mesh.nodes[static_cast<std::size_t>(t[0])] =
                         (mesh.nodes[static_cast<std::size_t>(t[1])] +
                          mesh.nodes[static_cast<std::size_t>(t[2])]) /
                         2;
                     build(mesh, lowest_nodes(mesh, kHeld));
                   }),
           refused("no anchor", "refused: K is singular, more anchors",
                   [] { build(sphere(kNodes), {}); }),
           refused("one anchored node", "refused: three rotations are left, more anchors",
                   [] { build(sphere(kNodes), {0}); })}};
}

}  // namespace

fixed::Plan first_plan() {
  Plan plan;
  plan.settings.method = fixed::Method::jacobi_pcg;
  plan.settings.iterations = 80;
  plan.settings.start = fixed::Start::zero;
  return plan;
}

std::vector<Group> hard_cases() {
  return {poisson_ratios(), contrasts(), meshes(),   constraints(),
          motions(),        loads(),     settings(), bodies()};
}

}  // namespace hvp::tables
