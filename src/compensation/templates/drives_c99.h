/* Uneven drives: a joint that is commanded to q is at r + t(r), where r = q + s(q), with
 *
 *   s(q) = sum over k of size[k] B((q - first) / spacing - k),   t(r) = sine sin(turning r) + cosine cos(turning r)
 *
 * and the cubic spline B. Each joint has first, spacing, PARACAL_KNOTS sizes, turning, sine and cosine among the
 * numbers. */
#define PARACAL_KNOTS $KNOTS$
#define PARACAL_TURN (PARACAL_KNOTS + 2)
#define PARACAL_DRIVE (PARACAL_KNOTS + 5)
#define PARACAL_DRIVES $DRIVES_AT$ /* place of the first drive among the numbers */

static inline $REAL$ paracal_bump($REAL$ x) {
  const $REAL$ away = (x < $ZERO$) ? -x : x;
  const $REAL$ rest = $TWO$ - away;
  return (away < $ONE$) ? (($TWO$ / $THREE$) - ((away * away) * ($ONE$ - ($HALF$ * away)))) : (((rest * rest) * rest) / $SIX$);
}

/* dB/dx */
static inline $REAL$ paracal_bump_slope($REAL$ x) {
  const $REAL$ away = (x < $ZERO$) ? -x : x;
  const $REAL$ rest = $TWO$ - away;
  const $REAL$ slope = (away < $ONE$) ? (away * (($THREE$ * $HALF$ * away) - $TWO$)) : (-$HALF$ * (rest * rest));
  return (x < $ZERO$) ? -slope : slope;
}

/* Sum of the splines, or of their derivatives, x spacings behind the first. */
static inline $REAL$ paracal_bumps(const double drive[PARACAL_DRIVE], $REAL$ place, int are_slopes) {
  $REAL$ x = place;
  $REAL$ sum = $ZERO$;
  int k;
  for (k = 0; k < PARACAL_KNOTS; ++k) {
    if ((x > -$TWO$) && (x < $TWO$)) {
      sum += $NARROWED$drive[k + 2] * ((are_slopes != 0) ? paracal_bump_slope(x) : paracal_bump(x));
    }
    x -= $ONE$;
  }
  return sum;
}

/* From where the plate needs a joint to r: r = needed - t(r), again and again, as below. */
static inline double paracal_unturned(const double turn[3], double needed) {
  double joint = needed;
  $REAL$ change = $ONE$;
  int count;
  if (turn[0] < 1e-12) { return needed; }
  for (count = 0; (count < $MOST_DRIVE_STEPS$) && ((change > $NOTHING$) || (change < -$NOTHING$)); ++count) {
    const $REAL$ angle = $NARROWED$(turn[0] * joint);
    const double next = needed - $WIDENED$(($NARROWED$turn[1] * $SINE$(angle)) + ($NARROWED$turn[2] * $COSINE$(angle)));
    change = $NARROWED$(next - joint);
    joint = next;
  }
  return joint;
}

/* From joints where the plate needs them to those that are commanded so that drives get there: q = r - s(q), again and
 * again. Each of at most $MOST_DRIVE_STEPS$ steps leaves less than $STEEPEST$ of the error, usually a hundredth. */
static inline void paracal_command(const double p[PARACAL_NUMBERS], double joints[PARACAL_LIMBS]) {
  int i;
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    const double* const drive = &p[PARACAL_DRIVES + (PARACAL_DRIVE * i)];
    const double turned = paracal_unturned(&drive[PARACAL_TURN], joints[i]);
    const $REAL$ spacing = $NARROWED$drive[1];
    const $REAL$ place = $NARROWED$(turned - drive[0]) / spacing;
    $REAL$ off = $ZERO$;
    $REAL$ change = $ONE$;
    int count;
    for (count = 0; (count < $MOST_DRIVE_STEPS$) && ((change > $NOTHING$) || (change < -$NOTHING$)); ++count) {
      const $REAL$ next = paracal_bumps(drive, place - (off / spacing), 0);
      change = next - off;
      off = next;
    }
    joints[i] = turned - $WIDENED$off;
  }
}

/* d commanded joints / d pose, from d needed joints / d pose. */
static inline void paracal_command_rates(const double p[PARACAL_NUMBERS], const double joints[PARACAL_LIMBS],
                                         double rates[PARACAL_LIMBS * PARACAL_FREE]) {
  int i;
  int k;
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    const double* const drive = &p[PARACAL_DRIVES + (PARACAL_DRIVE * i)];
    const $REAL$ place = $NARROWED$((joints[i] - drive[0]) / drive[1]);
    const double* const turn = &drive[PARACAL_TURN];
    const $REAL$ angle = $NARROWED$(turn[0] * (joints[i] + $WIDENED$paracal_bumps(drive, place, 0)));
    const double turned = turn[0] * $WIDENED$(($NARROWED$turn[1] * $COSINE$(angle)) - ($NARROWED$turn[2] * $SINE$(angle)));
    const double way = (1.0 + ($WIDENED$paracal_bumps(drive, place, 1) / drive[1])) * (1.0 + turned);
    for (k = 0; k < PARACAL_FREE; ++k) { rates[(PARACAL_FREE * i) + k] = rates[(PARACAL_FREE * i) + k] / way; }
  }
}

