# Half of a compilation is reading the same headers of others: the standard library, Eigen,
# SystemC, GoogleTest. They are compiled once a kind, and a target takes the kind that its
# dependencies call for. The house's own headers are not among them, so that a change of one
# compiles what includes it and no more.
#
# A precompiled header fits only where the options that change code and the macros that its headers
# look at are the same: hence a kind for what is compiled with other options (tests; gcc 12 breaks
# down where only the level of optimisation differs), fmt for every target, no -fPIC for libraries
# alone, and none where a source has instructions of its own (models/fixed) or sanitizers
# (tests/fuzz). A header that misses an include is found where there is no precompiled one: in the
# preset debug, and by clang-tidy (tests/tidy/tidy.py).
set(models_headers <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <map> <memory>
  <numeric> <optional> <span> <string> <string_view> <utility> <vector> <fmt/format.h> <Eigen/Core>
  <Eigen/SparseCore>)
set(systemc_headers <systemc> <tlm> <tlm_utils/simple_initiator_socket.h>
  <tlm_utils/simple_target_socket.h>)
set(tests_headers ${models_headers} <fstream> <limits> <set> <sstream> <gmock/gmock.h> <gtest/gtest.h>)

# Headers of a kind, and what a target of that kind links.
function(hvp_precompile kind)
  cmake_parse_arguments(ARG "" "" "HEADERS;DEPENDS;OPTIONS" ${ARGN})
  set(empty ${PROJECT_BINARY_DIR}/precompiled.cpp)
  file(CONFIGURE OUTPUT ${empty} CONTENT "")
  add_library(hvp_precompiled_${kind} OBJECT ${empty})
  target_link_libraries(hvp_precompiled_${kind} PRIVATE ${ARG_DEPENDS} hvp_warnings)
  target_compile_options(hvp_precompiled_${kind} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(hvp_precompiled_${kind} PRIVATE ${ARG_HEADERS})
endfunction()

hvp_precompile(models HEADERS ${models_headers} DEPENDS Eigen3::Eigen fmt::fmt)
hvp_precompile(systemc HEADERS ${models_headers} ${systemc_headers}
  DEPENDS Eigen3::Eigen fmt::fmt hvp_systemc)
hvp_precompile(app HEADERS ${models_headers} DEPENDS Eigen3::Eigen fmt::fmt OPTIONS ${HVP_LIGHT_OPTIONS})
hvp_precompile(app_systemc HEADERS ${models_headers} <nlohmann/json.hpp> ${systemc_headers}
  DEPENDS Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json hvp_systemc OPTIONS ${HVP_LIGHT_OPTIONS})

# The kinds of the tests' own sources, once GoogleTest is found.
macro(hvp_precompile_tests)
  hvp_precompile(tests HEADERS ${tests_headers}
    DEPENDS Eigen3::Eigen fmt::fmt GTest::gtest OPTIONS ${HVP_LIGHT_OPTIONS})
  hvp_precompile(tests_systemc HEADERS ${tests_headers} ${systemc_headers}
    DEPENDS Eigen3::Eigen fmt::fmt hvp_systemc GTest::gtest OPTIONS ${HVP_LIGHT_OPTIONS})
  hvp_precompile(tests_json HEADERS ${tests_headers} <nlohmann/json.hpp>
    DEPENDS Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json GTest::gtest
    OPTIONS ${HVP_LIGHT_OPTIONS})
endmacro()

# Whether a target links another one, itself or through what it links.
function(hvp_links target other result)
  set(${result} FALSE PARENT_SCOPE)
  get_target_property(links ${target} LINK_LIBRARIES)
  if(${other} IN_LIST links)
    set(${result} TRUE PARENT_SCOPE)
    return()
  endif()
  foreach(link IN LISTS links)
    if(link MATCHES "^hvp_" AND TARGET ${link})
      get_target_property(type ${link} TYPE)
      if(NOT type STREQUAL "INTERFACE_LIBRARY")
        hvp_links(${link} ${other} found)
        if(found)
          set(${result} TRUE PARENT_SCOPE)
          return()
        endif()
      endif()
    endif()
  endforeach()
endfunction()

function(hvp_use_precompiled target kind)
  target_precompile_headers(${target} REUSE_FROM hvp_precompiled_${kind})
endfunction()
