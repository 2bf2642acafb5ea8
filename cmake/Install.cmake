# Installation, whole or by component (cmake --install BUILD --component NAME), and find_package(tactree)
# and pkg-config for other projects.
#
# Libraries, each with an export file of its own that finds what it needs:
#   core        tactree::core, hal, session, store    depends on nothing; always present
#   runtime     tactree::runtime                      depends on nothing; only of a build for a controller
#   builder     tactree::builder                      Eigen, fmt, TBB, liblzf, libsodium, pugixml
#   simulation  tactree::plant, tactree::simulation   Eigen, fmt
#   client      tactree::client                       threads, libusb; tactree::client_c, if client-library is there
# Programs and files:
#   client-library  the shared library tactree::client_c, for programs that were linked with it
#   tools           tactree, with what it reads and starts
#   controller      tactree-controller, for Linux boards
#   python          the Python package
#   firmware        images of the boards of a cross build
include(CMakePackageConfigHelpers)

set(tactree_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tactree)
set(tactree_pkg_config_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# tactree_install_component(<component> HEADERS <folder>... TARGETS <target>...)
#   HEADERS  folders whose content is installed to the include folder
function(tactree_install_component component)
  cmake_parse_arguments(arg "" "" "HEADERS;TARGETS" ${ARGN})
  install(TARGETS ${arg_TARGETS} EXPORT tactree-${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
    OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/tactree COMPONENT ${component})
  install(EXPORT tactree-${component} NAMESPACE tactree:: DESTINATION ${tactree_cmake_dir}
    FILE tactree-${component}-targets.cmake COMPONENT ${component})
  foreach(folder IN LISTS arg_HEADERS)
    install(DIRECTORY ${folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component}
      FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
  endforeach()
endfunction()

# tactree_install_pkg_config(<name> DESCRIPTION <text> LIBRARIES <library>... [FLAGS <flag>...] [REQUIRES <package>...])
#   tactree-<name>.pc, of the component that the name begins with, which stays right when the installed folder is moved.
#   What a static library needs is not private: it is linked with it, whatever else is linked statically.
function(tactree_install_pkg_config name)
  cmake_parse_arguments(arg "" "DESCRIPTION" "LIBRARIES;FLAGS;REQUIRES" ${ARGN})
  file(RELATIVE_PATH up /${tactree_pkg_config_dir} /)
  list(TRANSFORM arg_LIBRARIES PREPEND -l)
  foreach(list IN ITEMS LIBRARIES FLAGS REQUIRES)
    list(JOIN arg_${list} " " arg_${list})
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/tactree.pc.in ${PROJECT_BINARY_DIR}/tactree-${name}.pc @ONLY)
  string(REGEX MATCH "^[a-z]+" component ${name})
  install(FILES ${PROJECT_BINARY_DIR}/tactree-${name}.pc DESTINATION ${tactree_pkg_config_dir}
    COMPONENT ${component})
endfunction()

# The flags that change results: docs/LIBRARY.md.
set(tactree_flags -std=c++20 -ffp-contract=off)

tactree_install_component(core
  TARGETS tactree_core tactree_hal tactree_session tactree_store
  HEADERS core/include hal/include hal/session/include hal/store/include)
if(CMAKE_SYSTEM_NAME STREQUAL Generic)
  tactree_install_component(runtime TARGETS tactree_runtime HEADERS hal/runtime/include)
  install(PROGRAMS scripts/seal-image DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/tactree COMPONENT runtime)
  install(FILES cmake/tactree-image.cmake DESTINATION ${tactree_cmake_dir} COMPONENT runtime)
else()
  tactree_install_pkg_config(core
    DESCRIPTION "Haptic rendering of scanned objects: the controller's algorithm and its interfaces"
    FLAGS ${tactree_flags} LIBRARIES tactree_session tactree_store tactree_core)
endif()
if(TACTREE_BUILD_TOOLS)
  tactree_install_component(builder
    TARGETS tactree_builder tactree_process
    HEADERS host/builder/include ${CMAKE_CURRENT_BINARY_DIR}/host/builder/include)
  tactree_install_pkg_config(builder
    DESCRIPTION "Scans to models for haptic rendering"
    LIBRARIES tactree_builder tactree_process lzf
    REQUIRES tactree-core eigen3 fmt libsodium pugixml tbb)
  tactree_install_component(simulation
    TARGETS tactree_plant tactree_simulation
    HEADERS host/simulator/plant/include host/simulator/simulation/include)
  tactree_install_pkg_config(simulation
    DESCRIPTION "Simulated haptic devices and hands"
    LIBRARIES tactree_simulation tactree_plant REQUIRES tactree-core eigen3 fmt)
  tactree_install_component(client
    TARGETS tactree_client
    HEADERS host/client/include)
  # An export file of its own: find_package() includes it if the library is installed, too.
  install(TARGETS tactree_client_c EXPORT tactree-client-c
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT client-library NAMELINK_COMPONENT client)
  install(EXPORT tactree-client-c NAMESPACE tactree:: DESTINATION ${tactree_cmake_dir}
    FILE tactree-client-c-targets.cmake COMPONENT client)
  tactree_install_pkg_config(client
    DESCRIPTION "Connection to a haptic controller, in C++"
    FLAGS -pthread LIBRARIES tactree_client REQUIRES tactree-core libusb-1.0)
  tactree_install_pkg_config(client-c
    DESCRIPTION "Connection to a haptic controller, in C"
    LIBRARIES tactree-client)
endif()

configure_package_config_file(cmake/tactree-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/tactree-config.cmake
  INSTALL_DESTINATION ${tactree_cmake_dir}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_LIBEXECDIR)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/tactree-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/tactree-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/tactree-config-version.cmake
  DESTINATION ${tactree_cmake_dir} COMPONENT core)
