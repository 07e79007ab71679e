#include <systemc>

#include <gtest/gtest.h>

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

// AddressSanitizer asks for its options. At the end of a program it looks for leaks from a thread
// of its own and trips over the guard pages of SystemC's coroutine stacks, now and then.
#ifdef __SANITIZE_ADDRESS__
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }
#endif

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
