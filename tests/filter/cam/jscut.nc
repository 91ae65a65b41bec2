G21         ; Set units to mm
G90         ; Absolute positioning
G1 Z2.54 F1000      ; Move to clearance level

;
; Operation:    0
; Name:
; Type:         Outside

; Path 0
; Rapid to initial position
G1 X-8.0000 Y-8.0000 F2500
G1 Z0.0000
; plunge
G1 Z-1.5000 F127
; cut
G1 X8.0000 Y-8.0000 F1016
G1 X8.0000 Y8.0000
G1 X-8.0000 Y8.0000
G1 X-8.0000 Y-8.0000
; Retract
G1 Z2.54 F1000
M2
