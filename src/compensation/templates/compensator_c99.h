/* Compensator of one machine, $PLATE$, written by $PROGRAM$. Do not edit: export again.
 *
 *   robot        $ROBOT$
 *   calibration  $CALIBRATION$
 *   SHA-256      $SHA256$
 *   date         $DATE$$C_REMARKS$
 *   units        mm and rad, joints in $JOINT_UNIT$; poses in the base frame, z up: x, y, z of the plate's origin, then
 *                $TURN_WORDS$
 *   method       $METHOD$
 *   error        $WORST$
 *   operations   $OPERATIONS$
 *
 * Use:
 *
 *   double joints[PARACAL_LIMBS] = {where the machine stands, $JOINT_UNIT$};
 *   const double pose[6] = {$POSE_WORDS$};
 *   in every cycle: if (paracal_compensate(pose, joints, NULL) != PARACAL_OK) stop on the path;
 *   joints then keep the last valid values
 *
 * At start: paracal_self_test() must return 0. It computes $TESTS$ poses and compares them.
 * Present pose: paracal_forward(joints, pose) gives the pose of the joints, near the pose that it is given;
 * paracal_home(pose) gives a first one.
 * Speeds: paracal_jacobian(pose, rates) gives d joints / d pose: speed of joint i = sum over k of
 * rates[PARACAL_FREE i + k] times the speed of pose[m], m = $PLACES$ for k = 0 to PARACAL_FREE - 1.
 * New numbers of a later calibration without a new program: paracal_start, paracal_change, paracal_cycle. Functions
 * without _with belong to the numbers of this file; the others take those in use: &machine.set[machine.used].
 *
 * C99 and C++, freestanding, no state of its own, no allocation, bounded time. It needs the functions declared below from
 * a library.
 *
 * MISRA C:2012 as checked by cppcheck's add-on, except 2.5 (macros for the including program), 15.5 (early return for a
 * pose without solution) and 21.2 (functions of the library, declared if there is no math.h).
 */
#ifndef PARACAL_COMPENSATOR_H
#define PARACAL_COMPENSATOR_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "poses without solution are detected by non-finite numbers: compile without -ffinite-math-only"
#endif

#include <stddef.h>
#if defined(__cplusplus) || (defined(__STDC_HOSTED__) && (__STDC_HOSTED__ == 1) && !defined(__KERNEL__))
#include <math.h>
#else
double sqrt(double x);
double sin(double x);
double cos(double x);
double atan2(double y, double x);
$SINGLE_FUNCTIONS$#endif

#ifdef __cplusplus
extern "C" {
#endif

#define PARACAL_ROBOT "$ROBOT$"
#define PARACAL_CALIBRATION_SHA256 "$SHA256$"
#define PARACAL_DATE "$DATE$"
#define PARACAL_LIMBS $LIMBS$
#define PARACAL_FREE $FREE$ /* coordinates of a pose that can be commanded */
#define PARACAL_NUMBERS $NUMBERS$
#define PARACAL_SET $SET$ /* numbers, layout and sum of a later calibration */
#define PARACAL_LAYOUT $LAYOUT$

/* What functions return. */
#define PARACAL_OK 0
#define PARACAL_UNREACHABLE 1 /* a limb cannot reach the pose, or the plate cannot be commanded there */
#define PARACAL_NOT_FINITE 2  /* the pose, or a joint, is NaN or infinity */
#define PARACAL_SINGULAR 3    /* the limbs do not hold the plate there */
#define PARACAL_REFUSED 4     /* a set of numbers that is not complete, or of another export */
#define PARACAL_BUSY 5        /* the last change is not over */

/* What cannot be commanded must be as here, within 1e-6. */
static const int paracal_is_held[6] = {$IS_HELD$};
static const double paracal_held[6] = {$HELD$};

/* The machine's numbers, errors included, mm and directions; 0 and 1 are omitted. */
struct paracal_numbers {
  double exact[PARACAL_NUMBERS];
$SINGLE_MEMBER$};

static const struct paracal_numbers paracal_identified = {{
$EXACT_NUMBERS$}$SINGLE_NUMBERS$};

/* Both are false for NaN. */
static inline int paracal_is_finite(double value) { return (value - value) == 0.0; }
static inline double paracal_abs(double value) { return (value < 0.0) ? -value : value; }

$STATE_DEFINED$/* The code without loops below was generated from the library's formulas (machine_closure.hpp) without this machine's
 * zeros. Joints in closed form; NaN if the pose is out of reach. */
static inline void paracal_closed(const double p[PARACAL_NUMBERS], const double pose[6],
                                  double joints[PARACAL_LIMBS]$STATE_PARAMETER$) {
$CLOSED$}

/* d joints / d pose, a row a limb. */
static inline void paracal_rates(const double p[PARACAL_NUMBERS], const double pose[6],
                                 double rates[PARACAL_LIMBS * PARACAL_FREE]) {
$RATES$}

$SEARCH$$DRIVES$/* PARACAL_OK if the plate can be commanded to a pose. */
static inline int paracal_check(const double pose[6]) {
  int k;
  for (k = 0; k < 6; ++k) {
    if (!paracal_is_finite(pose[k])) { return PARACAL_NOT_FINITE; }
  }
  for (k = 0; k < 6; ++k) {
    if ((paracal_is_held[k] != 0) && (paracal_abs(pose[k] - paracal_held[k]) > 1.0E-6)) { return PARACAL_UNREACHABLE; }
  }
  return PARACAL_OK;
}

/* paracal_compensate with other numbers. */
static inline int paracal_compensate_with(const struct paracal_numbers* numbers, const double pose[6],
                                          double joints[PARACAL_LIMBS], double plate[6]) {
  double found[PARACAL_LIMBS];
  int i;
  const int outcome = paracal_check(pose);
$STATE$  if (outcome != PARACAL_OK) { return outcome; }
  paracal_closed(numbers->exact, pose, found$STATE_ARGUMENT$);
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    if (!paracal_is_finite(found[i])) { return PARACAL_UNREACHABLE; }
  }
$SETTLE$$COMMAND$  for (i = 0; i < PARACAL_LIMBS; ++i) { joints[i] = found[i]; }
  if (plate != NULL) {
    for (i = 0; i < 6; ++i) { plate[i] = (paracal_is_held[i] != 0) ? paracal_held[i] : pose[i]; }
$PLATE_TILT$  }
  return PARACAL_OK;
}

