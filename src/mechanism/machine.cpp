#include "paracal/mechanism/machine.hpp"

#include "paracal/mechanism/machine_impl.hpp"
#include "paracal/mechanism/robot.hpp"

namespace paracal {

template Machine build(const RobotDescription&, const SourceErrors&);

Machine build(const Robot& robot, const SourceErrors& errors) { return build(robot.description(), errors); }

}  // namespace paracal
