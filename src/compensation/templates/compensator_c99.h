/* Compensator of one machine, written by $PROGRAM$. Do not edit: export again.
 *
 *   robot        $ROBOT$
 *   calibration  $CALIBRATION$
 *   SHA-256      $SHA256$
 *   date         $DATE$
 *   units        mm and rad, joints in $JOINT_UNIT$; poses in the base frame: origin at the base centre, z up
 *   way          exact: inverse of the identified machine with all its errors
 *
 * Use:
 *
 *   double joints[PARACAL_LIMBS] = {where the machine stands, $JOINT_UNIT$};
 *   in every cycle: if (paracal_compensate(x, y, z, phi, joints, 0) != PARACAL_OK) stop on path, joints are the last good
 *
 * Once, at start: paracal_self_test() must return 0. It computes $TESTS$ poses and compares.
 * Where the machine stands: paracal_forward(joints, pose) gives the pose of joints.
 *
 * C99, freestanding, no state, no allocation, bounded time. The four functions below are all it needs.
 */
#ifndef PARACAL_COMPENSATOR_H
#define PARACAL_COMPENSATOR_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "unreachable poses are told by numbers that are not finite: compile without -ffinite-math-only"
#endif

double sqrt(double);
double sin(double);
double cos(double);
double atan2(double, double);

#define PARACAL_ROBOT "$ROBOT$"
#define PARACAL_CALIBRATION_SHA256 "$SHA256$"
#define PARACAL_DATE "$DATE$"
#define PARACAL_LIMBS $LIMBS$
#define PARACAL_ON_RAILS $ON_RAILS$ /* 0: the joints turn arms; 1: carriages run along rails */
#define PARACAL_TILTS_PLATE $TILTS_PLATE$ /* 1: errors of the parallelograms are known, the closed form is refined */
#define PARACAL_UNKNOWNS (PARACAL_LIMBS + 3)

enum paracal_status {
  PARACAL_OK = 0,
  PARACAL_UNREACHABLE = 1, /* an arm and its rods do not meet there, or a rigid plate is asked to turn */
  PARACAL_NOT_FINITE = 2,  /* the pose holds NaN or infinity */
  PARACAL_SINGULAR = 3     /* the machine does not hold the plate there */
};

/* One limb, errors included [huang2016, Eq. (1)]. */
struct paracal_limb {
  double base[3], radial[3], normal[3], axis[3]; /* b_i and u_0, v_0, w_0, in the base frame */
  double plate[3], slide[3];                     /* a_i, and its motion a rad of phi, in the plate frame */
  double elbow_half[3], plate_half[3];           /* half the short sides: along u_1, v_1, w_0; in the plate frame */
  double rod[2], arm, joint_offset;
};

static const struct paracal_limb paracal_limbs[PARACAL_LIMBS] = {
$LIMB_CONSTANTS$};

/* Both are false for NaN. */
static inline int paracal_is_finite(double value) { return value - value == 0.0; }
static inline double paracal_abs(double value) { return value < 0.0 ? -value : value; }

static inline double paracal_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* out = x a + y b + z c */
static inline void paracal_combine(const double weights[3], const double a[3], const double b[3], const double c[3],
                                   double out[3]) {
  int k;
  for (k = 0; k < 3; ++k) out[k] = weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k];
}

