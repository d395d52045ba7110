# Flags every translation unit is built with.
add_library(carousel_options INTERFACE)
target_compile_features(carousel_options INTERFACE cxx_std_20)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# One arithmetic for every machine: a contracted product makes Highway targets differ and the watertight
# test leak (docs/how-it-works/design.md, One arithmetic), so contraction is off everywhere, and there is no
# -march=native.
target_compile_options(carousel_options INTERFACE -ffp-contract=off
                       "$<BUILD_INTERFACE:-Wall;-Wextra;-Wpedantic;-Wshadow>" -Wno-psabi)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 warns of overlaps inside std::string's own operator+ (GCC bug 105651) and of uninitialised strings in
  # vectors of structs (GCC bug 105562).
  target_compile_options(carousel_options INTERFACE -Wno-restrict -Wno-maybe-uninitialized)
  # With several files at a time it inlines more and warns of overflows there too; and an anonymous namespace of a .cpp
  # file that another includes looks like one of a header. The dev preset keeps these warnings.
  if(CMAKE_UNITY_BUILD)
    target_compile_options(carousel_options INTERFACE
                           "$<BUILD_INTERFACE:-Wno-stringop-overflow;-Wno-array-bounds;-Wno-subobject-linkage>")
    # Collecting its garbage takes GCC up to a tenth of the time, and saves a quarter of the memory, of which
    # it takes 2.8 GB at most. Not what users build, with as many compilers at a time as they have cores.
    if(CAROUSEL_CHECKED)
      target_compile_options(carousel_options INTERFACE $<BUILD_INTERFACE:--param=ggc-min-heapsize=4000000>)
    endif()
  endif()
endif()
# With several files at a time an alias in the anonymous namespace of one file is shadowed by that of another, says Clang;
# alone they never meet. GCC's -Wshadow looks at the same files.
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND CMAKE_UNITY_BUILD)
  target_compile_options(carousel_options INTERFACE $<BUILD_INTERFACE:-Wno-shadow>)
endif()
if(CAROUSEL_CHECKED)
  target_compile_definitions(carousel_options INTERFACE CAROUSEL_CHECKED=1)
endif()
if(CAROUSEL_SANITIZE)
  target_compile_options(carousel_options INTERFACE -fsanitize=${CAROUSEL_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all)
  target_link_options(carousel_options INTERFACE -fsanitize=${CAROUSEL_SANITIZE})
  if(CAROUSEL_SANITIZE MATCHES "thread")   # the queues of others have fences; under the sanitizer no test runs them
    target_compile_options(carousel_options INTERFACE -Wno-tsan)
  endif()
endif()

# What users run reads files of strangers: checked copies (_FORTIFY_SOURCE), a guarded stack, and tables of addresses that are
# read-only once the program has begun. Sanitizers bring checks of their own. The engines read no files and are most of the
# time of a run: there only functions with arrays of characters guard the stack. They say by the macro that they have the
# guard of the precompiled header, which is all libraries', or the compiler would not take it.
option(CAROUSEL_HARDEN "Build releases with checked copies, a guarded stack and read-only tables of addresses" ON)
if(CAROUSEL_HARDEN AND CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT CAROUSEL_SANITIZE)
  set(in_ringbus "$<STREQUAL:$<TARGET_PROPERTY:NAME>,carousel_ringbus>")
  target_compile_options(carousel_options INTERFACE
                         "$<BUILD_INTERFACE:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=3>"
                         "$<BUILD_INTERFACE:$<IF:${in_ringbus},-fstack-protector;-D__SSP_STRONG__=3,-fstack-protector-strong>>")
  target_link_options(carousel_options INTERFACE "$<BUILD_INTERFACE:LINKER:-z,relro,-z,now>")
endif()

find_package(Threads REQUIRED)
target_link_libraries(carousel_options INTERFACE Threads::Threads)

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()
