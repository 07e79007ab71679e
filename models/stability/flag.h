#pragma once

#include <array>
#include <cstdint>
#include <string_view>

// The signs of numerical trouble, each with a name, a meaning and a remedy that works. A run that
// raised one never prints an unqualified PASS.
namespace hvp::stability {

enum class Flag : std::uint8_t {
  saturation,           // a word reached its limit and was clamped
  negative_curvature,   // dᵀAd ≤ 0: the rounded matrix is not positive definite
  zero_diagonal,        // a diagonal entry rounds to zero
  stagnation,           // α or the residual's norm became zero before the iterations were used
  scalar_overflow,      // an inner product left its word
  divergence,           // the residual at the end is larger than the right-hand side
  matrix_rounding,      // the rounding of the matrix moves the solution beyond the stated bound
  not_converged,        // the solver's own error is beyond the stated bound
  range_exceeded,       // a displacement or force does not fit the stated range
  locking,              // Poisson's ratio at which linear tetrahedra are too stiff
  poor_elements,        // slivers in the mesh
  solver_timeout,       // the board did not answer in time
  wrapped,              // a word lost its high bits: overflow = "wrap"
  force_step,           // the force jumps from one frame to the next
  force_ringing,        // the force turns back and forth from frame to frame
  limit_cycle,          // the force keeps moving while the tip rests
  beyond_linearity,     // strains for which linear elasticity is not valid
  force_clamped,        // a force does not fit the device's register
  contact_missed,       // the tip was in the body without a contact
  active_port,          // the loop fed energy into the device
  force_saturated,      // a force was beyond the limit of converter, amplifier or maker
  device_at_its_limit,  // the device could not go to, or be read at, its place
  low_gain_margin,      // the contact is too stiff for the loop's delay
  inverted_element,     // an element of a body that is not linear was turned inside out
  unstable_step,        // an explicit time step was longer than the body's present limit
  matrix_word_beyond_scale,  // a renewed matrix did not fit the words at the scale of the first
  bus_error,                 // what went between host and board was lost or damaged
  board_error,               // the board refused a command, or failed
  no_start,                  // a frame had no forces with its contact in place
  energy_overflow,           // an element's energy was beyond what its law is defined for
  proxy_at_rim,              // a proxy stood where its force is not that of a smooth surface
  contact_doubtful,          // a proxy's force is not what friction and coupling would have it
  count
};

struct Description {
  std::string_view name;     // as in summary.json
  std::string_view meaning;  // one sentence
  std::string_view remedy;   // the change that helps
};

const Description& describe(Flag flag);

// A set of flags that fits a register.
class Flags {
 public:
  constexpr Flags() = default;
  constexpr explicit Flags(std::uint32_t bits) : bits_(bits) {}
  constexpr void raise(Flag flag) { bits_ |= bit(flag); }
  constexpr void merge(Flags other) { bits_ |= other.bits_; }
  constexpr Flags without(Flag flag) const { return Flags(bits_ & ~bit(flag)); }
  constexpr bool has(Flag flag) const { return (bits_ & bit(flag)) != 0; }
  constexpr bool empty() const { return bits_ == 0; }
  constexpr std::uint32_t bits() const { return bits_; }
  friend constexpr bool operator==(Flags, Flags) = default;

 private:
  static constexpr std::uint32_t bit(Flag flag) {
    return std::uint32_t{1} << static_cast<unsigned>(flag);
  }
  std::uint32_t bits_ = 0;
};

}  // namespace hvp::stability
