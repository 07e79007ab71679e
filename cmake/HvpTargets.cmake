# One library a room: hvp_library(fem SOURCES a.cpp b.cpp DEPENDS hvp_sparse Eigen3::Eigen)
# gives the target hvp_fem, whose headers are included as "fem/assembly.h" from models/
# or by their path from the top of the tree.
include(GoogleTest)

# What app/ and the tests compute themselves is little beside what it takes to optimise it.
set(HVP_LIGHT_OPTIONS $<$<CONFIG:Release>:-O1>)
include(PrecompiledHeaders)

function(hvp_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(hvp_${name} STATIC ${ARG_SOURCES})
  target_include_directories(hvp_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(hvp_${name} PUBLIC ${ARG_DEPENDS} fmt::fmt PRIVATE hvp_warnings)
  hvp_room(hvp_${name})
endfunction()

# The options and the precompiled headers of the room that a target stands in.
function(hvp_room target)
  hvp_links(${target} hvp_systemc with_systemc)
  if(CMAKE_CURRENT_SOURCE_DIR MATCHES "^${PROJECT_SOURCE_DIR}/app")
    target_compile_options(${target} PRIVATE ${HVP_LIGHT_OPTIONS})
    if(with_systemc)
      hvp_use_precompiled(${target} app_systemc)
    else()
      hvp_use_precompiled(${target} app)
    endif()
  elseif(with_systemc)
    hvp_use_precompiled(${target} systemc)
  else()
    hvp_use_precompiled(${target} models)
  endif()
endfunction()

# A test program a room. Under ctest it is one process, which starts once for all its cases. Where
# SystemC is linked every case is a process of its own, because SystemC elaborates once in a
# process; and where cases run the program, so that they run side by side. PREFIX tells the cases of
# two programs apart that share sources.
function(hvp_test name)
  cmake_parse_arguments(ARG "" "PREFIX" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_compile_options(${name} PRIVATE ${HVP_LIGHT_OPTIONS})
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} fmt::fmt hvp_warnings GTest::gtest GTest::gtest_main)
  # What replaces operator new must not be inlined into a test.
  foreach(source IN LISTS ARG_SOURCES)
    if(source MATCHES "allocation(s|_count)\\.cpp$")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
    endif()
  endforeach()
  hvp_links(${name} hvp_systemc with_systemc)
  if(with_systemc)
    hvp_use_precompiled(${name} tests_systemc)
  elseif(nlohmann_json::nlohmann_json IN_LIST ARG_DEPENDS)
    hvp_use_precompiled(${name} tests_json)
  else()
    hvp_use_precompiled(${name} tests)
  endif()
  if(with_systemc OR cli_program IN_LIST ARG_DEPENDS)
    gtest_discover_tests(${name} TEST_PREFIX "${ARG_PREFIX}" DISCOVERY_TIMEOUT 120
      PROPERTIES TIMEOUT 300)
  else()
    add_test(NAME ${name} COMMAND ${name} --gtest_brief=1)
    set_tests_properties(${name} PROPERTIES TIMEOUT 1200 LABELS whole-program)
  endif()
endfunction()
