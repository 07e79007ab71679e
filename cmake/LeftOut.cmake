# What a configuration leaves out is said, wherever it is built or tested: left-out.txt in the build
# directory has a line for each, which cmake/build.sh and tests/run pass on.
function(hvp_leave_out what why)
  message(STATUS "left out: ${what}: ${why}")
  set_property(GLOBAL APPEND_STRING PROPERTY HVP_LEFT_OUT "${what}: ${why}\n")
endfunction()

# Once, when all has been decided.
function(hvp_write_left_out)
  get_property(list GLOBAL PROPERTY HVP_LEFT_OUT)
  file(WRITE ${PROJECT_BINARY_DIR}/left-out.txt "${list}")
endfunction()
