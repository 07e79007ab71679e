#include <systemc>

#include <gtest/gtest.h>

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
