/* For angles that are nearly always small: a series within $SERIES_REACH$ rad. */
static inline $REAL$ paracal_turn_cosine($REAL$ angle) {
  $REAL$ value;
  if ((angle <= $SERIES_REACH$) && (angle >= -$SERIES_REACH$)) {
$TURN_COSINE$  } else {
    value = $COSINE$(angle);
  }
  return value;
}

static inline $REAL$ paracal_turn_sine($REAL$ angle) {
  $REAL$ value;
  if ((angle <= $SERIES_REACH$) && (angle >= -$SERIES_REACH$)) {
$TURN_SINE$  } else {
    value = $SINE$(angle);
  }
  return value;
}

static inline void paracal_answer(const $REAL$ p[PARACAL_NUMBERS], const $REAL$ pose[6], const $REAL$ state[PARACAL_STATE],
                                  $REAL$ answer[PARACAL_ANSWER]) {
$ANSWER$}

/* One step towards the tilt at which the rods hold the plate; changes: rotations of arms and plate. */
static inline void paracal_step(const $REAL$ p[PARACAL_NUMBERS], const $REAL$ pose[6], const $REAL$ answer[PARACAL_ANSWER],
                                $REAL$ state[PARACAL_STATE], $REAL$ changes[PARACAL_LIMBS + 3]) {
$STEP$}

/* Steps towards balance: each leaves a thousandth of the error. PARACAL_STEPS of them; 0: until convergence, at most
 * $MOST_STEPS$. */
static inline int paracal_settle(const $REAL$ p[PARACAL_NUMBERS], const $REAL$ pose[6], $REAL$ state[PARACAL_STATE]) {
  $REAL$ answer[PARACAL_ANSWER];
  $REAL$ changes[PARACAL_LIMBS + 3];
#if PARACAL_STEPS == 0
  double before = 1.0;
#endif
  int count;
  int k;
  paracal_answer(p, pose, state, answer);
  for (count = 0; count < $STEP_LIMIT$; ++count) {
#if PARACAL_STEPS == 0
    double largest = 0.0;
#endif
    paracal_step(p, pose, answer, state, changes);
    for (k = 0; k < (PARACAL_LIMBS + 3); ++k) {
      if (!((changes[k] - changes[k]) == $ZERO$)) { return PARACAL_SINGULAR; }
#if PARACAL_STEPS == 0
      if (paracal_abs(changes[k]) > largest) { largest = paracal_abs(changes[k]); }
#endif
    }
#if PARACAL_STEPS == 0
    if ((largest <= before) && ((largest * largest) <= ($SETTLED$ * before))) { return PARACAL_OK; }
    before = largest;
#endif
  }
  return (PARACAL_STEPS == 0) ? PARACAL_SINGULAR : PARACAL_OK;
}

