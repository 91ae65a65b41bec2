; Kiri:Moto
G21 ; set units to MM (required)
G90 ; absolute position mode (required)
M6 T1 ; change tool to '1'
; op: contour
G0 X-6.5 Y-6.5 Z8.1
M3 S10000
G0 X-6.5 Y-6.5 Z1
G1 Z-0.5 F250
G1 X6.5 F1000
G1 Y6.5
G1 X-6.5
G0 Z8.1
M5
M30 ; program end
