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

# tactree_merge_sources(<target>)
#   With TACTREE_MERGE_SOURCES, eight source files are compiled as one: a full build then reads each
#   large header, and generates its inline functions, an eighth as often.
function(tactree_merge_sources target)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${TACTREE_MERGE_SOURCES} UNITY_BUILD_BATCH_SIZE 8)
endfunction()
