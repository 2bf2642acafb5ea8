#pragma once
// The record of a processor fault, which outlives the reset that follows it. On a Cortex-M the
// library has the handler: let the entries of your vector table for NMI, hard fault, memory
// management, bus and usage fault branch to tactree_fault. It stores registers and cause and resets
// the processor; the motors must be off after a reset.
//
// The record is in the section .noinit, which your start-up must not clear. If the symbols
// image_stack_bottom and image_stack_top are defined (`-Wl,--defsym=image_stack_bottom=...`), a
// fault by overflow of the stack is recorded, too; the stack must then have no variables below it.

#include "tactree/hal/captured_fault.hpp"

namespace tactree::runtime {

/// Stores the record and resets.
[[noreturn]] void capture(const hal::CapturedFault& fault);

/// Returns the processor fault that ended the last run. A second call returns an empty record.
[[nodiscard]] hal::CapturedFault take_captured_fault();

/// Resets the processor. RAM that start-up does not initialise keeps its content. On a Cortex-M
/// part of the library; otherwise the firmware defines it.
[[noreturn]] void reset();

}  // namespace tactree::runtime

extern "C" void tactree_fault();
