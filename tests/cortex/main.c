/* Runs an exported header on a Cortex-M of qemu, for tools/cortex.sh. It prints the instructions of one call, mean and
 * largest over the poses, and the largest difference from the expected joints. Otherwise it prints what went wrong. */
#include <stdint.h>
#include <stdio.h>

#include "compensator.h"

static const struct {
  double pose[6]; /* mm and rad */
  double joints[PARACAL_LIMBS];
} cases[] = {
#include "cases.h"
};

/* qemu lets each instruction take 1 ns, and the board's clock has 25 MHz. A tick is thus 40 instructions, and 40 calls
 * take as many ticks as one takes instructions. */
#define CALLS 40
static volatile uint32_t* const sys_tick = (volatile uint32_t*)0xE000E010U; /* control, reload, value (24 bits, down) */

/* noipa: called as from another file, so that no call is moved or left out. */
static __attribute__((noipa)) int compensate(const double pose[6], double joints[PARACAL_LIMBS]) {
  return paracal_compensate(pose, joints, NULL);
}

static __attribute__((noipa)) int nothing(const double pose[6], double joints[PARACAL_LIMBS]) {
  (void)pose;
  (void)joints;
  return PARACAL_OK;
}

static uint32_t ticks(int (*call)(const double*, double*), const double* pose, double* joints) {
  const uint32_t start = sys_tick[2];
  int k;
  for (k = 0; k < CALLS; ++k) (void)call(pose, joints);
  return (start - sys_tick[2]) & 0xFFFFFFU;
}

int main(void) {
  const unsigned count = sizeof(cases) / sizeof(cases[0]);
  const int tested = paracal_self_test();
  double sum = 0.0, worst = 0.0;
  uint32_t most = 0;
  unsigned k;
  if (tested != 0) return printf("self-test: expected 0, got %d\n", tested);
  sys_tick[1] = 0xFFFFFFU;
  sys_tick[0] = 5U; /* on, with the processor's clock */
  for (k = 0; k < count; ++k) {
    double joints[PARACAL_LIMBS];
    const uint32_t empty = ticks(nothing, cases[k].pose, joints);
    const uint32_t instructions = ticks(compensate, cases[k].pose, joints) - empty;
    const int result = compensate(cases[k].pose, joints);
    const double apart = paracal_apart(cases[k].joints, joints);
    if (result != PARACAL_OK) return printf("pose %u: expected PARACAL_OK, got %d\n", k + 1U, result);
    sum += instructions;
    if (instructions > most) most = instructions;
    if (!(apart <= worst)) worst = apart;
  }
  return printf("%.0f instructions a call, at most %lu; joints within %.2g rad\n", sum / count, (unsigned long)most,
                worst);
}

/* What newlib leaves to the board: after a reset, enable the floating-point unit and begin. _start calls main. */
void _start(void);
static void reset(void) {
  *(volatile uint32_t*)0xE000ED88U |= 0xF00000U;
  __asm__ volatile("dsb\n isb");
  _start();
}

static const struct {
  uint32_t stack;
  void (*reset)(void);
} vectors __attribute__((section(".vectors"), used)) = {0x400000U, reset};
