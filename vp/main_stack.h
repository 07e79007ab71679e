#pragma once

namespace hvp::vp {

// After sc_start(). SystemC 2.3.4 tells AddressSanitizer of its coroutines' stacks, yet not which
// one main() runs on: whatever throws after a simulation would be reported as an access beyond the
// stack of the last process. Does nothing in a build without AddressSanitizer.
void return_to_main_stack();

}  // namespace hvp::vp
