# The page of `tactree view`, built from page/ by npm in the build folder; sets tactree_page_assets.
#   AUTO  built where npm is there and gets its packages; else the program does without
#   ON    built, or an error
#   OFF   not built
#   a folder: that of a page built before (page-dist of another build), for a machine without npm
set(TACTREE_PAGE AUTO CACHE STRING "The page of tactree view: AUTO, ON, OFF or the folder of a built page")
set_property(CACHE TACTREE_PAGE PROPERTY STRINGS AUTO ON OFF)

set(page_source ${CMAKE_CURRENT_SOURCE_DIR}/page)
set(page_build ${CMAKE_CURRENT_BINARY_DIR}/page)
set(page_dist ${CMAKE_CURRENT_BINARY_DIR}/page-dist)
set(page_is_built OFF)
if(NOT TACTREE_PAGE MATCHES "^(AUTO|ON|OFF)$")
  set(page_is_built ON)
  cmake_path(ABSOLUTE_PATH TACTREE_PAGE BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE page_dist)
endif()
set(page_files ${page_dist}/index.html ${page_dist}/assets/page.js ${page_dist}/assets/page.css)
set(tactree_page_assets
  / text/html ${page_dist}/index.html
  /assets/page.js text/javascript ${page_dist}/assets/page.js
  /assets/page.css text/css ${page_dist}/assets/page.css)
if(page_is_built)
  foreach(file IN LISTS page_files)
    if(NOT EXISTS ${file})
      message(FATAL_ERROR "TACTREE_PAGE=${TACTREE_PAGE}: there is no ${file} (AUTO, ON, OFF, or the folder of a built page)")
    endif()
  endforeach()
  return()
endif()

set(page_wanted ${TACTREE_PAGE})
find_program(TACTREE_NPM npm)
if(NOT TACTREE_NPM)
  if(TACTREE_PAGE STREQUAL ON)
    message(FATAL_ERROR "TACTREE_PAGE=ON: npm is missing (scripts/install-deps view)")
  endif()
  if(page_wanted)
    message(STATUS "tactree view will have no page: npm is missing (scripts/install-deps view)")
    set(page_wanted OFF)
  endif()
endif()

file(GLOB_RECURSE page_sources CONFIGURE_DEPENDS ${page_source}/src/*)
list(APPEND page_sources ${page_source}/index.html ${page_source}/package.json
  ${page_source}/package-lock.json ${page_source}/tsconfig.json ${page_source}/vite.config.ts)
add_custom_command(OUTPUT ${page_files}
  COMMAND ${CMAKE_COMMAND} -DWANTED=${page_wanted} -DNPM=${TACTREE_NPM} -DSOURCE=${page_source}
    -DBUILD=${page_build} -DDIST=${page_dist} -P ${CMAKE_CURRENT_SOURCE_DIR}/cmake/build_page.cmake
  DEPENDS ${page_sources} ${CMAKE_CURRENT_SOURCE_DIR}/cmake/build_page.cmake
  COMMENT "Building the page of tactree view"
  VERBATIM)
