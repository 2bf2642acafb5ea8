# Builds the page in BUILD, which holds a copy of SOURCE, into DIST. See Page.cmake for WANTED.

function(do_without why)
  if(WANTED STREQUAL ON)
    message(FATAL_ERROR "The page of tactree view was not built: ${why}")
  endif()
  message("tactree view will have no page: ${why}")
  file(WRITE ${DIST}/index.html "<!doctype html><meta charset=\"utf-8\"><title>tactree</title>"
    "<p>This program was built without its page: ${why}.</p>"
    "<p>Install npm (<code>scripts/install-deps view</code>), configure with "
    "<code>-DTACTREE_PAGE=ON</code> and build again.</p>\n")
  file(WRITE ${DIST}/assets/page.js "")  # has_page() knows by this
  file(WRITE ${DIST}/assets/page.css "")
endfunction()

# npm(<argument>...): its output only when it fails
function(npm result)
  execute_process(COMMAND ${NPM} ${ARGN} WORKING_DIRECTORY ${BUILD}
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message("${output}")
  endif()
  set(${result} ${status} PARENT_SCOPE)
endfunction()

if(NOT WANTED)
  do_without("it was not wanted, or npm is missing")
  return()
endif()

file(COPY ${SOURCE}/ DESTINATION ${BUILD} PATTERN node_modules EXCLUDE PATTERN dist EXCLUDE)

# npm ci takes a while: only when the lock has changed. It needs the network where `scripts/install-deps view` did
# not fill npm's cache.
file(SHA256 ${SOURCE}/package-lock.json lock)
set(installed "")
if(EXISTS ${BUILD}/installed.txt)
  file(READ ${BUILD}/installed.txt installed)
endif()
if(NOT installed STREQUAL lock)
  npm(status ci --prefer-offline --ignore-scripts --no-audit --no-fund)
  if(NOT status EQUAL 0)
    do_without("npm ci failed (is there a network?)")
    return()
  endif()
  file(WRITE ${BUILD}/installed.txt ${lock})
endif()

npm(status run build -- --outDir ${DIST} --emptyOutDir)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "The page's sources do not build")
endif()
# Vite keeps the times of what does not change; a build looks at them.
file(TOUCH ${DIST}/index.html ${DIST}/assets/page.js ${DIST}/assets/page.css)
