#!/usr/bin/python3
"""LinuxCNC's user in the tests, in place of a screen: switches the machine on, homes it twice, and, where programs are named behind --,
jogs it in world coordinates and runs them. What it saw goes to result.json, in full digits: where the joints were commanded to rest, and
LinuxCNC's messages."""

import json
import os
import sys
import time

import linuxcnc

command = linuxcnc.command()
state = linuxcnc.stat()
errors = linuxcnc.error_channel()
messages = []


def until(what, is_so, seconds=20):
    """Waits, and collects messages meanwhile."""
    end = time.monotonic() + seconds
    while True:
        state.poll()
        so = is_so()
        while (message := errors.poll()) is not None:
            messages.append(message[1].strip())
        if so:
            return
        if time.monotonic() > end:
            sys.exit(f"{what}: not within {seconds} s; {messages}")
        time.sleep(0.005)


def tell(function, *arguments):
    function(*arguments)
    command.wait_complete()


def stands():
    before = state.joint_position
    time.sleep(0.02)
    state.poll()
    return state.inpos and state.joint_position == before


def joints():
    """At rest, in the units of the INI file."""
    until("rest", stands)
    return list(state.joint_position[: state.joints])


def is_on():
    """Or is told to be: on a busy computer motion may miss a command."""
    if state.task_state != linuxcnc.STATE_ON:
        tell(command.state, linuxcnc.STATE_ESTOP_RESET)
        tell(command.state, linuxcnc.STATE_ON)
        time.sleep(0.1)
    return state.task_state == linuxcnc.STATE_ON


def homed():
    tell(command.teleop_enable, 0)  # in joint mode, as the first time
    tell(command.unhome, -1)
    until("unhoming", lambda: not any(state.homed[: state.joints]))
    tell(command.home, -1)
    until("homing", lambda: all(state.homed[: state.joints]))
    return joints()


def jogged():
    """10 mm along X, in world mode: joints, and X, Y, Z, C as jogging left them, which ends micrometres beside its target."""
    tell(command.teleop_enable, 1)
    until("world mode", lambda: state.motion_mode == linuxcnc.TRAJ_MODE_TELEOP)
    command.jog(linuxcnc.JOG_INCREMENT, 0, 0, 50, 10)
    until("jog", lambda: state.position[0] > 9)
    return {"joints": joints(), "place": [state.position[axis] for axis in (0, 1, 2, 5)]}


def carried_out(program):
    """Runs it, and goes on wherever it pauses."""
    messages.clear()
    tell(command.mode, linuxcnc.MODE_AUTO)
    tell(command.program_open, os.path.abspath(program))
    command.auto(linuxcnc.AUTO_RUN, 0)
    until("start", lambda: state.interp_state != linuxcnc.INTERP_IDLE or messages)
    rests = []
    while True:
        until("pause", lambda: state.interp_state in (linuxcnc.INTERP_PAUSED, linuxcnc.INTERP_IDLE))
        rests.append(joints())
        if state.interp_state == linuxcnc.INTERP_IDLE:
            return {"rests": rests, "messages": list(messages)}
        line = state.read_line
        command.auto(linuxcnc.AUTO_RESUME)
        until("going on", lambda: state.interp_state != linuxcnc.INTERP_PAUSED or state.read_line != line)


def main():
    programs = sys.argv[sys.argv.index("--") + 1 :]
    until("switching on", is_on)
    result = {"homed": homed(), "homed_again": homed()}
    if programs:
        result["jogged"] = jogged()
    for program in programs:
        result[program] = carried_out(program)
    with open("result.json", "w", encoding="ascii") as file:
        json.dump(result, file)


main()
