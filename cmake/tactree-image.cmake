# For the image of a firmware that links tactree::runtime; part of its component in find_package(tactree).
#
#   tactree_complete_image(<target> [BOARD <file.json> ENTRIES <function>... SOURCES <folder>...])
#
# After linking, with BOARD: writes the cycles of a tick into the image, so that its controller refuses
# models that are too slow. ENTRIES are the functions that a tick enters. SOURCES are the folders of the
# sources, Tactree's first; the installed headers and the current folder are added. Needs the program tactree of the same version
# (TACTREE_HOST_TOOL), and line numbers (-g). Then, also without BOARD: writes the checksum of the
# program into the record of the image (tactree/runtime/image_record.hpp). Needs Python 3.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

function(tactree_complete_image target)
  cmake_parse_arguments(arg "" "BOARD" "ENTRIES;SOURCES" ${ARGN})
  set(bound)
  if(arg_BOARD)
    find_program(TACTREE_HOST_TOOL tactree REQUIRED)
    cmake_path(ABSOLUTE_PATH arg_BOARD BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    list(APPEND arg_SOURCES ${TACTREE_INCLUDE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
    list(TRANSFORM arg_ENTRIES PREPEND "--entry=")
    list(TRANSFORM arg_SOURCES PREPEND "--sources=")
    set(bound COMMAND ${TACTREE_HOST_TOOL} bound $<TARGET_FILE:${target}> --board ${arg_BOARD}
      --embed --quiet ${arg_ENTRIES} ${arg_SOURCES})
    set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS ${TACTREE_HOST_TOOL} ${arg_BOARD})
  endif()
  add_custom_command(TARGET ${target} POST_BUILD VERBATIM ${bound}
    COMMAND Python3::Interpreter ${TACTREE_SEAL_IMAGE} $<TARGET_FILE:${target}>)
endfunction()
