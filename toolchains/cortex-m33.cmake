set(TACTREE_CPU_FLAGS "-mcpu=cortex-m33 -mfpu=fpv5-sp-d16 -mfloat-abi=hard")
set(TACTREE_MACHINE mps2-an505)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
