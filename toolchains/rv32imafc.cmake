set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv32)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_CXX_COMPILER riscv64-unknown-elf-g++)
# Debian's RISC-V compiler has no C++ headers. Those of the Arm compiler of the same version contain
# all that a freestanding program includes.
file(GLOB headers /usr/include/newlib/c++/*)
# Version 2.2 of the specification includes the control registers in the base set; for a later one
# the compiler has no libgcc for this core.
set(CMAKE_CXX_FLAGS_INIT "-march=rv32imafc -misa-spec=2.2 -mabi=ilp32f -nostdinc++ \
-isystem ${headers} -isystem ${headers}/arm-none-eabi/thumb/v7e-m+fp/hard -isystem /usr/include/newlib")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-system-riscv32 -M virt -cpu sifive-e34 -nodefaults
  -display none -bios none -semihosting-config enable=on,target=native -icount shift=3,sleep=off
  -kernel)
