/* Compensator of one machine, $PLATE$, written by $PROGRAM$. Do not edit: export again.
 *
 *   robot        $ROBOT$
 *   calibration  $CALIBRATION$
 *   SHA-256      $SHA256$
 *   date         $DATE$$C_REMARKS$
 *   units        mm and rad, joints in $JOINT_UNIT$; poses in the base frame, z up: x, y, z of the plate's origin, then tilt_x,
 *                tilt_y, tilt_z; rotation of the plate R = Rot(x, tilt_x) Rot(y, tilt_y) Rot(z, tilt_z)
 *   method       exact: inverse of the identified machine with all its errors, in closed form
 *   operations   $OPERATIONS$
 *
 * Use:
 *
 *   double joints[PARACAL_LIMBS] = {where the machine stands, $JOINT_UNIT$};
 *   const double pose[6] = {x, y, z, tilt_x, tilt_y, tilt_z};
 *   in every cycle: if (paracal_compensate(pose, joints) != PARACAL_OK) stop on the path;
 *   joints then keep the last valid values
 *
 * At start: paracal_self_test() must return 0. It computes $TESTS$ poses and compares them.
 * Present pose: paracal_forward(joints, pose) gives the pose of the joints, near the pose that it is given;
 * paracal_home(pose) gives a first one.
 *
 * C99 and C++, freestanding, no state, no allocation, bounded time. It needs the functions declared below from a library.
 *
 * MISRA C:2012 as checked by cppcheck's add-on, except 2.5 (macros for the including program), 15.5 (early return for a
 * pose without solution) and 21.2 (functions of the library, declared if there is no math.h).
 */
#ifndef PARACAL_COMPENSATOR_H
#define PARACAL_COMPENSATOR_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "poses without solution are detected by non-finite numbers: compile without -ffinite-math-only"
#endif

#if defined(__cplusplus) || (defined(__STDC_HOSTED__) && (__STDC_HOSTED__ == 1) && !defined(__KERNEL__))
#include <math.h>
#else
double sqrt(double x);
double sin(double x);
double cos(double x);
$ARCTANGENT$#endif

#ifdef __cplusplus
extern "C" {
#endif

#define PARACAL_ROBOT "$ROBOT$"
#define PARACAL_CALIBRATION_SHA256 "$SHA256$"
#define PARACAL_DATE "$DATE$"
#define PARACAL_LIMBS $LIMBS$
#define PARACAL_ROWS $ROW_COUNT$ /* PARACAL_LIMBS squared */

/* What functions return. */
#define PARACAL_OK 0
#define PARACAL_UNREACHABLE 1 /* a limb cannot reach the pose; forward: no pose near the start has these joints */
#define PARACAL_NOT_FINITE 2  /* the pose, or a joint, is NaN or infinity */
#define PARACAL_SINGULAR 3    /* the limbs do not hold the plate there */

/* One limb with its errors: $EQUATION$. */
struct paracal_limb {
$LIMB_MEMBERS$};

static const struct paracal_limb paracal_limbs[PARACAL_LIMBS] = {
$LIMB_CONSTANTS$};

$GUIDE_CONSTANTS$/* Both are false for NaN. */
static inline int paracal_is_finite(double value) { return (value - value) == 0.0; }
static inline double paracal_abs(double value) { return (value < 0.0) ? -value : value; }

/* The code without loops below was generated from one formula without this machine's zeros: the joints of a pose. */
static inline void paracal_joints(const double pose[6], double joints[PARACAL_LIMBS]) {
  const struct paracal_limb* const limb = paracal_limbs;
$JOINTS$}

/* The same, and the rows of their derivative by the pose. */
static inline void paracal_rows(const double pose[6], double joints[PARACAL_LIMBS], double rows[PARACAL_ROWS]) {
  const struct paracal_limb* const limb = paracal_limbs;
$ROWS$}

/* The largest difference of two sets of joints; not finite if one of them is not. */
static inline double paracal_apart(const double a[PARACAL_LIMBS], const double b[PARACAL_LIMBS]) {
  double largest = 0.0;
  int i;
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    const double apart = paracal_abs(a[i] - b[i]);
    if ((!(apart <= largest)) && paracal_is_finite(largest)) { largest = apart; } /* keep a value that is not finite */
  }
  return largest;
}

/* Joint coordinates ($JOINT_UNIT$) that bring the plate to a pose (mm, rad). They are written if the result is PARACAL_OK,
 * else unchanged. */
static inline int paracal_compensate(const double pose[6], double joints[PARACAL_LIMBS]) {
  double found[PARACAL_LIMBS];
  int i;
  for (i = 0; i < 6; ++i) {
    if (!paracal_is_finite(pose[i])) { return PARACAL_NOT_FINITE; }
$GUIDE_CHECK$  }
  paracal_joints(pose, found);
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    if (!paracal_is_finite(found[i])) { return PARACAL_UNREACHABLE; }
  }
  for (i = 0; i < PARACAL_LIMBS; ++i) { joints[i] = found[i]; }
  return PARACAL_OK;
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

