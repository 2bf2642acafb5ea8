/* SPDX-License-Identifier: GPL-2.0 */
/* irq_to_desc() is the kernel's own; the same is had by two functions that a module may call. */
#include <linux/irq.h>
#define irq_to_desc(number) irq_data_to_desc(irq_get_irq_data(number))
