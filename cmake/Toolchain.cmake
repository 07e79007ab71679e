# Language level, warnings and the floating-point rules that keep results identical
# in every build type and with every compiler.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_C_STANDARD 11)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# The third level takes half as long again to compile and makes a run no faster; the kernels of
# models/fixed are the exception and ask for it themselves.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
set(CMAKE_C_FLAGS_RELEASE "-O2 -DNDEBUG")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  # With a precompiled header ccache sees neither the macros nor the __TIME__ of the headers inside,
  # and caches only if it is told not to mind. The house uses no __TIME__, and the macros stand on
  # the command line. The compilers have to name the header in what they preprocess, and to leave
  # the time out of it (ccache's manual, "Precompiled headers").
  set(CMAKE_C_COMPILER_LAUNCHER env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_C_COMPILER_LAUNCHER})
  add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>"
    "$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
endif()

# A contracted multiply-add rounds once where two operations round twice: the bits would
# depend on the compiler. The baseline is plain x86-64 for the same reason.
add_compile_options(-ffp-contract=off)

add_library(hvp_warnings INTERFACE)
target_compile_options(hvp_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Wformat=2 -Wundef -Werror
  $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor -Woverloaded-virtual -Wold-style-cast>
  # gcc 12 reports accesses inside Eigen and the standard library that cannot happen
  # (GCC bugs 105329, 105651 and their like).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow
    -Wno-stringop-overread -Wno-restrict>)

set(HVP_SANITIZE "" CACHE STRING "Sanitizers to build with, for example address,undefined")
if(HVP_SANITIZE)
  add_compile_options(-fsanitize=${HVP_SANITIZE} -fno-omit-frame-pointer
    -fno-sanitize-recover=undefined)
  add_link_options(-fsanitize=${HVP_SANITIZE})
  # Beneath AddressSanitizer Eigen aligns memory by itself, and Debian's Ceres, which is compiled
  # without, frees what this code allocated. The sanitizer's malloc is aligned to 16 bytes too.
  add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()
