# Parts of the program that are opened on demand (core/module/module.h, docs/how-it-works/modules.md): one shared
# library a module, in build/X/modules, and installed in lib/carousel/modules. A module is built
# where its library is found, and is glue only: it holds no other code of the program than this. Plugins of others link it as carousel::plugin
# (docs/guides/plugins.md).
add_library(carousel_module_base STATIC core/module/module_build.cpp core/system/error.cpp core/system/plain_text.cpp)
target_link_libraries(carousel_module_base PUBLIC carousel_options glm::glm fmt::fmt)
target_include_directories(carousel_module_base PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}>)
set_target_properties(carousel_module_base PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
                      VISIBILITY_INLINES_HIDDEN ON UNITY_BUILD OFF)

set(CAROUSEL_MODULE_FOLDER ${CMAKE_CURRENT_BINARY_DIR}/modules)
add_custom_target(carousel_modules)

# What all modules have in common.
function(carousel_module name)
  cmake_parse_arguments(PARSE_ARGV 1 module "" "" "SOURCES;LIBRARIES")
  set(target carousel_module_${name})
  add_library(${target} MODULE ${module_SOURCES})
  target_link_libraries(${target} PRIVATE carousel_module_base ${module_LIBRARIES})
  # Names of its libraries stay its own: the program may hold the same in another version.
  target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL)
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${CAROUSEL_MODULE_FOLDER}
                        CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  add_dependencies(carousel_modules ${target})
endfunction()

# The process in which modules work on data of strangers.
add_executable(carousel_module_process modules/process/main.cpp)
target_link_libraries(carousel_module_process PRIVATE carousel_core)
set_target_properties(carousel_module_process PROPERTIES OUTPUT_NAME process RUNTIME_OUTPUT_DIRECTORY ${CAROUSEL_MODULE_FOLDER})
add_dependencies(carousel_modules carousel_module_process)

# -- pictures: OpenImageIO
find_package(OpenImageIO CONFIG QUIET)
if(OpenImageIO_FOUND)
  # Debian's target names an include folder of OpenCV that need not be there, which CMake refuses.
  get_target_property(found OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
  set(folders "")
  foreach(folder IN LISTS found)
    if(EXISTS ${folder})
      list(APPEND folders ${folder})
    endif()
  endforeach()
  set_property(TARGET OpenImageIO::OpenImageIO PROPERTY INTERFACE_INCLUDE_DIRECTORIES ${folders})
  carousel_module(pictures SOURCES modules/pictures/pictures_module.cpp modules/pictures/read_picture.cpp
                  modules/pictures/write_picture.cpp LIBRARIES OpenImageIO::OpenImageIO)
else()
  message(STATUS "No module pictures: libopenimageio-dev is missing; PNG, JPEG, WebP and EXR need none")
endif()

# -- http: cpp-httplib, as Debian compiles it
pkg_check_modules(httplib QUIET IMPORTED_TARGET cpp-httplib)
if(httplib_FOUND)
  carousel_module(http SOURCES modules/http/http_module.cpp LIBRARIES PkgConfig::httplib)
else()
  message(STATUS "No module http: libcpp-httplib-dev is missing; carousel serve needs it")
endif()

# -- mpi: Open MPI
set(MPI_CXX_SKIP_MPICXX ON)   # the bindings for C; those for C++ are gone from MPI 3
find_package(MPI QUIET COMPONENTS CXX)
if(MPI_CXX_FOUND)
  carousel_module(mpi SOURCES modules/mpi/mpi_module.cpp modules/mpi/call_guard.cpp LIBRARIES MPI::MPI_CXX ${CMAKE_DL_LIBS})
else()
  message(STATUS "No module mpi: libopenmpi-dev is missing; engine.transport: mpi needs it")
endif()

# -- scenes: Assimp
find_package(assimp CONFIG QUIET)
if(assimp_FOUND)
  carousel_module(scenes SOURCES modules/scenes/scenes_module.cpp modules/scenes/read_scene.cpp
                  modules/scenes/material_map.cpp
                  modules/scenes/motion.cpp modules/scenes/source_files.cpp LIBRARIES assimp::assimp)
else()
  message(STATUS "No module scenes: libassimp-dev is missing; glTF needs none")
endif()