static inline void paracal_cross(const double a[3], const double b[3], double out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Plate level, mean rod. Arms: elbow outward, A cos(th) + B sin(th) = K; rails: carriage above the plate,
 * |d + L u_0 - q v_0| = l. NaN when out of reach. */
static inline double paracal_level_joint(const struct paracal_limb* limb, const double pose[4]) {
  double d[3], a, b, k, w, rod;
  int i;
  for (i = 0; i < 3; ++i) d[i] = pose[i] + (limb->plate[i] + pose[3] * limb->slide[i]) - limb->base[i];
  rod = 0.5 * (limb->rod[0] + limb->rod[1]);
#if PARACAL_ON_RAILS
  a = paracal_dot(d, limb->radial) + limb->arm;
  b = paracal_dot(d, limb->axis);
  k = paracal_dot(d, limb->normal);
  w = sqrt(rod * rod - a * a - b * b);
  return k + w - limb->joint_offset;
#else
  a = 2.0 * limb->arm * paracal_dot(d, limb->radial);
  b = 2.0 * limb->arm * paracal_dot(d, limb->normal);
  k = paracal_dot(d, d) + limb->arm * limb->arm - rod * rod;
  w = sqrt(a * a + b * b - k * k);
  if (!(b < 0.0)) w = -w;
  return atan2(b * k + a * w, a * k - b * w) - limb->joint_offset;
#endif
}

/* The elbow (on a rail the carriage): its centre from the base joint, how that moves with the joint, and the directions
 * u_1, v_1 that its short side keeps. */
struct paracal_elbow {
  double centre[3], motion[3], u1[3], v1[3];
};

static inline void paracal_elbow_at(const struct paracal_limb* limb, double joint, struct paracal_elbow* elbow) {
  const double q = joint + limb->joint_offset;
  int k;
#if PARACAL_ON_RAILS
  for (k = 0; k < 3; ++k) {
    elbow->u1[k] = limb->radial[k];
    elbow->v1[k] = limb->normal[k];
    elbow->centre[k] = q * limb->normal[k] - limb->arm * limb->radial[k];
    elbow->motion[k] = limb->normal[k];
  }
#else
  const double c = cos(q), s = sin(q);
  for (k = 0; k < 3; ++k) {
    elbow->u1[k] = c * limb->radial[k] + s * limb->normal[k];
    elbow->v1[k] = c * limb->normal[k] - s * limb->radial[k];
    elbow->centre[k] = limb->arm * elbow->u1[k];
    elbow->motion[k] = limb->arm * elbow->v1[k];
  }
#endif
}

/* Elimination with the largest pivot of each column on `size` rows of size + 1; not finite where they are singular. */
static inline void paracal_solve(int size, double* rows, double* out) {
  const int width = size + 1;
  int k, r, c;
  for (k = 0; k < size; ++k) {
    int pivot = k;
    for (r = k + 1; r < size; ++r) {
      if (paracal_abs(rows[r * width + k]) > paracal_abs(rows[pivot * width + k])) pivot = r;
    }
    for (c = 0; c < width; ++c) {
      const double other = rows[pivot * width + c];
      rows[pivot * width + c] = rows[k * width + c];
      rows[k * width + c] = other;
    }
    for (r = k + 1; r < size; ++r) {
      const double factor = rows[r * width + k] / rows[k * width + k];
      for (c = k + 1; c < width; ++c) rows[r * width + c] -= factor * rows[k * width + c];
    }
  }
  for (k = size - 1; k >= 0; --k) {
    out[k] = rows[k * width + size];
    for (c = k + 1; c < size; ++c) out[k] -= rows[k * width + c] * out[c];
    out[k] /= rows[k * width + k];
  }
}

#if PARACAL_TILTS_PLATE

/* Columns x, y, z of R = Rot(x, t0) Rot(y, t1) Rot(z, t2), and the axes of the three angles. */
struct paracal_frame {
  double x[3], y[3], z[3], axes[3][3];
};

static inline void paracal_plate_frame(const double tilt[3], struct paracal_frame* frame) {
  const double ca = cos(tilt[0]), sa = sin(tilt[0]), cb = cos(tilt[1]), sb = sin(tilt[1]), cg = cos(tilt[2]),
               sg = sin(tilt[2]);
  const struct paracal_frame value = {{cb * cg, ca * sg + sa * sb * cg, sa * sg - ca * sb * cg},
                                      {-cb * sg, ca * cg - sa * sb * sg, sa * cg + ca * sb * sg},
                                      {sb, -sa * cb, ca * cb},
                                      {{1.0, 0.0, 0.0}, {0.0, ca, sa}, {sb, -sa * cb, ca * cb}}};
  *frame = value;
}

/* Adds both rods of limb i to J^T (f + J_q dq + J_tilt dtilt) = 0; the last column is the right-hand side. */
static inline void paracal_add_limb(double rows[PARACAL_UNKNOWNS][PARACAL_UNKNOWNS + 1], int i, const double pose[4],
                                    const struct paracal_frame* frame, double joint) {
  const struct paracal_limb* limb = &paracal_limbs[i];
  struct paracal_elbow elbow;
  double half[3], slide[3];
  int j, k, r;
  paracal_elbow_at(limb, joint, &elbow);
  paracal_combine(limb->elbow_half, elbow.u1, elbow.v1, limb->axis, half);
  paracal_combine(limb->slide, frame->x, frame->y, frame->z, slide);
  for (j = 0; j < 2; ++j) {
    const double side = j == 0 ? 1.0 : -1.0;
    double hinge[3], on_plate[3], lever[3], n[3], moment[3], motion[3], gradient[PARACAL_UNKNOWNS], length, by_joint;
#if !PARACAL_ON_RAILS
    double turned[3];
#endif
    for (k = 0; k < 3; ++k) {
      hinge[k] = elbow.centre[k] + side * half[k];
      on_plate[k] = limb->plate[k] + pose[3] * limb->slide[k] + side * limb->plate_half[k];
    }
    paracal_combine(on_plate, frame->x, frame->y, frame->z, lever);
    for (k = 0; k < 3; ++k) n[k] = pose[k] - limb->base[k] + lever[k] - hinge[k];
    length = sqrt(paracal_dot(n, n));
    for (k = 0; k < 3; ++k) n[k] /= length;
    paracal_cross(lever, n, moment);
    for (k = 0; k < 3; ++k) motion[k] = elbow.motion[k];
#if !PARACAL_ON_RAILS
    paracal_cross(limb->axis, half, turned); /* the short side turns with the arm */
    for (k = 0; k < 3; ++k) motion[k] += side * turned[k];
#endif
    by_joint = -paracal_dot(n, motion);
    for (k = 0; k < 3; ++k) {
      gradient[k] = n[k];
      gradient[PARACAL_LIMBS + k] = paracal_dot(frame->axes[k], moment);
    }
    if (PARACAL_LIMBS == 4) gradient[3] = paracal_dot(n, slide);
    for (r = 0; r < PARACAL_UNKNOWNS; ++r) {
      rows[r][i] += gradient[r] * by_joint;
      for (k = PARACAL_LIMBS; k < PARACAL_UNKNOWNS; ++k) rows[r][k] += gradient[r] * gradient[k];
      rows[r][PARACAL_UNKNOWNS] -= gradient[r] * (length - limb->rod[j]);
    }
  }
}

/* Newton on joints and tilt, position and slide held on the pose. It gains three to five digits a step; 20 steps are
 * the most. */
static inline int paracal_settle(const double pose[4], double joints[PARACAL_LIMBS], double tilt[3]) {
  int iteration, i, k, r;
  for (iteration = 0; iteration < 20; ++iteration) {
    double rows[PARACAL_UNKNOWNS][PARACAL_UNKNOWNS + 1], step[PARACAL_UNKNOWNS], largest = 0.0;
    struct paracal_frame frame;
    for (r = 0; r < PARACAL_UNKNOWNS; ++r) {
      for (k = 0; k <= PARACAL_UNKNOWNS; ++k) rows[r][k] = 0.0;
    }
    paracal_plate_frame(tilt, &frame);
    for (i = 0; i < PARACAL_LIMBS; ++i) paracal_add_limb(rows, i, pose, &frame, joints[i]);
    paracal_solve(PARACAL_UNKNOWNS, &rows[0][0], step);
    for (k = 0; k < PARACAL_UNKNOWNS; ++k) {
      if (!paracal_is_finite(step[k])) return PARACAL_SINGULAR;
    }
    for (i = 0; i < PARACAL_LIMBS; ++i) {
      joints[i] += step[i];
      if (paracal_abs(step[i]) > largest) largest = paracal_abs(step[i]);
    }
    for (k = 0; k < 3; ++k) tilt[k] += step[PARACAL_LIMBS + k];
    if (largest < $STEP_TOLERANCE$) return PARACAL_OK;
  }
  return PARACAL_SINGULAR;
}

#endif

/* Joint coordinates ($JOINT_UNIT$) that bring the plate centre to x, y, z (mm) and the end-effector to phi (rad; 0 for a
 * rigid plate). joints_$JOINT_UNIT$, and tilt_rad where it is not 0 (the tilt about x and y that remains), are written when the
 * result is PARACAL_OK and left as they are otherwise. Returns a paracal_status. */
static inline int paracal_compensate(double x_mm, double y_mm, double z_mm, double phi_rad,
                                     double joints_$JOINT_UNIT$[PARACAL_LIMBS], double tilt_rad[2]) {
  const double pose[4] = {x_mm, y_mm, z_mm, phi_rad};
  double joints[PARACAL_LIMBS], tilt[3] = {0.0, 0.0, 0.0};
  int i;
  for (i = 0; i < 4; ++i) {
    if (!paracal_is_finite(pose[i])) return PARACAL_NOT_FINITE;
  }
  if (PARACAL_LIMBS == 3 && (phi_rad < 0.0 || phi_rad > 0.0)) return PARACAL_UNREACHABLE;
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    joints[i] = paracal_level_joint(&paracal_limbs[i], pose);
    if (!paracal_is_finite(joints[i])) return PARACAL_UNREACHABLE;
  }
#if PARACAL_TILTS_PLATE
  if (paracal_settle(pose, joints, tilt) != PARACAL_OK) return PARACAL_SINGULAR;
#endif
  for (i = 0; i < PARACAL_LIMBS; ++i) joints_$JOINT_UNIT$[i] = joints[i];
  if (tilt_rad) {
    tilt_rad[0] = tilt[0];
    tilt_rad[1] = tilt[1];
  }
  return PARACAL_OK;
}

