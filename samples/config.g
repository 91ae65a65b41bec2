; A delta printer with RepRapFirmware, as it was designed: the machine of printer.cfg
M665 L215.0 R97.5 B75 H330.0 ; rods, radius, print radius, homed height
M666 X0 Y0 Z0                ; endstops
