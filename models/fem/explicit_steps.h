#pragma once

#include <span>

namespace hvp::fem {

// What a frame of explicit time integration met.
struct StepsFound {
  int inverted = 0;         // the most elements turned inside out
  int overflown = 0;        // elements whose energy was beyond their law's bound
  bool complete = true;     // false: a substep led where elements have no forces, and ended it
  bool over_limit = false;  // the substep was above the limit that the body had by the end, or
                            // threw the body apart and was not done
  double operations = 0;    // additions, multiplications, divisions and roots
};

// A tissue that makes its time step itself: no system is solved.
class ExplicitSteps {
 public:
  virtual ~ExplicitSteps() = default;

  // Moves the body by one frame, with what Tissue::hold() was told last.
  virtual StepsFound step() = 0;
  virtual std::span<const double> displacement() const = 0;  // m, active nodes

  virtual int substeps() const = 0;  // a frame
  virtual double substep_s() const = 0;
  // The longest stable substep at rest, and the least that any frame had so far, s.
  virtual double limit_at_rest_s() const = 0;
  virtual double least_limit_s() const = 0;
  // Of a frame at rest without contact.
  virtual double step_operations() const = 0;
};

}  // namespace hvp::fem