/* Poses, and the joints that the library found for them. */
struct paracal_test {
  double pose[4];
  double joints[PARACAL_LIMBS];
};

static const struct paracal_test paracal_tests[$TESTS$] = {
$TEST_VECTOR$};

/* One row of Newton's equations for the pose: n (dX + slide dphi) = n (dC/dq) dq, n the direction of the mean rod. Errors
 * of the tilt group change these rows by their own size alone, so the iteration still settles quickly. */
static inline void paracal_forward_row(const struct paracal_limb* limb, const double pose[4], double joint, double change,
                                       double row[PARACAL_LIMBS + 1]) {
  struct paracal_elbow elbow;
  double n[3];
  int k;
  paracal_elbow_at(limb, joint, &elbow);
  for (k = 0; k < 3; ++k) n[k] = pose[k] + limb->plate[k] + pose[3] * limb->slide[k] - limb->base[k] - elbow.centre[k];
  for (k = 0; k < 3; ++k) row[k] = n[k];
  if (PARACAL_LIMBS == 4) row[3] = paracal_dot(n, limb->slide);
  row[PARACAL_LIMBS] = paracal_dot(n, elbow.motion) * change;
}

/* The pose (mm, rad) that the identified machine takes with these joints ($JOINT_UNIT$): the inverse of paracal_compensate, by
 * Newton from `pose`, or from the centre of the workspace where that cannot be taken; at most 50 steps, halved where they
 * leave the machine's reach. `pose` is written when the result is PARACAL_OK and left as it is otherwise. */
