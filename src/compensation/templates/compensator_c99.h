/* Compensator of one machine, written by $PROGRAM$. Do not edit: export again.
 *
 *   robot        $ROBOT$
 *   calibration  $CALIBRATION$
 *   SHA-256      $SHA256$
 *   date         $DATE$$C_REMARKS$
 *   units        mm and rad, joints in $JOINT_UNIT$; poses in the base frame: origin at the base centre, z up
 *   method       exact: inverse of the identified machine with all its errors
 *   operations   $OPERATIONS$
 *
 * Use:
 *
 *   double joints[PARACAL_LIMBS] = {where the machine stands, $JOINT_UNIT$};
 *   in every cycle: if (paracal_compensate(x, y, z, phi, joints, NULL) != PARACAL_OK) stop on the path;
 *   joints then keep the last valid values
 *
 * At start: paracal_self_test() must return 0. It computes $TESTS$ poses and compares them.
 * Present pose: paracal_forward(joints, pose) gives the pose of the joints.
 *
 * C99 and C++, freestanding, no state, no allocation, bounded time. It needs sqrt, sin, cos and atan2 from a library.
 *
 * MISRA C:2012 as checked by cppcheck's add-on, except 2.5 (macros for the including program), 15.5 (early return for a
 * pose without solution) and 21.2 (the four functions above, declared if there is no math.h).
 */
#ifndef PARACAL_COMPENSATOR_H
#define PARACAL_COMPENSATOR_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "unreachable poses are detected by non-finite numbers: compile without -ffinite-math-only"
#endif

#include <stddef.h>
#if defined(__cplusplus) || (defined(__STDC_HOSTED__) && (__STDC_HOSTED__ == 1) && !defined(__KERNEL__))
#include <math.h>
#else
double sqrt(double x);
double sin(double x);
double cos(double x);
double atan2(double y, double x);
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define PARACAL_ROBOT "$ROBOT$"
#define PARACAL_CALIBRATION_SHA256 "$SHA256$"
#define PARACAL_DATE "$DATE$"
#define PARACAL_LIMBS $LIMBS$
#define PARACAL_ON_RAILS $ON_RAILS$ /* 0: the joints rotate arms; 1: carriages run on rails */
#define PARACAL_TILTS_PLATE $TILTS_PLATE$ /* 1: with errors of the parallelograms, the closed form is refined */

/* What functions return. */
#define PARACAL_OK 0
#define PARACAL_UNREACHABLE 1 /* an arm and its rods do not meet there, or a rigid plate should turn */
#define PARACAL_NOT_FINITE 2  /* the pose contains NaN or infinity */
#define PARACAL_SINGULAR 3    /* the limbs do not hold the plate there */

/* One limb with its errors [huang2016, Eq. (1)]. */
struct paracal_limb {
  double base[3];       /* b_i, in the base frame */
  double radial[3];     /* u_0, v_0, w_0: directions there */
  double normal[3];
  double axis[3];
  double plate[3];      /* a_i, in the plate frame */
  double slide[3];      /* its motion per rad of phi */
  double elbow_half[3]; /* half the short sides: along u_1, v_1, w_0 */
  double plate_half[3]; /* and in the plate frame */
  double rod[2];
  double arm;
  double joint_offset;
  double joint_per_mm; /* of a carriage: mm of the joint coordinate per mm of travel */
};

static const struct paracal_limb paracal_limbs[PARACAL_LIMBS] = {
$LIMB_CONSTANTS$};

/* Both are false for NaN. */
static inline int paracal_is_finite(double value) { return (value - value) == 0.0; }
static inline double paracal_abs(double value) { return (value < 0.0) ? -value : value; }

$STATE_DEFINED$/* The code without loops below was generated from the library's formulas (compensator.hpp) without this machine's
 * zeros. Joints for a level plate; NaN if the pose is out of reach. */
static inline void paracal_level(const double pose[4], double joints[PARACAL_LIMBS]$STATE_PARAMETER$) {
  const struct paracal_limb* const limb = paracal_limbs;
$LEVEL$}

/* The largest difference of two sets of joints. */
static inline double paracal_apart(const double a[PARACAL_LIMBS], const double b[PARACAL_LIMBS]) {
  double largest = 0.0;
  int i;
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    if (!(paracal_abs(a[i] - b[i]) <= largest)) { largest = paracal_abs(a[i] - b[i]); }
  }
  return largest;
}

/* The motion of the plate, mm and rad, for small changes of the joints. */
static inline void paracal_way_back(const double pose[4], const double joints[PARACAL_LIMBS],
                                    const double changes[PARACAL_LIMBS], double motion[PARACAL_LIMBS]) {
  const struct paracal_limb* const limb = paracal_limbs;
$WAY_BACK$}

/* Joint coordinates ($JOINT_UNIT$) that bring the plate centre to x, y, z (mm) and the end-effector to phi (rad; 0 for a
 * rigid plate). joints_$JOINT_UNIT$, and tilt_rad where it is not NULL (the tilt about x and y that remains), are written
 * if the result is PARACAL_OK, else unchanged. */
