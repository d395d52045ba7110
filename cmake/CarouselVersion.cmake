# The commit and compiler that `carousel --version` and every report name, read when cmake configures, which it does again
# after a commit.
find_package(Git QUIET)
set(CAROUSEL_COMMIT "unknown")
if(Git_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} describe --always --dirty --exclude=*
                  WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(CAROUSEL_COMMIT ${described})
  endif()
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --git-path logs/HEAD WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
                  OUTPUT_VARIABLE commits OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  get_filename_component(commits "${commits}" ABSOLUTE BASE_DIR ${CMAKE_CURRENT_SOURCE_DIR})
  if(EXISTS ${commits} AND NOT IS_DIRECTORY ${commits})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${commits})
  endif()
endif()
# On the one file that uses them: a new commit recompiles nothing else.
set_source_files_properties(core/system/version.cpp PROPERTIES COMPILE_DEFINITIONS
  "CAROUSEL_VERSION=\"${PROJECT_VERSION}\";CAROUSEL_COMMIT=\"${CAROUSEL_COMMIT}\";CAROUSEL_COMPILER=\"${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}\";CAROUSEL_BUILD_TYPE=\"${CMAKE_BUILD_TYPE}\"")

# What program and modules have to have in common (core/module/module.h).
set(CAROUSEL_MODULE_BUILD "${PROJECT_VERSION} ${CAROUSEL_COMMIT}, ${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}, ${CMAKE_BUILD_TYPE}")
if(CAROUSEL_CHECKED)
  string(APPEND CAROUSEL_MODULE_BUILD ", checked")
endif()
if(CAROUSEL_SANITIZE)
  string(REPLACE "," "+" sanitizers "${CAROUSEL_SANITIZE}")
  string(APPEND CAROUSEL_MODULE_BUILD ", ${sanitizers}")
endif()
set_source_files_properties(core/module/module_build.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON COMPILE_DEFINITIONS
  "CAROUSEL_MODULE_BUILD=\"${CAROUSEL_MODULE_BUILD}\"")
