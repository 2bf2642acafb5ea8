# Common to the Linux boards; the file of a processor sets TACTREE_TRIPLET and TACTREE_QEMU first.
# Compilers: scripts/install-deps cross.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_CXX_COMPILER ${TACTREE_TRIPLET}-g++)
set(CMAKE_FIND_ROOT_PATH /usr/${TACTREE_TRIPLET})
# Header-only libraries are taken from the build machine.
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_CROSSCOMPILING_EMULATOR ${TACTREE_QEMU} -L /usr/${TACTREE_TRIPLET})
