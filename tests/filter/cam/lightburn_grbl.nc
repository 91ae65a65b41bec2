; LightBurn 1.7
; GRBL-M3 device profile, absolute coords
; Bounds: X10 Y10 to X40 Y30
G00 G17 G40 G21 G54
G90
M4
; Cut @ 1200 mm/min, 60% power
M8
G0 X10Y10
; Layer C00
G1 X40S600F1200
G1 Y30
G1 X10
G1 Y10
M9
G1S0
M5
G90
; return to user-defined finish pos
G0 X0Y0
M2
