set(TACTREE_TRIPLET arm-linux-gnueabihf)
set(TACTREE_QEMU qemu-arm)
set(CMAKE_SYSTEM_PROCESSOR armv7l)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
