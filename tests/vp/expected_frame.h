#pragma once

#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"

namespace hvp::test {

// From the tick to the force at the motor, step by step as in thesis Fig. 6.2. `updates`: what the
// board needs before, because the contact has moved; `contact_blocks`: of the contact's rows.
inline vp::Picoseconds latency(const SmallScene& scene, vp::Picoseconds updates = 0,
                               int contact_blocks = 0) {
  constexpr int kVectorBytes = 2 * SmallScene::kUnknowns;
  // Scaling, rounding and two comparisons a word.
  constexpr double kConversion = 4.0 * SmallScene::kUnknowns;
  const double columns = contact_blocks == 0 ? 0 : 18.0 * contact_blocks + 3;
  return pci_write(4) + 1 * kUs               // latch
         + pci_read(12)                       // position
         + 1 * kUs                            // contact lookup
         + updates                            //
         + compute(kConversion + columns)     // modified force vector, in words
         + 1 * kUs + pci_write(kVectorBytes)  // driver; b
         + pci_write(4)                       // start
         + solve_time(scene.computation.quantised().row_begin, 60)  //
         + 5 * kUs                                                  // interrupt
         + pci_read(4) + pci_write(4)                               // STATUS; INTERRUPT_STATUS
         + 1 * kUs + pci_read(kVectorBytes)                         // driver; U
         + compute(kConversion + columns)                           // force
         + pci_write(12) + 10 * kUs;                                // force to the DAQ; its output
}

}  // namespace hvp::test
