#pragma once

#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"

namespace hvp::test {

// Operations that give a contact of one node its place, `frames` after the one that met it. It is
// taken over from where it was in the frame before, within 30 ms: 17 operations and 12 a node.
inline double hand_over_operations(const SmallScene& scene, std::int64_t frames) {
  return (frames + 1) * scene.settings.period < 30 * kMs ? 17 + 12 : 0;
}

// From the tick to the force at the motor, step by step as in thesis Fig. 6.2. `updates`: what the
// board needs before, because the contact has moved; `contact_blocks`: of the contact's rows;
// `hold`: operations that give its nodes their places.
inline vp::Picoseconds latency(const SmallScene& scene, vp::Picoseconds updates = 0,
                               int contact_blocks = 0, double hold = 0) {
  constexpr int kVectorBytes = 2 * SmallScene::kUnknowns;
  // Scaling, rounding and two comparisons a word.
  constexpr double kConversion = 4.0 * SmallScene::kUnknowns;
  const double columns = contact_blocks == 0 ? 0 : 18.0 * contact_blocks + 3;
  return pci_write(4) + 1 * kUs               // latch
         + pci_read(12)                       // position
         + 1 * kUs                            // contact lookup
         + updates                            //
         + compute(hold)                      //
         + compute(kConversion + columns)     // modified force vector, in words
         + 1 * kUs + pci_write(kVectorBytes)  // driver; b
         + pci_write(4)                       // start
         + solve_time(scene.computation.board().matrix().row_begin, 60)  //
         + 5 * kUs                                                       // interrupt
         + pci_read(4) + pci_write(4)                                    // STATUS; INTERRUPT_STATUS
         + 1 * kUs + pci_read(kVectorBytes)                              // driver; U
         + compute(kConversion + columns)                                // force
         + pci_write(12) + 10 * kUs;  // force to the DAQ; its output
}

}  // namespace hvp::test
