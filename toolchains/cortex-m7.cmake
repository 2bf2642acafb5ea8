# Single precision only, also where the core has doubles: what would compute in double shows up as a
# library call, which no image may contain.
set(TACTREE_CPU_FLAGS "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16 -mfloat-abi=hard")
set(TACTREE_MACHINE mps2-an500)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
