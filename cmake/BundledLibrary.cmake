# All static libraries that a target links, itself included, in the order of linking.
function(hvp_static_closure target result)
  set(found ${${result}})
  if(NOT target IN_LIST found)
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "STATIC_LIBRARY")
      list(APPEND found ${target})
      get_target_property(links ${target} LINK_LIBRARIES)
      foreach(link IN LISTS links)
        if(link MATCHES "^hvp_" AND TARGET ${link})
          hvp_static_closure(${link} found)
        endif()
      endforeach()
    endif()
  endif()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# One archive of a library and of all of the house's that it stands on, for a program that is not
# built here, and a file for pkg-config that names it: hvp_bundle(hvp_board_api hvp-board "-lfmt")
# gives lib<name>.a and <name>.pc in the build directory's lib/.
function(hvp_bundle target name libraries)
  set(members "")
  hvp_static_closure(${target} members)
  set(folder ${PROJECT_BINARY_DIR}/lib)
  set(archive ${folder}/lib${name}.a)
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${name}.mri)
  set(lines "CREATE ${archive}.part\n")
  foreach(member IN LISTS members)
    string(APPEND lines "ADDLIB $<TARGET_FILE:${member}>\n")
  endforeach()
  file(GENERATE OUTPUT ${script} CONTENT "${lines}SAVE\nEND\n")
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(OUTPUT ${archive}
    COMMAND ${CMAKE_AR} -M < ${script}
    COMMAND ${CMAKE_COMMAND} -E rename ${archive}.part ${archive}
    DEPENDS ${members} ${script} VERBATIM)
  add_custom_target(${name} ALL DEPENDS ${archive})
  file(WRITE ${folder}/${name}.pc "Name: ${name}\nVersion: ${PROJECT_VERSION}\n\
Description: ${PROJECT_DESCRIPTION}\n\
Cflags: -I${PROJECT_SOURCE_DIR}\nLibs: -L${folder} -l${name} -Wl,--as-needed ${libraries}\n")
endfunction()