/* Joint coordinates ($JOINT_UNIT$) that bring the plate to a pose (mm, rad). They are written if the result is PARACAL_OK,
 * else unchanged; so is plate, where it is not NULL: x, y, z and the three tilts that the plate then has$PLATE_REMARK$. */
static inline int paracal_compensate(const double pose[6], double joints[PARACAL_LIMBS], double plate[6]) {
  return paracal_compensate_with(&paracal_identified, pose, joints, plate);
}

/* paracal_jacobian with other numbers. */
static inline int paracal_jacobian_with(const struct paracal_numbers* numbers, const double pose[6],
                                        double rates[PARACAL_LIMBS * PARACAL_FREE]) {
  double found[PARACAL_LIMBS * PARACAL_FREE];
  double joints[PARACAL_LIMBS];
  int k;
  const int outcome = paracal_compensate_with(numbers, pose, joints, NULL);
  if (outcome != PARACAL_OK) { return outcome; }
  paracal_rates(numbers->exact, pose, found);
$COMMAND_RATES$  for (k = 0; k < (PARACAL_LIMBS * PARACAL_FREE); ++k) {
    if (!paracal_is_finite(found[k])) { return PARACAL_SINGULAR; }
  }
  for (k = 0; k < (PARACAL_LIMBS * PARACAL_FREE); ++k) { rates[k] = found[k]; }
  return PARACAL_OK;
}

/* d joints / d pose of paracal_compensate, $RATES_ERROR$. Written if the result is PARACAL_OK. */
static inline int paracal_jacobian(const double pose[6], double rates[PARACAL_LIMBS * PARACAL_FREE]) {
  return paracal_jacobian_with(&paracal_identified, pose, rates);
}

/* Poses, and their joints computed by the library. */
struct paracal_test {
  double pose[6];
  double joints[PARACAL_LIMBS];
};

static const struct paracal_test paracal_tests[$TESTS$] = {
$TEST_VECTOR$};

/* The centre of the workspace: a start if no better pose is known. From there paracal_forward finds the poses of the
 * self-test and usually every pose of the workspace; otherwise it returns an error. */
static inline void paracal_home(double pose[6]) {
  int k;
  for (k = 0; k < 6; ++k) { pose[k] = paracal_tests[0].pose[k]; }
}

/* The root of the sum of squares of the differences; not finite if a joint is not. */
static inline double paracal_apart(const double a[PARACAL_LIMBS], const double b[PARACAL_LIMBS]) {
  double squares = 0.0;
  int i;
  for (i = 0; i < PARACAL_LIMBS; ++i) { squares += (a[i] - b[i]) * (a[i] - b[i]); }
  return sqrt(squares);
}

/* The motion of the commanded coordinates that changes the joints so, by least squares: rates^T rates x = rates^T changes,
 * by elimination. x replaces the first of the changes. */
