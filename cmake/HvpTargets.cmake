# One library a room: hvp_library(fem SOURCES a.cpp b.cpp DEPENDS hvp_sparse Eigen3::Eigen)
# gives the target hvp_fem, whose headers are included as "fem/element.h" from models/
# or by their path from the top of the tree.
include(GoogleTest)
include(PrecompiledHeaders)

function(hvp_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(hvp_${name} STATIC ${ARG_SOURCES})
  target_include_directories(hvp_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(hvp_${name} PUBLIC ${ARG_DEPENDS} fmt::fmt PRIVATE hvp_warnings)
  hvp_links(hvp_${name} hvp_systemc with_systemc)
  if(with_systemc)
    hvp_use_precompiled(hvp_${name} systemc)
  else()
    hvp_use_precompiled(hvp_${name} models)
  endif()
endfunction()

# What a test computes itself is little beside what it takes to optimise it.
set(HVP_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)

# A test program a room. Every test case runs as a process of its own under ctest, because
# SystemC elaborates once in a process. PREFIX tells the cases of two programs apart that share
# sources.
function(hvp_test name)
  cmake_parse_arguments(ARG "" "PREFIX" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(${name} PRIVATE ${HVP_TEST_OPTIONS})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} fmt::fmt hvp_warnings GTest::gtest GTest::gtest_main)
  hvp_links(${name} hvp_systemc with_systemc)
  if(with_systemc)
    hvp_use_precompiled(${name} tests_systemc)
  elseif(nlohmann_json::nlohmann_json IN_LIST ARG_DEPENDS)
    hvp_use_precompiled(${name} tests_json)
  else()
    hvp_use_precompiled(${name} tests)
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${ARG_PREFIX}" DISCOVERY_TIMEOUT 120
    PROPERTIES TIMEOUT 300)
endfunction()
