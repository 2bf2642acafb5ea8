#pragma once
// Subset of QEMU's plugin interface, versions 1 (QEMU 4.2 .. 8) and 2 (from 9 on), that the counter
// uses. QEMU documents it in "QEMU TCG Plugins"; Debian does not package its header. What only one
// of the versions has is weak: nullptr in the other.

#include <cstddef>
#include <cstdint>

// NOLINTBEGIN(readability-identifier-naming): the names are those of QEMU.
extern "C" {

using qemu_plugin_id_t = std::uint64_t;
struct qemu_plugin_tb;    // a translated block of instructions
struct qemu_plugin_insn;  // an instruction of a block
struct qemu_info_t;

enum qemu_plugin_cb_flags { QEMU_PLUGIN_CB_NO_REGS = 0 };
enum qemu_plugin_mem_rw { QEMU_PLUGIN_MEM_RW = 3 };
using qemu_plugin_meminfo_t = std::uint32_t;
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 = 0 };

void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id,
                                           void (*translated)(qemu_plugin_id_t id,
                                                              qemu_plugin_tb* block));
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t id,
                                    void (*at_exit)(qemu_plugin_id_t id, void* user), void* user);

std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb* block);
qemu_plugin_insn* qemu_plugin_tb_get_insn(const qemu_plugin_tb* block, std::size_t index);
std::size_t qemu_plugin_insn_size(const qemu_plugin_insn* instruction);
std::uint64_t qemu_plugin_insn_vaddr(const qemu_plugin_insn* instruction);
/// Symbol in the ELF file of the function that contains the instruction; nullptr or "" outside
/// functions.
const char* qemu_plugin_insn_symbol(const qemu_plugin_insn* instruction);

void qemu_plugin_register_vcpu_insn_exec_cb(qemu_plugin_insn* instruction,
                                            void (*executed)(unsigned vcpu, void* user),
                                            qemu_plugin_cb_flags flags, void* user);
// Version 1: any address.
[[gnu::weak]] void qemu_plugin_register_vcpu_insn_exec_inline(qemu_plugin_insn* instruction,
                                                              qemu_plugin_op op, void* counter,
                                                              std::uint64_t amount);
// Version 2: a place in an element that the emulator has for each core, at first of zeros. With few
// cores an element stays at its address.
struct qemu_plugin_scoreboard;
struct qemu_plugin_u64 {
  qemu_plugin_scoreboard* score;
  std::size_t offset;
};
[[gnu::weak]] qemu_plugin_scoreboard* qemu_plugin_scoreboard_new(std::size_t element_size);
[[gnu::weak]] void* qemu_plugin_scoreboard_find(qemu_plugin_scoreboard* score, unsigned vcpu);
[[gnu::weak]] void qemu_plugin_register_vcpu_insn_exec_inline_per_vcpu(
    qemu_plugin_insn* instruction, qemu_plugin_op op, qemu_plugin_u64 entry, std::uint64_t amount);

void qemu_plugin_register_vcpu_mem_cb(qemu_plugin_insn* instruction,
                                      void (*accessed)(unsigned vcpu, qemu_plugin_meminfo_t info,
                                                       std::uint64_t address, void* user),
                                      qemu_plugin_cb_flags flags, qemu_plugin_mem_rw which,
                                      void* user);

// A plugin must define these.
[[gnu::visibility("default")]] extern int qemu_plugin_version;
[[gnu::visibility("default")]] int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t* info,
                                                       int count, char** arguments);
}
// NOLINTEND(readability-identifier-naming)
