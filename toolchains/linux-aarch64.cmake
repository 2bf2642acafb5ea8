set(TACTREE_TRIPLET aarch64-linux-gnu)
set(TACTREE_QEMU qemu-aarch64)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
include(${CMAKE_CURRENT_LIST_DIR}/linux.cmake)
