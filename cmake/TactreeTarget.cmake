# Common to all targets: language level, warnings, sanitizers. Nothing is set globally, so a parent
# project that adds Tactree keeps its own flags.

# tactree_target(<target> [FREESTANDING])
#   FREESTANDING  code for controllers: no exceptions, no RTTI, no errno of libm.
function(tactree_target target)
  cmake_parse_arguments(arg "FREESTANDING" "" "" ${ARGN})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wconversion -Wsign-conversion -Wdouble-promotion -Wshadow
    $<$<BOOL:${TACTREE_WERROR}>:-Werror>)
  # Never fuse a product and a sum into one rounding: forces must be the same to the bit with every
  # compiler and on every core. PUBLIC, since it is part of the libraries' contract.
  target_compile_options(${target} PUBLIC -ffp-contract=off)
  if(arg_FREESTANDING)
    target_compile_options(${target} PRIVATE
      -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno -fno-jump-tables
      -ffunction-sections -fdata-sections)
  endif()
  if(CMAKE_CROSSCOMPILING)
    # No path of the build machine in an image: builds in different folders are identical.
    target_compile_options(${target} PRIVATE
      -ffile-prefix-map=${PROJECT_SOURCE_DIR}=. -ffile-prefix-map=${PROJECT_BINARY_DIR}=build)
    # Writes stack frames and calls of the functions beside each object, for scripts/check-image.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fcallgraph-info=su>)
  endif()
  if(TACTREE_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${TACTREE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${TACTREE_SANITIZE})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      # Coverage counters for the fuzz targets.
      target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
    endif()
  endif()
endfunction()

# tactree_library(<name> [FREESTANDING] <source>...)
#   The static library tactree_<name>, which is tactree::<name> in this build and, if it is installed,
#   in other projects. Its public headers are below include/ of the calling folder.
function(tactree_library name)
  cmake_parse_arguments(arg "FREESTANDING" "" "" ${ARGN})
  set(options)
  if(arg_FREESTANDING)
    set(options FREESTANDING)
  endif()
  set(target tactree_${name})
  add_library(${target} STATIC ${arg_UNPARSED_ARGUMENTS})
  add_library(tactree::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  # A program may link the libraries of a host into a shared object of its own. Calls within one stay direct.
  if(NOT CMAKE_SYSTEM_NAME STREQUAL Generic)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fno-semantic-interposition>)
  endif()
  tactree_target(${target} ${options})
endfunction()

# tactree_merge_sources(<target> [QUICK])
#   With TACTREE_MERGE_SOURCES, up to sixteen source files are compiled as one, and a full build reads
#   each large header less often. Unlike in CMake's unity builds, the sources are divided evenly, and
#   named by relative paths, so that a compiler cache finds them again in another folder. Sources with
#   definitions of their own or SKIP_UNITY_BUILD_INCLUSION stay apart.
#   QUICK  code that does not take long to run, such as commands, files and pages: compiled with -O1,
#          which takes the compiler a quarter less time
function(tactree_merge_sources target)
  if(NOT TACTREE_MERGE_SOURCES)
    return()
  endif()
  if("QUICK" IN_LIST ARGN)
    target_compile_options(${target} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1>)
  endif()
  get_target_property(sources ${target} SOURCES)
  set(apart)
  set(mergeable)
  foreach(source IN LISTS sources)
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    if(definitions OR alone OR NOT source MATCHES "\\.cpp$")
      list(APPEND apart ${source})
    else()
      list(APPEND mergeable ${source})
    endif()
  endforeach()
  list(LENGTH mergeable count)
  math(EXPR files "(${count} + 15) / 16")
  set(merged)
  set(begin 0)
  while(begin LESS count)
    list(LENGTH merged number)
    math(EXPR end "(${number} + 1) * ${count} / ${files}")
    math(EXPR size "${end} - ${begin}")
    list(SUBLIST mergeable ${begin} ${size} part)
    set(text)
    foreach(source IN LISTS part)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
      cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/merged)
      string(APPEND text "#include \"${source}\"\n")
    endforeach()
    set(file ${CMAKE_CURRENT_BINARY_DIR}/merged/${target}_${number}.cpp)
    file(CONFIGURE OUTPUT ${file} CONTENT "${text}" @ONLY)
    list(APPEND merged ${file})
    set(begin ${end})
  endwhile()
  set_property(TARGET ${target} PROPERTY SOURCES ${apart} ${merged})
endfunction()
