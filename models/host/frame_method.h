#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "models/fem/hold.h"
#include "models/stability/flag.h"

namespace hvp::host {

// A step that every frame runs, priced without contact: what `hvp explain` shows and remedies count
// with.
struct Step {
  enum class Where {
    host,    // its operations, at the host's rate
    solver,  // likewise, at the rate of host.solver_rate
    board,   // b goes there, the board solves, U comes back
  };
  std::string what;
  Where where = Where::host;
  double operations = 0;
  int times = 1;
  bool after_force = false;
};

// How a frame's system A·u = f with held nodes is solved: by the board in one pass or in several,
// or by the host. One protocol for all of them:
//
//   set_contact(nodes);                       // when the contact has moved
//   begin(f, hold);
//   while (next(b)) { …the board solves…  accept(x, flags); }
//   …the force goes out…
//   finish();                                 // or abandon(), where the board failed
//
// Vectors are over A's rows, in m and N. Nothing allocates after construction but set_contact.
class FrameMethod {
 public:
  virtual ~FrameMethod() = default;

  // The nodes that are held from now on, ascending.
  virtual void set_contact(std::span<const int> /*nodes*/) {}
  // `f` and `hold` stay where they are until finish().
  virtual void begin(std::span<const double> f, const fem::Hold& hold) = 0;
  // Puts what the board is to solve next into words. False where the solution is there.
  virtual bool next(std::span<std::int32_t> b) = 0;
  // Takes the board's solution; `flags` are those of its solve.
  virtual void accept(std::span<const std::int32_t> x, stability::Flags flags) = 0;
  virtual void finish() {}
  // Instead of finish(): the solve has failed, the last solution stands.
  virtual void abandon() {}

  // m.
  virtual std::span<const double> displacement() const = 0;
  // Of this frame, as far as it has come.
  virtual stability::Flags flags() const { return {}; }
  // Words and displacements that did not fit and were clamped, since begin().
  virtual std::int64_t clamped() const { return 0; }

  // Additions, multiplications, comparisons and conversions of the host: since the last next(),
  // that one included; before the force and after it.
  virtual double next_operations() const = 0;
  virtual double force_operations() const { return 0; }
  virtual double finish_operations() const { return 0; }

  virtual std::vector<Step> steps() const = 0;
};

}  // namespace hvp::host
