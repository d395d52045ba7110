# Every library here is a Debian 12 package installed by script/bootstrap; README.md says what each is for. The installed
# CMake package finds them with this file as well. Those of modules, which may be missing, are in CarouselModules.cmake.
find_package(PkgConfig REQUIRED)
find_package(TBB REQUIRED)
find_package(glm REQUIRED)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(PNG REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(ZLIB REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(Boost REQUIRED)   # headers only
pkg_check_modules(turbojpeg REQUIRED IMPORTED_TARGET libturbojpeg)
pkg_check_modules(webp REQUIRED IMPORTED_TARGET libwebp)
pkg_check_modules(hwy REQUIRED IMPORTED_TARGET libhwy)
find_package(Protobuf QUIET)   # for timelines in Perfetto's format; without it they are JSON
