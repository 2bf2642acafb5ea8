# Single precision only, even if the core supports double: double arithmetic then becomes a library
# call, which the check of the image refuses.
set(TACTREE_CPU_FLAGS "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16 -mfloat-abi=hard")
set(TACTREE_MACHINE mps2-an500)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