static inline int paracal_forward(const double joints_$JOINT_UNIT$[PARACAL_LIMBS], double pose[4]) {
  double at[4], joints[PARACAL_LIMBS], next[4], step[PARACAL_LIMBS] = {0.0}, fraction = 1.0, largest;
  int count, i, k;
  for (k = 0; k < PARACAL_LIMBS; ++k) {
    if (!paracal_is_finite(joints_$JOINT_UNIT$[k])) return PARACAL_NOT_FINITE;
  }
  for (k = 0; k < 4; ++k) at[k] = pose[k];
  if (paracal_compensate(at[0], at[1], at[2], at[3], joints, 0) != PARACAL_OK) {
    for (k = 0; k < 4; ++k) at[k] = paracal_tests[0].pose[k];
    if (paracal_compensate(at[0], at[1], at[2], at[3], joints, 0) != PARACAL_OK) return PARACAL_SINGULAR;
  }
  for (count = 0; count < 50; ++count) {
    if (fraction >= 1.0) {
      double rows[PARACAL_LIMBS][PARACAL_LIMBS + 1];
      for (i = 0; i < PARACAL_LIMBS; ++i) {
        paracal_forward_row(&paracal_limbs[i], at, joints[i], joints_$JOINT_UNIT$[i] - joints[i], rows[i]);
      }
      paracal_solve(PARACAL_LIMBS, &rows[0][0], step);
    }
    largest = 0.0;
    for (k = 0; k < 4; ++k) {
      next[k] = at[k] + (k < PARACAL_LIMBS ? fraction * step[k] : 0.0);
      if (paracal_abs(next[k] - at[k]) > largest) largest = paracal_abs(next[k] - at[k]);
      if (!paracal_is_finite(next[k])) return PARACAL_SINGULAR;
    }
    if (paracal_compensate(next[0], next[1], next[2], next[3], joints, 0) != PARACAL_OK) {
      fraction *= 0.5;
      continue;
    }
    fraction = 1.0;
    for (k = 0; k < 4; ++k) at[k] = next[k];
    if (largest < 1e-9) {
      for (k = 0; k < 4; ++k) pose[k] = at[k];
      return PARACAL_OK;
    }
  }
  return PARACAL_UNREACHABLE;
}

/* 0: every joint within $JOINT_TOLERANCE$ $JOINT_UNIT$, and back from the joints within 1e-6 mm; otherwise the number, from 1, of the first
 * pose that is not. */
static inline int paracal_self_test(void) {
  int k, i;
  for (k = 0; k < $TESTS$; ++k) {
    const struct paracal_test* test = &paracal_tests[k];
    double joints[PARACAL_LIMBS], pose[4] = {0.0, 0.0, 0.0, 0.0};
    if (paracal_compensate(test->pose[0], test->pose[1], test->pose[2], test->pose[3], joints, 0) != PARACAL_OK) {
      return k + 1;
    }
    for (i = 0; i < PARACAL_LIMBS; ++i) {
      if (!(paracal_abs(joints[i] - test->joints[i]) < $JOINT_TOLERANCE$)) return k + 1;
    }
    if (paracal_forward(joints, pose) != PARACAL_OK) return k + 1;
    for (i = 0; i < 4; ++i) {
      if (!(paracal_abs(pose[i] - test->pose[i]) < 1e-6)) return k + 1;
    }
  }
  return 0;
}

#endif
