# Installs BUILD to an empty PREFIX and checks for programs and headers.
file(REMOVE_RECURSE ${PREFIX})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX}
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
foreach(file
    bin/tactree
    libexec/tactree/tactree-import-mesh
    share/tactree/device.schema.json
    include/tactree/core/model/blob.hpp
    include/tactree/hal/board.hpp
    include/tactree/session/session.hpp
    include/tactree/builder/model.hpp
    include/tactree/builder/version.hpp
    include/tactree/client/board.hpp
    include/tactree/client/tactree.h
    include/tactree/chai3d/device.hpp
    include/tactree/simulation/simulation.hpp)
  if(NOT EXISTS ${PREFIX}/${file})
    message(FATAL_ERROR "not installed: ${file}")
  endif()
endforeach()
