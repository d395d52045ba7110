# The scripts of the HTML pages: one file, bundled by esbuild from web/ and Apache ECharts. Where node or npm's packages
# are missing, pages have no charts and say so.
set(CAROUSEL_PAGE_CSS ${CMAKE_CURRENT_SOURCE_DIR}/web/src/page.css)
set(page_definitions "CAROUSEL_PAGE_CSS=\"${CAROUSEL_PAGE_CSS}\"")
set(page_inputs ${CAROUSEL_PAGE_CSS})
find_program(NODE_PROGRAM node)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/web/package-lock.json)
if(NODE_PROGRAM AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/web/node_modules/esbuild
   AND EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/web/node_modules/echarts)
  set(CAROUSEL_PAGES_HAVE_CHARTS ON)
  set(page_js ${CMAKE_CURRENT_BINARY_DIR}/web/page.js)
  file(GLOB_RECURSE page_sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/web/src/*.js)
  add_custom_command(OUTPUT ${page_js}
                     COMMAND ${NODE_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/web/build.mjs ${page_js}
                     DEPENDS ${page_sources} ${CMAKE_CURRENT_SOURCE_DIR}/web/build.mjs
                             ${CMAKE_CURRENT_SOURCE_DIR}/web/package-lock.json
                     COMMENT "Bundling the scripts of the HTML pages" VERBATIM)
  list(APPEND page_definitions "CAROUSEL_PAGE_JS=\"${page_js}\"")
  list(APPEND page_inputs ${page_js})
else()
  set(CAROUSEL_PAGES_HAVE_CHARTS OFF)
  message(STATUS "HTML pages will have no charts: node or web/node_modules is missing; script/bootstrap installs both")
endif()
# By itself, so that only this file depends on the bundle.
set_source_files_properties(report/html/bundle.cpp PROPERTIES COMPILE_DEFINITIONS "${page_definitions}"
                            OBJECT_DEPENDS "${page_inputs}" SKIP_UNITY_BUILD_INCLUSION ON)
