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

Build it with: halcompile --install paracal_kins.comp

As kinematics, in the machine's INI file: [KINS] KINEMATICS = paracal_kins, and [TRAJ] LINEAR_UNITS = mm, ANGULAR_UNITS = degree.

As a component, for tests: loadrt paracal_kins and addf paracal-kins.compensate to a thread; pins below.

On loading it computes the poses of its self-test. It refuses to load if a joint differs by more than $JOINT_TOLERANCE$ $JOINT_UNIT$.
""";

$PINS$pin out float joint.#[$LIMBS$] "joints to command, $SHOWN_JOINT_UNIT$; the last valid ones while status is not 0";
pin out signed status "0 ok, 1 unreachable, 2 not finite";

option singleton yes;
option period no;
option extra_setup yes;
function compensate "from command to joint and status";
license "GPL"; // LinuxCNC requires this of modules; this file is licensed under GPL-2.0-or-later or Apache-2.0, as you choose
;;

#include "rtapi_math.h"
#include "kinematics.h"

$C99$
#define PARACAL_DEGREES 57.295779513082320877
#define PARACAL_SHOWN_JOINT $SHOWN_JOINT$

FUNCTION(compensate) {
  double pose[6];
  double robot_joints[PARACAL_LIMBS];
  int i;
  paracal_home(pose);
$POSE_OF_PINS$  status = paracal_compensate(pose, robot_joints);
  if (status != PARACAL_OK) return;
  for (i = 0; i < PARACAL_LIMBS; ++i) joint(i) = robot_joints[i] * PARACAL_SHOWN_JOINT;
}

EXTRA_SETUP() {
  const int failed = paracal_self_test();
  (void)__comp_inst, (void)prefix, (void)extra_arg;
  if (failed) rtapi_print_msg(RTAPI_MSG_ERR, "paracal_kins: pose %d of the self-test failed\n", failed);
  return failed ? -1 : 0;
}

static void paracal_pose(const EmcPose* world, double pose[6]) {
  paracal_home(pose); /* coordinates that the guides fix */
$POSE_OF_WORLD$}

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_BOTH; }

/* Keeps the last valid joints if the pose has no solution. */
int kinematicsInverse(const EmcPose* world, double* joints, const KINEMATICS_INVERSE_FLAGS* iflags,
                      KINEMATICS_FORWARD_FLAGS* fflags) {
  double pose[6], robot_joints[PARACAL_LIMBS];
  int i;
  (void)iflags, (void)fflags;
  paracal_pose(world, pose);
  if (paracal_compensate(pose, robot_joints) != PARACAL_OK) return -1;
  for (i = 0; i < PARACAL_LIMBS; ++i) joints[i] = robot_joints[i] * PARACAL_SHOWN_JOINT;
$OTHERS_OF_WORLD$  return 0;
}

/* Starts from the pose in `world`, or from the centre of the workspace if that fails, as before homing. */
int kinematicsForward(const double* joints, EmcPose* world, const KINEMATICS_FORWARD_FLAGS* fflags,
                      KINEMATICS_INVERSE_FLAGS* iflags) {
  double pose[6], robot_joints[PARACAL_LIMBS];
  int i;
  (void)iflags, (void)fflags;
  paracal_pose(world, pose);
  for (i = 0; i < PARACAL_LIMBS; ++i) robot_joints[i] = joints[i] / PARACAL_SHOWN_JOINT;
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
