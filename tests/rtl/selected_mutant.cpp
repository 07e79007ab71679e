// Called by the translated mutants (mutation.py): which of them there is; 0 is none.
#include <cstdlib>

extern "C" int hvp_selected_mutant() {
  static const int number = [] {
    const char* const wanted = std::getenv("HVP_MUTANT");
    return wanted == nullptr ? 0 : std::atoi(wanted);
  }();
  return number;
}
