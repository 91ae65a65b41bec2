(Exported by FreeCAD)
(Post Processor: grbl_post)
(Begin preamble)
G17 G90
G21
(Begin operation: Fixture)
(Path: Fixture)
G54
(End operation: Fixture)
(Begin toolchange)
( M6 T1 )
M3 S5000
(End toolchange)
(Begin operation: Engrave)
G0 Z5.000
G0 X3.500 Y-12.250
G0 Z3.000
G1 X3.500 Y-12.250 Z-0.500 F60.000
G1 X18.000 Y-12.250 Z-0.500 F300.000
G3 X18.000 Y-2.250 Z-0.500 I0.000 J5.000 K0.000 F300.000
G0 Z5.000
(Begin postamble)
M5
G17 G90
M2
