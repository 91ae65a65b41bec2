#!/usr/bin/env bash
# Counts the instructions of one call of an exported C header on a Cortex-M4F and a Cortex-M7, and compares the joints with the program's: cortex.sh [PRESET]. It needs
# the packages of the group `cortex` (tools/setup.sh cortex). The processors are qemu's, which counts instructions, not cycles: the same on each machine.
set -euo pipefail
cd "$(dirname "$0")/.."

# board of qemu, processor, floating-point unit, calibration, most instructions of a call (mean of the poses), largest error of the joints (rad), options of the export
readonly kLimits='mps2-an500 cortex-m7 fpv5-d16 even 7000 1e-12
mps2-an500 cortex-m7 fpv5-d16 uneven 12000 1e-12
mps2-an386 cortex-m4 fpv4-sp-d16 even 40000 1e-6 --variant float
mps2-an386 cortex-m4 fpv4-sp-d16 uneven 50000 1e-6 --variant float'

export LC_ALL=C
program=$PWD/build/${1:-ci}/bin/paracal main=$PWD/tests/cortex/main.c measured=$PWD/samples/measured.csv
for needed in "$program" arm-none-eabi-gcc qemu-system-arm; do command -v "$needed" >/dev/null || { echo "cortex: expected $needed, got none" >&2; exit 1; }; done
mkdir -p build/cortex
cd build/cortex
"$program" calibrate --measurements "$measured" --stage fine --out even.json >/dev/null  # no error is zero, so the header has every term
# Poses that fill the workspace, the first of them home: 100 that are compared, of which 60 are measured with uneven drives.
awk 'function part(step) { return n * step % 1 }  # of a range, evenly spread over the poses
  BEGIN {
    print "x_mm,y_mm,z_mm,phi_deg\n0,0,-888,0"
    while (++n < 100) {
      r = 500 * sqrt(part(0.856675)); angle = 6.283185 * part(0.733892)
      printf "%.3f,%.3f,%.3f,%.3f\n", r * cos(angle), r * sin(angle), -763 - 250 * part(0.628707), 360 * part(0.538597) - 180
    }
  }' >poses.csv
head -n 61 poses.csv >visited.csv
"$program" inverse --robot huang2016 --poses visited.csv | sed '/^#/d' |
  awk -F , -v OFS=, 'NR > 1 { for (i = 2; i <= 5; ++i) $i += 0.02 * sin($i / 8 + i) } { print }' >uneven.csv
"$program" forward --robot huang2016 --joints uneven.csv | sed '/^#/d' | paste -d , visited.csv - | awk -F , -v OFS=, '
  function noise(sum, i) { for (i = 0; i < 12; ++i) sum += rand(); return 0.01 * (sum - 6) }
  BEGIN { srand(1); print "# robot: huang2016\npose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg,x_mm,y_mm,z_mm,repeat" }
  NR > 1 { for (visit = 1; visit <= 2; ++visit) print "P" NR - 2, $1, $2, $3, $4, $6 + noise(), $7 + noise(), $8 + noise(), visit }' >measured.csv
"$program" calibrate --measurements measured.csv --out uneven.json >/dev/null
grep -q '"uses_drives": true' uneven.json || { echo "cortex: expected a calibration that uses its drives" >&2; exit 1; }

# cases NAME: the poses and their joints by a calibration, as the program has them.
cases() {
  "$program" compensate --robot huang2016 --calibration "$1.json" --poses poses.csv --out joints.csv
  sed '/^#/d' joints.csv | paste -d , poses.csv - | awk -F , 'NR > 1 {
    deg = atan2(0, -1) / 180
    printf "{{%s, %s, %s, 0.0, 0.0, %.17g}, {%.17g, %.17g, %.17g, %.17g}},\n", $1, $2, $3, $4 * deg, $6 * deg, $7 * deg, $8 * deg, $9 * deg
  }' >cases.h
}

failed=0
while read -r board processor unit machine most error options; do
  cases "$machine"
  # shellcheck disable=SC2086  # the options
  "$program" export --robot huang2016 --calibration "$machine.json" --target c99 $options --out compensator.h >/dev/null
  # -fbuiltin: a square root may be one instruction, as in a program with math.h. The vectors stand where the processor looks for them, below newlib's program.
  arm-none-eabi-gcc "-mcpu=$processor" "-mfpu=$unit" -mfloat-abi=hard -O2 -std=c99 -ffreestanding -fbuiltin -Wall -Wextra -Wconversion -Wdouble-promotion -Werror \
    -I. "$main" --specs=rdimon.specs -Wl,--section-start=.vectors=0 -lm -o program.elf
  # Its exit code says nothing: the processor has no operating system.
  said=$(timeout 300 qemu-system-arm -M "$board" -icount shift=0 -display none -serial none -monitor none -semihosting-config enable=on,target=native \
    -kernel program.elf </dev/null || true)
  name="$processor, $machine, ${options:-exact}"
  if awk -v most="$most" -v error="$error" '{ good = $2 == "instructions" && $1 <= most + 0 && $10 <= error + 0 } END { exit !good }' <<<"$said"; then
    echo "$name: $said"
  else
    echo "cortex: $name: expected at most $most instructions a call and $error rad, got ${said:-nothing}" >&2
    failed=1
  fi
done <<<"$kLimits"
exit "$failed"
