#include "vp/main_stack.h"

#ifdef __SANITIZE_ADDRESS__

#include <cstddef>

#include <pthread.h>
#include <sanitizer/common_interface_defs.h>

namespace hvp::vp {

namespace {

struct Stack {
  void* bottom = nullptr;
  std::size_t size = 0;
};

// glibc reads /proc/self/maps for this.
Stack of_this_thread() {
  Stack stack;
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return stack;
  pthread_attr_getstack(&attributes, &stack.bottom, &stack.size);
  pthread_attr_destroy(&attributes);
  return stack;
}

}  // namespace

void return_to_main_stack() {
  // SystemC and its main belong to one thread.
  static const Stack kStack = of_this_thread();
  if (kStack.bottom == nullptr) return;
  void* fake_stack = nullptr;
  __sanitizer_start_switch_fiber(&fake_stack, kStack.bottom, kStack.size);
  __sanitizer_finish_switch_fiber(fake_stack, nullptr, nullptr);
}

}  // namespace hvp::vp

#else

namespace hvp::vp {
void return_to_main_stack() {}
}  // namespace hvp::vp

#endif
