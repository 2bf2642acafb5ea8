# Common to the Arm cores; the file of a core sets TACTREE_CPU_FLAGS and TACTREE_MACHINE first.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_CXX_FLAGS_INIT "-mthumb ${TACTREE_CPU_FLAGS}")
# The virtual clock counts instructions: every run of a program is the same.
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-system-arm -M ${TACTREE_MACHINE} -nodefaults -display none
  -semihosting-config enable=on,target=native -icount shift=3,sleep=off -kernel)