static inline int paracal_solve(const double rates[PARACAL_LIMBS * PARACAL_FREE], double changes[PARACAL_LIMBS]) {
  double normal[PARACAL_FREE][PARACAL_FREE + 1];
  int row;
  int column;
  int k;
  for (row = 0; row < PARACAL_FREE; ++row) {
    for (column = 0; column <= PARACAL_FREE; ++column) {
      normal[row][column] = 0.0;
      for (k = 0; k < PARACAL_LIMBS; ++k) {
        normal[row][column] += rates[(PARACAL_FREE * k) + row] *
                               ((column < PARACAL_FREE) ? rates[(PARACAL_FREE * k) + (column % PARACAL_FREE)] : changes[k]);
      }
    }
  }
  for (column = 0; column < PARACAL_FREE; ++column) {
    if (!(normal[column][column] > 0.0)) { return PARACAL_SINGULAR; }
    for (row = column + 1; row < PARACAL_FREE; ++row) {
      const double share = normal[row][column] / normal[column][column];
      for (k = column; k <= PARACAL_FREE; ++k) { normal[row][k] -= share * normal[column][k]; }
    }
  }
  for (row = PARACAL_FREE - 1; row >= 0; --row) {
    double rest = normal[row][PARACAL_FREE];
    for (k = row + 1; k < PARACAL_FREE; ++k) { rest -= normal[row][k] * changes[k]; }
    changes[row] = rest / normal[row][row];
    if (!paracal_is_finite(changes[row])) { return PARACAL_SINGULAR; }
  }
  return PARACAL_OK;
}

/* paracal_forward with other numbers. */
static inline int paracal_forward_with(const struct paracal_numbers* numbers, const double wanted[PARACAL_LIMBS],
                                       double pose[6]) {
  static const int places[PARACAL_FREE] = {$PLACES$}; /* of what can be commanded */
  double at[6];
  double next[6];
  double joints[PARACAL_LIMBS];
  double rates[PARACAL_LIMBS * PARACAL_FREE];
  double step[PARACAL_LIMBS];
  double fraction = 1.0;
  double apart;
  int count;
  int k;
  for (k = 0; k < 6; ++k) {
    if (!paracal_is_finite(pose[k])) { return PARACAL_NOT_FINITE; }
    at[k] = (paracal_is_held[k] != 0) ? paracal_held[k] : pose[k];
  }
  for (k = 0; k < PARACAL_LIMBS; ++k) {
    if (!paracal_is_finite(wanted[k])) { return PARACAL_NOT_FINITE; }
    step[k] = 0.0;
  }
  if (paracal_compensate_with(numbers, at, joints, NULL) != PARACAL_OK) {
    paracal_home(at);
    if (paracal_compensate_with(numbers, at, joints, NULL) != PARACAL_OK) { return PARACAL_SINGULAR; }
  }
  apart = paracal_apart(wanted, joints);
  for (count = 0; count < 50; ++count) {
    double largest = 0.0;
    double next_apart;
    int result;
    if (fraction >= 1.0) {
      paracal_rates(numbers->exact, at, rates);
      for (k = 0; k < PARACAL_LIMBS; ++k) { step[k] = wanted[k] - joints[k]; }
      if (paracal_solve(rates, step) != PARACAL_OK) { return PARACAL_SINGULAR; }
    }
    for (k = 0; k < 6; ++k) { next[k] = at[k]; }
    for (k = 0; k < PARACAL_FREE; ++k) {
      next[places[k]] = at[places[k]] + (fraction * step[k]);
      if (paracal_abs(fraction * step[k]) > largest) { largest = paracal_abs(fraction * step[k]); }
    }
    result = paracal_compensate_with(numbers, next, joints, NULL);
    next_apart = paracal_apart(wanted, joints);
    if ((result == PARACAL_OK) && ((next_apart < apart) || (largest < $SMALLEST_STEP$))) {
      apart = next_apart;
      fraction = 1.0;
      for (k = 0; k < 6; ++k) { at[k] = next[k]; }
      if ((largest < $SMALLEST_STEP$) && (apart < $AGREEMENT$)) {
        for (k = 0; k < 6; ++k) { pose[k] = at[k]; }
        return PARACAL_OK;
      }
    } else {
      fraction = 0.5 * fraction;
    }
  }
  return PARACAL_UNREACHABLE;
}

/* The pose (mm, rad) of the identified machine with these joints ($JOINT_UNIT$): the inverse of paracal_compensate, by
 * Newton's method from `pose`, in the assembly mode of `pose`: give the last pose, or a commanded one nearby. At most 50
 * steps; a step is halved if it leaves the reach or does not reduce the joint error. `pose` is written if the result is
 * PARACAL_OK, else unchanged. */
static inline int paracal_forward(const double wanted[PARACAL_LIMBS], double pose[6]) {
  return paracal_forward_with(&paracal_identified, wanted, pose);
}

/* A machine whose numbers may change while it runs. All three functions below belong to one thread. */
struct paracal_machine {
  struct paracal_numbers set[2];
  double cycles; /* of the change that goes on; 0: none does */
  double left;
  int used;
};

