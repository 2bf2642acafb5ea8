# Installation, for find_package(tactree) from other projects.
#
# Each component has its own export file and finds its own dependencies. A firmware project that uses
# core and hal needs no other package.
#   core        tactree::core, hal, session, store    depends on nothing; always present
#   runtime     tactree::runtime                      depends on nothing; only of a build for a controller
#   builder     tactree::builder                      Eigen, fmt, TBB, liblzf, libsodium, pugixml
#   simulation  tactree::plant, tactree::simulation   Eigen
#   client      tactree::client                       threads, libusb
include(CMakePackageConfigHelpers)

set(tactree_cmake_dir ${CMAKE_INSTALL_LIBDIR}/cmake/tactree)

# tactree_install_component(<component> <headers>... TARGETS <target>...)
#   headers  folders whose content is installed to the include folder
function(tactree_install_component component)
  cmake_parse_arguments(arg "" "" "HEADERS;TARGETS" ${ARGN})
  install(TARGETS ${arg_TARGETS} EXPORT tactree-${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/tactree)
  install(EXPORT tactree-${component} NAMESPACE tactree:: DESTINATION ${tactree_cmake_dir}
    FILE tactree-${component}-targets.cmake)
  foreach(folder IN LISTS arg_HEADERS)
    install(DIRECTORY ${folder}/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
      FILES_MATCHING PATTERN "*.hpp" PATTERN "*.h")
  endforeach()
endfunction()

tactree_install_component(core
  TARGETS tactree_core tactree_hal tactree_session tactree_store
  HEADERS core/include hal/include hal/session/include hal/store/include)
if(CMAKE_SYSTEM_NAME STREQUAL Generic)
  tactree_install_component(runtime TARGETS tactree_runtime HEADERS hal/runtime/include)
  install(PROGRAMS scripts/seal-image DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/tactree)
  install(FILES cmake/tactree-image.cmake DESTINATION ${tactree_cmake_dir})
endif()
if(TACTREE_BUILD_TOOLS)
  tactree_install_component(builder
    TARGETS tactree_builder tactree_process
    HEADERS host/builder/include ${CMAKE_CURRENT_BINARY_DIR}/host/builder/include)
  tactree_install_component(simulation
    TARGETS tactree_plant tactree_simulation
    HEADERS host/simulator/plant/include host/simulator/simulation/include)
  tactree_install_component(client
    TARGETS tactree_client
    HEADERS host/client/include)
endif()

configure_package_config_file(cmake/tactree-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/tactree-config.cmake
  INSTALL_DESTINATION ${tactree_cmake_dir}
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR CMAKE_INSTALL_LIBEXECDIR)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/tactree-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/tactree-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/tactree-config-version.cmake
  DESTINATION ${tactree_cmake_dir})
