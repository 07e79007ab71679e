# One library a room: hvp_library(fem SOURCES a.cpp b.cpp DEPENDS hvp_sparse Eigen3::Eigen)
# gives the target hvp_fem, whose headers are included as "fem/element.h" from models/
# or by their path from the top of the tree.
include(GoogleTest)

function(hvp_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(hvp_${name} STATIC ${ARG_SOURCES})
  target_include_directories(hvp_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(hvp_${name} PUBLIC ${ARG_DEPENDS} PRIVATE hvp_warnings)
endfunction()

# A test program a room. Every test case runs as a process of its own under ctest, because
# SystemC elaborates once in a process. PREFIX tells the cases of two programs apart that share
# sources.
function(hvp_test name)
  cmake_parse_arguments(ARG "" "PREFIX" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} hvp_warnings GTest::gtest GTest::gtest_main)
  gtest_discover_tests(${name} TEST_PREFIX "${ARG_PREFIX}" DISCOVERY_TIMEOUT 120
    PROPERTIES TIMEOUT 300)
endfunction()
