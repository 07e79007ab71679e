#pragma once

namespace hvp::vp {

// To be called after sc_start(). SystemC 2.3.4 tells AddressSanitizer the stacks of its coroutines
// but not that of main(), so that an exception after a simulation would be reported as an access
// beyond the last process' stack. Does nothing in a build without AddressSanitizer.
void return_to_main_stack();

}  // namespace hvp::vp
