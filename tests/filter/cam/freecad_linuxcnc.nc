(Exported by FreeCAD)
(Post Processor: linuxcnc_post)
(begin preamble)
G17 G54 G40 G49 G80 G90
G21
(begin operation: T1: Endmill)
(machine units: mm/min)
(TC: T1: Endmill)
M5
M6 T1
G43 H1
M3 S7000
(finish operation: T1: Endmill)
(begin operation: Profile)
(Compensated Tool Path: 3.0)
G0 Z15.000
G0 X-20.000 Y-20.000
G0 Z5.000
G1 X-20.000 Y-20.000 Z-1.000 F120.000
G1 X-20.000 Y20.000 Z-1.000 F600.000
G2 X-17.000 Y23.000 Z-1.000 I3.000 J0.000 K0.000 F600.000
G1 X17.000 Y23.000 Z-1.000
G0 Z15.000
(finish operation: Profile)
(begin postamble)
M05
G17 G54 G90 G80 G40
M2