/* Begins with the numbers of this file. */
static inline void paracal_start(struct paracal_machine* machine) {
  machine->set[0] = paracal_identified;
  machine->set[1] = paracal_identified;
  machine->cycles = 0.0;
  machine->left = 0.0;
  machine->used = 0;
}

/* Begins a change to the numbers of a later calibration, over so many cycles (1: at once). The set comes from the key
 * `set` of the export for the target json. It is copied, then its copy is checked: one that is not complete, that is of
 * another robot or layout, or that does not reach the centre of the workspace, is refused and changes nothing. */
static inline int paracal_change(struct paracal_machine* machine, const double set[PARACAL_SET], double cycles) {
  struct paracal_numbers* const next = &machine->set[1 - machine->used];
  const double layout = set[PARACAL_NUMBERS];
  const double stated = set[PARACAL_NUMBERS + 1];
  double home[6];
  double joints[PARACAL_LIMBS];
  double sum = layout;
  double size = layout;
  double weight = 0.0;
  int is_whole = 1;
  int k;
  if (machine->cycles > 0.0) { return PARACAL_BUSY; }
  for (k = 0; k < PARACAL_NUMBERS; ++k) {
    const double number = set[k];
    next->exact[k] = number;
$SINGLE_COPY$    weight += 1.0;
    sum += weight * number;
    size += weight * paracal_abs(number);
    if (!((paracal_abs(number) > 0.0) && (paracal_abs(number) < 1.0E9))) { is_whole = 0; }
  }
  if ((is_whole == 0) || !(cycles >= 1.0) || !(cycles < 1.0E9) || !(paracal_abs(layout - PARACAL_LAYOUT) < 0.5) ||
      !(paracal_abs(sum - stated) <= (1.0E-13 * size))) {
    return PARACAL_REFUSED;
  }
  paracal_home(home);
  if (paracal_compensate_with(next, home, joints, NULL) != PARACAL_OK) { return PARACAL_REFUSED; }
  machine->cycles = cycles;
  machine->left = cycles;
  return PARACAL_OK;
}

/* paracal_compensate, once in a cycle. During a change the joints go from the old to the new ones in equal parts.
 * PARACAL_REFUSED before paracal_start. */
static inline int paracal_cycle(struct paracal_machine* machine, const double pose[6], double joints[PARACAL_LIMBS],
                                double plate[6]) {
  double now[PARACAL_LIMBS];
  double next[PARACAL_LIMBS];
  double there[6];
  int outcome = PARACAL_REFUSED;
  int i;
  if (paracal_abs(machine->set[0].exact[0]) > 0.0) {
    outcome = paracal_compensate_with(&machine->set[machine->used], pose, now, there);
  }
  if ((outcome == PARACAL_OK) && (machine->cycles > 0.0)) {
    outcome = paracal_compensate_with(&machine->set[1 - machine->used], pose, next, there);
    if (outcome == PARACAL_OK) {
      machine->left = (machine->left > 1.0) ? (machine->left - 1.0) : 0.0;
      for (i = 0; i < PARACAL_LIMBS; ++i) {
        now[i] = next[i] + ((machine->left / machine->cycles) * (now[i] - next[i]));
      }
      if (machine->left <= 0.0) {
        machine->cycles = 0.0;
        machine->used = 1 - machine->used;
      }
    }
  }
  if (outcome != PARACAL_OK) { return outcome; }
  for (i = 0; i < PARACAL_LIMBS; ++i) { joints[i] = now[i]; }
  if (plate != NULL) {
    for (i = 0; i < 6; ++i) { plate[i] = there[i]; }
  }
  return PARACAL_OK;
}

/* 0: every joint agrees within $JOINT_TOLERANCE$ ($JOINT_UNIT$), and the pose found from the centre of the workspace within
 * $POSE_TOLERANCE$ mm and rad. Otherwise the number, from 1, of the first pose that does not. */
static inline int paracal_self_test(void) {
  int k;
  int i;
  for (k = 0; k < $TESTS$; ++k) {
    const struct paracal_test* const test = &paracal_tests[k];
    double joints[PARACAL_LIMBS];
    double pose[6];
    if (paracal_compensate(test->pose, joints, NULL) != PARACAL_OK) { return k + 1; }
    if (!(paracal_apart(joints, test->joints) < $JOINT_TOLERANCE$)) { return k + 1; }
    paracal_home(pose);
    if (paracal_forward(joints, pose) != PARACAL_OK) { return k + 1; }
    for (i = 0; i < 6; ++i) {
      if (!(paracal_abs(pose[i] - test->pose[i]) < $POSE_TOLERANCE$)) { return k + 1; }
    }
  }
  return 0;
}

#ifdef __cplusplus
}
#endif

#endif
