// Random123 wants to be told that it was tried on a machine; what runs is its plain C, which knows nothing of any.
#define __riscv 1  // NOLINT(bugprone-reserved-identifier)
#include_next <Random123/philox.h>
#undef __riscv
