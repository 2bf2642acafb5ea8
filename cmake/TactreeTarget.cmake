# What every target of ours shares: language level, warnings, sanitizers. Nothing is set globally,
# so a parent project that adds Tactree keeps its own flags.

# tactree_target(<target> [FREESTANDING])
#   FREESTANDING  code that also runs on a controller: no exceptions, no RTTI, no libm errno.
function(tactree_target target)
  cmake_parse_arguments(arg "FREESTANDING" "" "" ${ARGN})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wconversion -Wsign-conversion -Wdouble-promotion -Wshadow
    $<$<BOOL:${TACTREE_WERROR}>:-Werror>)
  # Forces must be the same to the bit on every compiler and core, so a product and a sum are
  # never fused into one rounding. This is part of the libraries' contract, hence PUBLIC.
  target_compile_options(${target} PUBLIC -ffp-contract=off)
  if(arg_FREESTANDING)
    target_compile_options(${target} PRIVATE
      -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-math-errno -fno-jump-tables
      -ffunction-sections -fdata-sections)
  endif()
  if(CMAKE_CROSSCOMPILING)
    # No path of the build machine in an image: two builds in two folders are alike.
    target_compile_options(${target} PRIVATE
      -ffile-prefix-map=${PROJECT_SOURCE_DIR}=. -ffile-prefix-map=${PROJECT_BINARY_DIR}=build)
    # Beside each object: its functions' stack frames and calls, for scripts/check-image.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fcallgraph-info=su>)
  endif()
  if(TACTREE_SANITIZE)
    target_compile_options(${target} PRIVATE
      -fsanitize=${TACTREE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${TACTREE_SANITIZE})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      # Coverage counters, for the fuzz targets to see their way.
      target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
    endif()
  endif()
endfunction()

# tactree_merge_sources(<target>)
#   Where TACTREE_MERGE_SOURCES is on, eight source files are compiled as one: a build that is made
#   once reads each large header, and generates its inline functions, an eighth as often.
function(tactree_merge_sources target)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${TACTREE_MERGE_SOURCES} UNITY_BUILD_BATCH_SIZE 8)
endfunction()