/* Solves rows x = right by elimination with row pivoting; x replaces `right`. */
static inline int paracal_solve(double rows[PARACAL_ROWS], double right[PARACAL_LIMBS]) {
  int column;
  int row;
  int k;
  for (column = 0; column < PARACAL_LIMBS; ++column) {
    int pivot = column;
    double kept;
    for (row = column + 1; row < PARACAL_LIMBS; ++row) {
      if (paracal_abs(rows[(PARACAL_LIMBS * row) + column]) > paracal_abs(rows[(PARACAL_LIMBS * pivot) + column])) { pivot = row; }
    }
    for (k = 0; k < PARACAL_LIMBS; ++k) {
      kept = rows[(PARACAL_LIMBS * column) + k];
      rows[(PARACAL_LIMBS * column) + k] = rows[(PARACAL_LIMBS * pivot) + k];
      rows[(PARACAL_LIMBS * pivot) + k] = kept;
    }
    kept = right[column];
    right[column] = right[pivot];
    right[pivot] = kept;
    for (row = column + 1; row < PARACAL_LIMBS; ++row) {
      const double share = rows[(PARACAL_LIMBS * row) + column] / rows[(PARACAL_LIMBS * column) + column];
      for (k = column; k < PARACAL_LIMBS; ++k) { rows[(PARACAL_LIMBS * row) + k] = rows[(PARACAL_LIMBS * row) + k] - (share * rows[(PARACAL_LIMBS * column) + k]); }
      right[row] = right[row] - (share * right[column]);
    }
  }
  for (row = PARACAL_LIMBS - 1; row >= 0; --row) {
    for (k = row + 1; k < PARACAL_LIMBS; ++k) { right[row] = right[row] - (rows[(PARACAL_LIMBS * row) + k] * right[k]); }
    right[row] = right[row] / rows[(PARACAL_LIMBS * row) + row];
    if (!paracal_is_finite(right[row])) { return PARACAL_SINGULAR; }
  }
  return PARACAL_OK;
}

/* The pose (mm, rad) of the identified machine with these joints ($JOINT_UNIT$): the inverse of paracal_compensate, by
 * Newton's method from `pose`, in the assembly mode of `pose`: give the last pose, or a commanded one nearby. At most 50
 * steps; a step is halved if it does not reduce the joint error. `pose` is written if the result is PARACAL_OK, else
 * unchanged. */
static inline int paracal_forward(const double wanted[PARACAL_LIMBS], double pose[6]) {
  static const int paracal_free[PARACAL_LIMBS] = {$FREE$}; /* free coordinates of a pose: their places */
  double at[6];
  double next[6];
  double joints[PARACAL_LIMBS];
  double rows[PARACAL_ROWS];
  double step[PARACAL_LIMBS];
  double fraction = 1.0;
  double apart;
  int count;
  int k;
  for (k = 0; k < 6; ++k) {
    if (!paracal_is_finite(pose[k])) { return PARACAL_NOT_FINITE; }
    at[k] = pose[k];
$GUIDE_START$    next[k] = at[k];
  }
  for (k = 0; k < PARACAL_LIMBS; ++k) {
    if (!paracal_is_finite(wanted[k])) { return PARACAL_NOT_FINITE; }
    step[k] = 0.0;
  }
  paracal_rows(at, joints, rows);
  apart = paracal_apart(wanted, joints);
  for (count = 0; count < 50; ++count) {
    double largest = 0.0;
    double next_apart;
    if (fraction >= 1.0) {
      for (k = 0; k < PARACAL_LIMBS; ++k) { step[k] = wanted[k] - joints[k]; }
      if (paracal_solve(rows, step) != PARACAL_OK) { return PARACAL_SINGULAR; }
    }
    for (k = 0; k < PARACAL_LIMBS; ++k) {
      next[paracal_free[k]] = at[paracal_free[k]] + (fraction * step[k]);
      if (paracal_abs(fraction * step[k]) > largest) { largest = paracal_abs(fraction * step[k]); }
    }
    paracal_rows(next, joints, rows);
    next_apart = paracal_apart(wanted, joints);
    if ((next_apart < apart) || (largest < 1.0E-9)) {
      apart = next_apart;
      fraction = 1.0;
      for (k = 0; k < 6; ++k) { at[k] = next[k]; }
      if ((largest < 1.0E-9) && (apart < 1.0E-6)) {
        for (k = 0; k < 6; ++k) { pose[k] = at[k]; }
        return PARACAL_OK;
      }
    } else {
      fraction = 0.5 * fraction;
    }
  }
  return PARACAL_UNREACHABLE;
}

/* 0: every joint agrees within $JOINT_TOLERANCE$ $JOINT_UNIT$, and the pose found from the centre of the workspace within 1e-6 mm and
 * rad. Otherwise the number, from 1, of the first pose that does not. */
static inline int paracal_self_test(void) {
  int k;
  int i;
  for (k = 0; k < $TESTS$; ++k) {
    const struct paracal_test* const test = &paracal_tests[k];
    double joints[PARACAL_LIMBS];
    double pose[6];
    if (paracal_compensate(test->pose, joints) != PARACAL_OK) { return k + 1; }
    if (!(paracal_apart(joints, test->joints) < $JOINT_TOLERANCE$)) { return k + 1; }
    paracal_home(pose);
    if (paracal_forward(joints, pose) != PARACAL_OK) { return k + 1; }
    for (i = 0; i < 6; ++i) {
      if (!(paracal_abs(pose[i] - test->pose[i]) < 1.0E-6)) { return k + 1; }
    }
  }
  return 0;
}

#ifdef __cplusplus
}
#endif

#endif
