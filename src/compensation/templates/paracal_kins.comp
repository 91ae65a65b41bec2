component paracal_kins "Kinematics of one calibrated parallel robot, written by $PROGRAM$";

description
"""
Joint angles that bring the identified machine to a pose, with all its errors corrected. Do not edit: export again.

robot        $ROBOT$
calibration  $CALIBRATION$
SHA-256      $SHA256$
date         $DATE$$PLAIN_REMARKS$
units        mm and deg, joints in $SHOWN_JOINT_UNIT$; base frame of the robot: origin at the base centre, z up
joints       0 to $LAST_JOINT$ are those of the robot; further joints are axes that the robot does not move

Build it with: halcompile --install paracal_kins.comp

As kinematics, in the machine's INI file: [KINS] KINEMATICS = paracal_kins, and [TRAJ] LINEAR_UNITS = mm, ANGULAR_UNITS = degree.

As a component, for tests: loadrt paracal_kins and addf paracal-kins.compensate to a thread; pins below.

On loading it computes the poses of its self-test. It refuses to load if a joint differs by more than $JOINT_TOLERANCE$ $JOINT_UNIT$.
""";

pin in float command.x "commanded position of the plate centre, mm";
pin in float command.y;
pin in float command.z;
pin in float command.c "commanded rotation of the end-effector, deg (0 for a rigid plate)";
pin out float joint.#[$LIMBS$] "joints to command, $SHOWN_JOINT_UNIT$; the last valid ones while status is not 0";
pin out float tilt.x "tilt of the plate about x that remains, deg";
pin out float tilt.y "tilt about y that remains, deg";
pin out signed status "0 ok, 1 unreachable, 2 not finite, 3 singular";

option singleton yes;
option period no;
option extra_setup yes;
function compensate "from command to joint, tilt and status";
license "GPL"; // LinuxCNC requires this of modules; this file is licensed under GPL-2.0-or-later or Apache-2.0, as you choose
;;

#include "rtapi_math.h"
#include "kinematics.h"

$C99$
#define PARACAL_DEGREES 57.295779513082320877
#if PARACAL_ON_RAILS
#define PARACAL_SHOWN_JOINT 1.0
#else
#define PARACAL_SHOWN_JOINT PARACAL_DEGREES
#endif

FUNCTION(compensate) {
  double robot_joints[PARACAL_LIMBS], tilt_rad[2];
  int i;
  status = paracal_compensate(command_x, command_y, command_z, command_c / PARACAL_DEGREES, robot_joints, tilt_rad);
  if (status != PARACAL_OK) return;
  for (i = 0; i < PARACAL_LIMBS; ++i) joint(i) = robot_joints[i] * PARACAL_SHOWN_JOINT;
  tilt_x = tilt_rad[0] * PARACAL_DEGREES;
  tilt_y = tilt_rad[1] * PARACAL_DEGREES;
}

EXTRA_SETUP() {
  const int failed = paracal_self_test();
  (void)__comp_inst, (void)prefix, (void)extra_arg;
  if (failed) rtapi_print_msg(RTAPI_MSG_ERR, "paracal_kins: pose %d of the self-test failed\n", failed);
  return failed ? -1 : 0;
}

/* Axes of the controller that the robot does not move, in the order of their joints. */
static double* paracal_other_axis(EmcPose* pose, int number) {
#if PARACAL_LIMBS == 4
  double* const axes[] = {&pose->a, &pose->b, &pose->u, &pose->v, &pose->w};
#else
  double* const axes[] = {&pose->a, &pose->b, &pose->c, &pose->u, &pose->v, &pose->w};
#endif
  return number < (int)(sizeof axes / sizeof axes[0]) ? axes[number] : 0;
}

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_BOTH; }

/* Keeps the last valid joints if the pose has no solution. */
int kinematicsInverse(const EmcPose* world, double* joints, const KINEMATICS_INVERSE_FLAGS* iflags,
                      KINEMATICS_FORWARD_FLAGS* fflags) {
  const double phi_rad = PARACAL_LIMBS == 4 ? world->c / PARACAL_DEGREES : 0.0;
  double robot_joints[PARACAL_LIMBS];
  EmcPose others = *world;
  double* axis;
  int i;
  (void)iflags, (void)fflags;
  if (paracal_compensate(world->tran.x, world->tran.y, world->tran.z, phi_rad, robot_joints, NULL) != PARACAL_OK) return -1;
  for (i = 0; i < PARACAL_LIMBS; ++i) joints[i] = robot_joints[i] * PARACAL_SHOWN_JOINT;
  for (i = 0; (axis = paracal_other_axis(&others, i)) != 0; ++i) joints[PARACAL_LIMBS + i] = *axis;
  return 0;
}

int kinematicsForward(const double* joints, EmcPose* world, const KINEMATICS_FORWARD_FLAGS* fflags,
                      KINEMATICS_INVERSE_FLAGS* iflags) {
  double robot_joints[PARACAL_LIMBS], pose[4];
  double* axis;
  int i;
  (void)iflags, (void)fflags;
  for (i = 0; i < PARACAL_LIMBS; ++i) robot_joints[i] = joints[i] / PARACAL_SHOWN_JOINT;
  pose[0] = world->tran.x;
  pose[1] = world->tran.y;
  pose[2] = world->tran.z;
  pose[3] = PARACAL_LIMBS == 4 ? world->c / PARACAL_DEGREES : 0.0;
  if (paracal_forward(robot_joints, pose) != PARACAL_OK) return -1;
  world->tran.x = pose[0];
  world->tran.y = pose[1];
  world->tran.z = pose[2];
  if (PARACAL_LIMBS == 4) world->c = pose[3] * PARACAL_DEGREES;
  for (i = 0; (axis = paracal_other_axis(world, i)) != 0; ++i) *axis = joints[PARACAL_LIMBS + i];
  return 0;
}

#ifdef KINS_NOT_SWITCHABLE
KINS_NOT_SWITCHABLE
#endif
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);
