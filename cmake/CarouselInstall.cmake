# cmake --install and cpack. Components: `carousel`, the program with all that a user of it needs; `carousel-dev`,
# headers, libraries and the CMake package for programs of one's own; and one for each module, as the libraries of
# others that it needs are many.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
find_package(Python3 QUIET COMPONENTS Interpreter)

set(program COMPONENT carousel)
set(development COMPONENT carousel-dev)
set(data ${CMAKE_INSTALL_DATADIR}/carousel)
set(docs ${CMAKE_INSTALL_DATADIR}/doc/carousel)

# -- The program
install(TARGETS carousel RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} ${program})
# Modules are files of this program alone, found beside it (core/module/module.cpp): no folder of an architecture.
set(modules lib/carousel/modules)
install(TARGETS carousel_module_process RUNTIME DESTINATION ${modules} ${program})

# The program writes its manual, its completions and the schema of configurations. It is asked when it is installed:
# asked when it is built, it would take a second of every build.
set(written ${CMAKE_CURRENT_BINARY_DIR}/installed)
install(CODE "
  set(carousel_program \"$<TARGET_FILE:carousel>\")
  file(MAKE_DIRECTORY \"${written}\")
  function(carousel_writes file)
    execute_process(COMMAND \${carousel_program} \${ARGN} OUTPUT_FILE \"${written}/\${file}\" COMMAND_ERROR_IS_FATAL ANY)
  endfunction()
  carousel_writes(carousel.1 man)
  execute_process(COMMAND gzip -9nf \"${written}/carousel.1\" COMMAND_ERROR_IS_FATAL ANY)
  carousel_writes(carousel completion bash)
  carousel_writes(_carousel completion zsh)
  carousel_writes(schema.json schema config)
  execute_process(COMMAND gzip -9nc \"${CMAKE_CURRENT_SOURCE_DIR}/CHANGELOG.md\" OUTPUT_FILE \"${written}/changelog.gz\"
                  COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND \"${CMAKE_COMMAND}\" -DSOURCE=${CMAKE_CURRENT_SOURCE_DIR} -DPROGRAM=\${carousel_program} -DOUT=${written}
                          -DMODULES=${CAROUSEL_MODULE_FOLDER} -DVERSION=${PROJECT_VERSION} -DCOMMIT=${CAROUSEL_COMMIT} -DPAGES=${CAROUSEL_PAGES_HAVE_CHARTS}
                          -P \"${CMAKE_CURRENT_SOURCE_DIR}/cmake/notices.cmake\" COMMAND_ERROR_IS_FATAL ANY)
  # Debian's zsh and Python look elsewhere below /usr than below /usr/local.
  if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
    set(carousel_zsh share/zsh/vendor-completions)
    set(carousel_python lib/python3/dist-packages)
  else()
    set(carousel_zsh share/zsh/site-functions)
    set(carousel_python lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/dist-packages)
  endif()" ${program})
install(FILES ${written}/carousel.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 ${program})
install(FILES ${written}/carousel DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions ${program})
install(FILES ${written}/_carousel DESTINATION "\${carousel_zsh}" ${program})
install(FILES ${written}/schema.json DESTINATION ${data}/configs ${program})
install(DIRECTORY configs/ DESTINATION ${data}/configs ${program} PATTERN schema.json EXCLUDE)
install(DIRECTORY python/carousel DESTINATION "\${carousel_python}" ${program} PATTERN __pycache__ EXCLUDE)
install(FILES ${written}/changelog.gz README.md DESTINATION ${docs} ${program})
install(FILES cmake/copyright ${written}/NOTICES.gz ${written}/carousel.spdx.json DESTINATION ${docs} ${program})
install(DIRECTORY docs/ DESTINATION ${docs} ${program})
# The same pages as a site, where script/docs has built it: looked for when the program is installed.
install(DIRECTORY build/site/ DESTINATION ${docs}/html ${program} OPTIONAL)
install(DIRECTORY python/examples/ DESTINATION ${docs}/examples/python ${program} PATTERN .ipynb_checkpoints EXCLUDE)

# -- Modules: each where its library was found
foreach(module IN ITEMS pictures mpi scenes http)
  if(TARGET carousel_module_${module})
    list(APPEND module_components carousel-${module})
    install(TARGETS carousel_module_${module} LIBRARY DESTINATION ${modules} COMPONENT carousel-${module})
    install(FILES cmake/copyright ${written}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/carousel-${module}
            COMPONENT carousel-${module})
  endif()
endforeach()

# -- Programs of one's own
set(libraries core scene accel ringbus shading report app)
foreach(library IN LISTS libraries)
  set_target_properties(carousel_${library} PROPERTIES EXPORT_NAME ${library})
  install(DIRECTORY ${library} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/carousel ${development}
          FILES_MATCHING PATTERN "*.h")
  list(APPEND library_targets carousel_${library})
endforeach()
set_target_properties(carousel_options PROPERTIES EXPORT_NAME options)
set_target_properties(carousel_module_base PROPERTIES EXPORT_NAME plugin OUTPUT_NAME carousel_plugin)
install(TARGETS ${library_targets} carousel_module_base carousel_options EXPORT CarouselTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} ${development}
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/carousel)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Carousel)
install(EXPORT CarouselTargets NAMESPACE carousel:: DESTINATION ${package} ${development})
configure_package_config_file(cmake/CarouselConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/CarouselConfig.cmake
                              INSTALL_DESTINATION ${package})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/CarouselConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/CarouselConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/CarouselConfigVersion.cmake
        cmake/CarouselDependencies.cmake DESTINATION ${package} ${development})
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/carousel-dev/examples ${development})
install(FILES cmake/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/carousel-dev ${development})
install(FILES ${written}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/carousel-dev ${development})

# -- Packages: cpack -G DEB in the build folder
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME carousel)
set(CPACK_PACKAGE_VENDOR "The Carousel project")
# The domain .invalid belongs to nobody (RFC 2606): who publishes packages puts an address of their own here.
set(CPACK_PACKAGE_CONTACT "The Carousel project <carousel@carousel.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulator of ray-tracing hardware in which shapes travel")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL carousel carousel-dev ${module_components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_CAROUSEL_PACKAGE_NAME carousel)
set(CPACK_DEBIAN_CAROUSEL_PACKAGE_SECTION science)
set(CPACK_DEBIAN_CAROUSEL_PACKAGE_SHLIBDEPS ON)
list(JOIN module_components ", " recommended)
string(REGEX REPLACE "(, )?carousel-mpi" "" recommended "${recommended}")   # is for those who have several hosts
string(REGEX REPLACE "^, |, $" "" recommended "python3, ${recommended}")
set(CPACK_DEBIAN_CAROUSEL_PACKAGE_RECOMMENDS "${recommended}")
set(CPACK_DEBIAN_CAROUSEL_PACKAGE_SUGGESTS "carousel-dev, carousel-mpi, python3-numpy, python3-pandas")
set(CPACK_COMPONENT_CAROUSEL_DESCRIPTION
    "Carousel simulates ray-tracing hardware in which rays stay put and packets
of shapes travel a ring of queues: on worker threads and real queues, or
under virtual time with a report of cycles, bytes and the parts that limit
the machine. The package holds the program, its manual, example
configurations and a Python module.")
set(CPACK_COMPONENT_CAROUSEL-PICTURES_DESCRIPTION
    "Textures and pictures in TIFF, DDS, TGA, Radiance HDR, PSD, JPEG 2000 and the
other formats of OpenImageIO for Carousel, a simulator of ray-tracing
hardware, which reads PNG, JPEG and WebP without it.")
set(CPACK_COMPONENT_CAROUSEL-MPI_DESCRIPTION
    "Runs of Carousel, a simulator of ray-tracing hardware, over several processes
and hosts by Open MPI (engine.transport: mpi).")
set(CPACK_COMPONENT_CAROUSEL-SCENES_DESCRIPTION
    "Scenes of other formats than glTF for Carousel, a simulator of ray-tracing
hardware, by Open Asset Import Library.")
set(CPACK_COMPONENT_CAROUSEL-HTTP_DESCRIPTION
    "A site of results on this machine (carousel serve) for Carousel, a simulator of
ray-tracing hardware, by cpp-httplib.")
set(CPACK_DEBIAN_CAROUSEL-MPI_PACKAGE_RECOMMENDS "openmpi-bin")
foreach(component IN LISTS module_components)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${component})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS ON)
  # A module is of one build with its program (core/module/module.h).
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "carousel (= ${PROJECT_VERSION})")
endforeach()
# The libraries are those that script/bootstrap installs to build with: one list.
file(STRINGS script/bootstrap bootstrap REGEX "^release=|^  lib|^  .*-dev")
list(JOIN bootstrap " " bootstrap)
string(REGEX REPLACE "^.*release=\\(([^)]*)\\).*$" "\\1" bootstrap "${bootstrap}")
string(REGEX MATCHALL "[a-z0-9.+-]+-dev" bootstrap "${bootstrap}")
list(JOIN bootstrap ", " development_packages)
set(CPACK_DEBIAN_CAROUSEL-DEV_PACKAGE_NAME carousel-dev)
set(CPACK_DEBIAN_CAROUSEL-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_CAROUSEL-DEV_PACKAGE_DEPENDS "${development_packages}, pkg-config")
set(CPACK_DEBIAN_CAROUSEL-DEV_PACKAGE_RECOMMENDS "carousel, cmake, g++")
set(CPACK_COMPONENT_CAROUSEL-DEV_DESCRIPTION
    "Headers, static libraries and the CMake package of Carousel, a simulator of
ray-tracing hardware, for programs with queues, policies or workloads of
their own. Examples are included.")
include(CPack)
