#define PARACAL_STATE $STATE_SIZE$ /* tilt (3), changes of the joints, positions of arms or carriages */
#define PARACAL_ANSWER $ANSWER_SIZE$ /* response of arms and plate to the rods */

/* For angles that are nearly always small: a series within $SERIES_REACH$ rad. */
static inline double paracal_turn_cosine(double angle) {
  double value;
  if (paracal_abs(angle) <= $SERIES_REACH$) {
$TURN_COSINE$  } else {
    value = cos(angle);
  }
  return value;
}

static inline double paracal_turn_sine(double angle) {
  double value;
  if (paracal_abs(angle) <= $SERIES_REACH$) {
$TURN_SINE$  } else {
    value = sin(angle);
  }
  return value;
}

static inline void paracal_answer(const double pose[4], const double state[PARACAL_STATE],
                                  double answer[PARACAL_ANSWER]) {
  const struct paracal_limb* const limb = paracal_limbs;
$ANSWER$}

/* One step towards the tilt at which the rods hold the plate; changes: rotations of arms and plate. */
static inline void paracal_step(const double pose[4], const double answer[PARACAL_ANSWER], double state[PARACAL_STATE],
                                double changes[PARACAL_LIMBS + 3]) {
  const struct paracal_limb* const limb = paracal_limbs;
$STEP$}

/* Steps until convergence: each leaves a thousandth of the error; at most $MOST_STEPS$ steps. */
static inline int paracal_settle(const double pose[4], double state[PARACAL_STATE]) {
  double answer[PARACAL_ANSWER];
  double changes[PARACAL_LIMBS + 3];
  double before = 1.0;
  int count;
  int k;
  paracal_answer(pose, state, answer);
  for (count = 0; count < $MOST_STEPS$; ++count) {
    double largest = 0.0;
    paracal_step(pose, answer, state, changes);
    for (k = 0; k < (PARACAL_LIMBS + 3); ++k) {
      if (!paracal_is_finite(changes[k])) { return PARACAL_SINGULAR; }
      if (paracal_abs(changes[k]) > largest) { largest = paracal_abs(changes[k]); }
    }
    if ((largest <= before) && ((largest * largest) <= ($SETTLED$ * before))) { return PARACAL_OK; }
    before = largest;
  }
  return PARACAL_SINGULAR;
}

