#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "models/fem/hold.h"
#include "models/host/solve_work.h"
#include "models/stability/flag.h"

namespace hvp::host {

// The solver of the frame's system. The scenario's key host.solver.
enum class SolvedBy {
  board,          // the FPGA, in fixed point
  cg,             // the host, conjugate gradients
  cholesky,       // the host, with factors of A that were made before the first frame
  inverse,        // the host, with A's inverse
  superposition,  // the host, with the columns of A's inverse of all that can be touched
  condensed,      // the host, with A's inverse at what can be touched, and factors of the rest
  steps,          // nobody: the host moves the body by explicit time steps
};

// The numbers of the host's own solve.
enum class Precision { double_precision, single_precision };

const char* name(Precision precision);

// True of a host's solve that errs by rounding to double precision alone.
bool is_exact(SolvedBy solver, Precision precision);

// Who solves a frame's system.
struct SolverChoice {
  SolvedBy by = SolvedBy::board;
  Precision precision = Precision::double_precision;
  // The nodes that contact can load or move, ascending; empty: all.
  std::vector<int> touchable;
  // Whether other nodes' loads change too: with inertia, and where the body is not linear.
  bool all_loads_change = true;

  // NOLINTNEXTLINE(google-explicit-constructor): most callers choose nothing else.
  SolverChoice(SolvedBy solver = SolvedBy::board) : by(solver) {}
  SolverChoice(SolvedBy solver, Precision numbers, std::vector<int> nodes, bool all_change = true)
      : by(solver), precision(numbers), touchable(std::move(nodes)), all_loads_change(all_change) {}
};

const char* name(SolvedBy solver);

// A step of every frame, with its cost without contact: `hvp explain` shows it, and remedies count
// with it.
struct Step {
  enum class Where {
    host,    // its operations, at the host's rate
    solver,  // its work, at what host.model says of the host's own solve
    core,    // its work, on a core whoever solves
    board,   // b goes there, the board solves, U comes back
  };
  std::string what;
  Where where = Where::host;
  double operations = 0;
  int times = 1;
  bool after_force = false;
  // Of a step at the solver.
  SolveWork work = {};
  SolveMemory memory = {};
};

// The way in which a frame's system A·u = f with prescribed displacements is solved: by the board
// in one pass or in several, or by the host. All of them follow one protocol:
//
//   set_contact(nodes);                       // when the contact has moved
//   begin(f, hold);
//   while (next(b)) { …the board solves…  accept(x, flags); }
//   …the force goes out…
//   go_on(f);  while (next(b)) {…}            // where contact is a load that is known by now
//   finish();                                 // or abandon(), where the board failed
//
// Vectors are over A's rows, in m and N. Nothing allocates after construction but set_contact.
class FrameMethod {
 public:
  virtual ~FrameMethod() = default;

  // Sets the contact nodes from now on, ascending.
  virtual void set_contact(std::span<const int> /*nodes*/) {}
  // The storage of `f` and `hold` must stay valid until finish().
  virtual void begin(std::span<const double> f, const fem::Hold& hold) = 0;
  // Says that go_on() follows in every frame: passes are then divided between the two solves, at
  // least one each.
  virtual void expect_to_go_on() {}
  // Goes on from the solution so far with another load, which moves no node by much more than
  // `way`, m; nothing is prescribed. The same storage.
  virtual void go_on(std::span<const double> f, double way) = 0;
  // Writes the board's next right-hand side in words. False where the solution is complete.
  virtual bool next(std::span<std::int32_t> b) = 0;
  // Takes the board's solution; `flags` are those of that solve.
  virtual void accept(std::span<const std::int32_t> x, stability::Flags flags) = 0;
  virtual void finish() {}
  // Replaces finish() where the solve has failed: the last solution stays.
  virtual void abandon() {}
  // Takes the values of A anew, which have changed in their place, after finish(). False where a
  // solver on the host has no use for them: it goes on with the last ones. Allocates.
  virtual bool renew() { return true; }

  // The displacement, m.
  virtual std::span<const double> displacement() const = 0;
  // The flags of this frame so far.
  virtual stability::Flags flags() const { return {}; }
  // The words and displacements that were clamped since begin().
  virtual std::int64_t clamped() const { return 0; }

  // The host's additions, multiplications, comparisons and conversions: since the last next(), that
  // call included; before the force; and after it.
  virtual double next_operations() const = 0;
  virtual double force_operations() const { return 0; }
  virtual double finish_operations() const { return 0; }
  // The work of the host's own solves: in the last next(); of the last set_contact(); after the
  // force; before the first frame.
  virtual SolveWork solve_work() const { return {}; }
  virtual SolveWork contact_work() const { return {}; }
  virtual SolveWork rest_work() const { return {}; }
  virtual SolveWork set_up_work() const { return {}; }
  // What the last renew() took of it.
  virtual SolveWork renew_work() const { return {}; }
  // Those of the frame so far for which the solver was asked: none where nothing presses a body at
  // rest.
  virtual int passes_made() const { return 1; }
  virtual SolveMemory memory() const { return {}; }

  virtual std::vector<Step> steps() const = 0;
  // The same of a second solve, by go_on(), and of finish() after it. All of them are after the
  // force.
  virtual std::vector<Step> further_steps() const { return after_force(steps()); }

 protected:
  static std::vector<Step> after_force(std::vector<Step> steps) {
    for (Step& step : steps) step.after_force = true;
    return steps;
  }
};

}  // namespace hvp::host
