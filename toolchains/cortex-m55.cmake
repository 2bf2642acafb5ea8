# Without the vector extension (MVE), which flushes denormal floats to zero: a vectorised loop would
# compute other bits than the same loop on other cores.
set(TACTREE_CPU_FLAGS "-mcpu=cortex-m55+nomve -mfpu=fpv5-sp-d16 -mfloat-abi=hard")
set(TACTREE_MACHINE mps3-an547)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
