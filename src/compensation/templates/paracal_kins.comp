component paracal_kins "Kinematics of one calibrated machine, $PLATE$, written by $PROGRAM$";

description
"""
Joints that bring the identified machine to a pose, with all its errors corrected. Do not edit: export again.

robot        $ROBOT$
calibration  $CALIBRATION$
SHA-256      $SHA256$
date         $DATE$$PLAIN_REMARKS$
units        mm and deg, joints in $SHOWN_JOINT_UNIT$; base frame of the robot, z up. $TURNS$
joints       0 to $LAST_JOINT$ are those of the robot; further joints are axes that the robot does not move ($OTHER_AXES$)
method       $METHOD$
error        $WORST$

Build it with: halcompile --install paracal_kins.comp

As kinematics, in the machine's INI file: [KINS] KINEMATICS = paracal_kins, and [TRAJ] LINEAR_UNITS = mm, ANGULAR_UNITS = degree.

As a component, for tests and feed-forward: loadrt paracal_kins and addf paracal-kins.compensate, and where needed paracal-kins.rates, to a thread; pins below.

On loading it computes the poses of its self-test. It refuses to load if a joint differs by more than $JOINT_TOLERANCE$ ($JOINT_UNIT$).
""";

$PINS$pin out float joint.#[$LIMBS$] "joints to command, $SHOWN_JOINT_UNIT$; the last valid ones while status is not 0";
pin out float tilt.x "tilt_x of the plate, deg: as commanded, or what errors leave";
pin out float tilt.y "tilt_y";
pin out float tilt.z "tilt_z";
pin out float rate.##[$RATE_COUNT$] "change of the joints by the pose, in the units of both: rate of joint i by commanded coordinate k is number $FREE$ i + k";
pin out signed status "0 ok, 1 unreachable, 2 not finite, 3 singular";

option singleton yes;
option period no;
option extra_setup yes;
function compensate "from command to joint, tilt and status";
function rates "from command to rate and status";
license "GPL"; // LinuxCNC requires this of modules; this file is licensed under GPL-2.0-or-later or Apache-2.0, as you choose
;;

#include "rtapi_math.h"
#include "kinematics.h"

$C99$
#define PARACAL_DEGREES 57.295779513082320877

static const double paracal_shown_joint[PARACAL_LIMBS] = {$SHOWN_JOINTS$};
static const double paracal_shown_coordinate[PARACAL_FREE] = {$SHOWN_COORDINATES$};

FUNCTION(compensate) {
  double pose[6], plate[6], robot_joints[PARACAL_LIMBS];
  int i;
  paracal_home(pose);
$POSE_OF_PINS$  status = paracal_compensate(pose, robot_joints, plate);
  if (status != PARACAL_OK) return;
  for (i = 0; i < PARACAL_LIMBS; ++i) joint(i) = robot_joints[i] * paracal_shown_joint[i];
  tilt_x = plate[3] * PARACAL_DEGREES;
  tilt_y = plate[4] * PARACAL_DEGREES;
  tilt_z = plate[5] * PARACAL_DEGREES;
}

FUNCTION(rates) {
  double pose[6], jacobian[PARACAL_LIMBS * PARACAL_FREE];
  int i, k;
  paracal_home(pose);
$POSE_OF_PINS$  status = paracal_jacobian(pose, jacobian);
  if (status != PARACAL_OK) return;
  for (i = 0; i < PARACAL_LIMBS; ++i) {
    for (k = 0; k < PARACAL_FREE; ++k) {
      const int at = PARACAL_FREE * i + k;
      rate(at) = jacobian[at] * paracal_shown_joint[i] / paracal_shown_coordinate[k];
    }
  }
}

EXTRA_SETUP() {
  const int failed = paracal_self_test();
  (void)__comp_inst, (void)prefix, (void)extra_arg;
  if (failed) rtapi_print_msg(RTAPI_MSG_ERR, "paracal_kins: pose %d of the self-test failed\n", failed);
  return failed ? -1 : 0;
}

static void paracal_pose(const EmcPose* world, double pose[6]) {
  paracal_home(pose); /* coordinates that cannot be commanded */
$POSE_OF_WORLD$}

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_BOTH; }

/* Keeps the last valid joints if the pose has no solution. */
int kinematicsInverse(const EmcPose* world, double* joints, const KINEMATICS_INVERSE_FLAGS* iflags,
                      KINEMATICS_FORWARD_FLAGS* fflags) {
  double pose[6], robot_joints[PARACAL_LIMBS];
  int i;
  (void)iflags, (void)fflags;
  paracal_pose(world, pose);
  if (paracal_compensate(pose, robot_joints, NULL) != PARACAL_OK) return -1;
  for (i = 0; i < PARACAL_LIMBS; ++i) joints[i] = robot_joints[i] * paracal_shown_joint[i];
$OTHERS_OF_WORLD$  return 0;
}

/* Starts from the pose in `world`, or from the centre of the workspace if that fails, as before homing. */
int kinematicsForward(const double* joints, EmcPose* world, const KINEMATICS_FORWARD_FLAGS* fflags,
                      KINEMATICS_INVERSE_FLAGS* iflags) {
  double pose[6], robot_joints[PARACAL_LIMBS];
  int i;
  (void)iflags, (void)fflags;
  paracal_pose(world, pose);
  for (i = 0; i < PARACAL_LIMBS; ++i) robot_joints[i] = joints[i] / paracal_shown_joint[i];
  if (paracal_forward(robot_joints, pose) != PARACAL_OK) {
    paracal_home(pose);
    if (paracal_forward(robot_joints, pose) != PARACAL_OK) return -1;
  }
$WORLD_OF_POSE$$WORLD_OF_OTHERS$  return 0;
}

#ifdef KINS_NOT_SWITCHABLE
KINS_NOT_SWITCHABLE
#endif
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);