static inline int paracal_compensate(double x_mm, double y_mm, double z_mm, double phi_rad,
                                     double joints_$JOINT_UNIT$[PARACAL_LIMBS], double tilt_rad[2]) {
  const double pose[4] = {x_mm, y_mm, z_mm, phi_rad};
  double joints[PARACAL_LIMBS];
  int i;
#if PARACAL_TILTS_PLATE
  double state[PARACAL_STATE];
#endif
  for (i = 0; i < 4; ++i) {
    if (!paracal_is_finite(pose[i])) { return PARACAL_NOT_FINITE; }
  }
#if PARACAL_LIMBS == 3
  if ((phi_rad < 0.0) || (phi_rad > 0.0)) { return PARACAL_UNREACHABLE; }
#endif
#if PARACAL_TILTS_PLATE
  paracal_level(pose, joints, state);
#else
  paracal_level(pose, joints);
#endif
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    if (!paracal_is_finite(joints[i])) { return PARACAL_UNREACHABLE; }
  }
#if PARACAL_TILTS_PLATE
  if (paracal_settle(pose, state) != PARACAL_OK) { return PARACAL_SINGULAR; }
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    joints[i] += state[3 + i];
    if (!paracal_is_finite(joints[i])) { return PARACAL_SINGULAR; }
  }
#endif
  for (i = 0; i < PARACAL_LIMBS; ++i) { joints_$JOINT_UNIT$[i] = joints[i]; }
  if (tilt_rad != NULL) {
#if PARACAL_TILTS_PLATE
    tilt_rad[0] = state[0];
    tilt_rad[1] = state[1];
#else
    tilt_rad[0] = 0.0;
    tilt_rad[1] = 0.0;
#endif
  }
  return PARACAL_OK;
}

/* Poses, and their joints computed by the library. */
struct paracal_test {
  double pose[4];
  double joints[PARACAL_LIMBS];
};

static const struct paracal_test paracal_tests[$TESTS$] = {
$TEST_VECTOR$};

/* The pose (mm, rad) of the identified machine with these joints ($JOINT_UNIT$): the inverse of paracal_compensate, by
 * Newton's method from `pose`, or from the centre of the workspace if `pose` is out of reach. At most 50 steps; a step is
 * halved if it leaves the reach or does not reduce the joint error. `pose` is written if the result is PARACAL_OK, else
 * unchanged. */
static inline int paracal_forward(const double joints_$JOINT_UNIT$[PARACAL_LIMBS], double pose[4]) {
  double at[4];
  double next[4];
  double joints[PARACAL_LIMBS];
  double changes[PARACAL_LIMBS];
  double motion[PARACAL_LIMBS];
  double fraction = 1.0;
  double apart;
  int count;
  int k;
  for (k = 0; k < PARACAL_LIMBS; ++k) {
    motion[k] = 0.0;
    if (!paracal_is_finite(joints_$JOINT_UNIT$[k])) { return PARACAL_NOT_FINITE; }
  }
  for (k = 0; k < 4; ++k) { at[k] = pose[k]; }
  if (paracal_compensate(at[0], at[1], at[2], at[3], joints, NULL) != PARACAL_OK) {
    for (k = 0; k < 4; ++k) { at[k] = paracal_tests[0].pose[k]; }
    if (paracal_compensate(at[0], at[1], at[2], at[3], joints, NULL) != PARACAL_OK) { return PARACAL_SINGULAR; }
  }
  apart = paracal_apart(joints_$JOINT_UNIT$, joints);
  for (count = 0; count < 50; ++count) {
    double largest = 0.0;
    double next_apart;
    int result;
    if (fraction >= 1.0) {
      for (k = 0; k < PARACAL_LIMBS; ++k) { changes[k] = joints_$JOINT_UNIT$[k] - joints[k]; }
      paracal_way_back(at, joints, changes, motion);
    }
    for (k = 0; k < 4; ++k) { next[k] = at[k]; }
    for (k = 0; k < PARACAL_LIMBS; ++k) {
      next[k] = at[k] + (fraction * motion[k]);
      if (!paracal_is_finite(next[k])) { return PARACAL_SINGULAR; }
      if (paracal_abs(fraction * motion[k]) > largest) { largest = paracal_abs(fraction * motion[k]); }
    }
    result = paracal_compensate(next[0], next[1], next[2], next[3], joints, NULL);
    next_apart = paracal_apart(joints_$JOINT_UNIT$, joints);
    if ((result == PARACAL_OK) && ((next_apart < apart) || (largest < 1.0E-9))) {
      apart = next_apart;
      fraction = 1.0;
      for (k = 0; k < 4; ++k) { at[k] = next[k]; }
      if (largest < 1.0E-9) {
        for (k = 0; k < 4; ++k) { pose[k] = at[k]; }
        return PARACAL_OK;
      }
    } else {
      fraction = 0.5 * fraction;
    }
  }
  return PARACAL_UNREACHABLE;
}

/* 0: every joint agrees within $JOINT_TOLERANCE$ $JOINT_UNIT$, and the pose of the joints within 1e-6 mm. Otherwise the number,
 * from 1, of the first pose that does not. */
static inline int paracal_self_test(void) {
  int k;
  int i;
  for (k = 0; k < $TESTS$; ++k) {
    const struct paracal_test* const test = &paracal_tests[k];
    double joints[PARACAL_LIMBS];
    double pose[4] = {0.0, 0.0, 0.0, 0.0};
    if (paracal_compensate(test->pose[0], test->pose[1], test->pose[2], test->pose[3], joints, NULL) != PARACAL_OK) {
      return k + 1;
    }
    if (paracal_apart(joints, test->joints) >= $JOINT_TOLERANCE$) { return k + 1; }
    if (paracal_forward(joints, pose) != PARACAL_OK) { return k + 1; }
    for (i = 0; i < 4; ++i) {
      if (!(paracal_abs(pose[i] - test->pose[i]) < 1.0E-6)) { return k + 1; }
    }
  }
  return 0;
}

#ifdef __cplusplus
}
#endif

#endif
