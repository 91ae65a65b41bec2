#!/usr/bin/env bash
# Counts the instructions (and in one case the memory) of what users and other programs wait for, and compares them with tests/costs/costs.txt: costs.sh PRESET [all] [--write].
# A cost that is more than a tenth above its figure fails. With --write the figures are replaced; the commit states the reason.
# Instructions do not depend on how busy the machine is, so unlike times they can be tested. `all` adds those that take minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=$1
shift
which=quick write=
for word; do
  case $word in
    all) which=all ;;
    --write) write=1 ;;
    *) echo "costs: expected all or --write, got $word" >&2; exit 2 ;;
  esac
done
paracal=$PWD/build/$preset/bin/paracal fine_fits=$PWD/build/$preset/tests/fine_fits figures=$PWD/tests/costs/costs.txt
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
tools/samples.sh "$folder"
cp tests/costs/two_wrong_poses_80.csv "$folder"
cd "$folder"

# Instructions of a command, on one thread; it may end with "criteria not met".
count() {
  local code=0
  valgrind --tool=cachegrind --cache-sim=no --cachegrind-out-file=/dev/null --log-file=log "$@" >out 2>err </dev/null || code=$?
  ((code <= 1)) || { echo "costs: $* ended with $code" >&2; cat err >&2; exit 1; }
  awk '/I +refs/ { gsub(",", "", $NF); print $NF; found = 1 } END { exit !found }' log
}
paracal() { count "$paracal" "$@" --threads 1; }
# Of one unit: the difference of a command with more and with fewer of them.
unit() { echo $((($2 - $1) / $3)); }

poses() {  # N rows over the workspace of huang2016
  awk -v n="$1" 'BEGIN { print "pose,x_cmd_mm,y_cmd_mm,z_cmd_mm,phi_cmd_deg"
    for (k = 0; k < n; ++k) printf "P%d,%.3f,%.3f,%.3f,%.3f\n", k, 450 * sin(1.7 * k), 120 * cos(2.3 * k), -890 - 100 * sin(0.9 * k), 90 * cos(k) }'
}
program() {  # N lines of G-code
  awk -v n="$1" 'BEGIN { print "G21 G90\nG0 X0 Y0 Z0 C0"
    for (k = 0; k < n; ++k) printf "G1 X%.3f Y%.3f Z%.3f F2000\n", 100 * sin(0.01 * k), 100 * cos(0.01 * k), -20 - 0.01 * k }'
}
for n in 1 101; do poses $n >poses_$n.csv; program $((10 * n)) >part_$n.ngc; done
"$paracal" calibrate --measurements measured.csv --out calibration.json >/dev/null
"$paracal" inverse --robot huang2016 --poses poses_1.csv --out joints_1.csv
"$paracal" inverse --robot huang2016 --poses poses_101.csv --out joints_101.csv
gcode() { paracal export --target gcode --calibration calibration.json --origin=0,0,-888 --input "$1"; }
exact() { paracal yield --exact --robot huang2016 --machines "$1" --max-tilt-rad 0.001; }

poses 20000 >poses_20000.csv
"$paracal" simulate --robot huang2016 --poses poses_20000.csv --seed 1 --noise-mm 0.02 --out many.csv
memory() {  # kB at most of a command
  /usr/bin/python3 -c 'import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL); print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)' "$@"
}

first=$(paracal compensate --calibration calibration.json --poses poses_1.csv)
{
  echo "robot_file $(paracal robot --robot robot.toml)"
  echo "before_the_first_line $first"
  echo "compensate_a_pose $(unit "$first" "$(paracal compensate --calibration calibration.json --poses poses_101.csv)" 100)"
  echo "forward_of_a_machine $(unit "$(paracal forward --errors errors.toml --robot huang2016 --joints joints_1.csv)" "$(paracal forward --errors errors.toml --robot huang2016 --joints joints_101.csv)" 100)"
  echo "line_of_gcode $(unit "$(gcode part_1.ngc)" "$(gcode part_101.ngc)" 1000)"
  echo "calibrate $(paracal calibrate --measurements measured.csv)"
  echo "fine_fit $(unit "$(count "$fine_fits" 1)" "$(count "$fine_fits" 3)" 2)"
  echo "exact_machine $(unit "$(exact 1)" "$(exact 3)" 2)"
  echo "kB_of_20000_points $(memory "$paracal" calibrate --measurements many.csv --threads 1)"
  [[ $which == quick ]] || echo "calibrate_with_two_wrong_poses $(paracal calibrate --robot huang2016 --measurements two_wrong_poses_80.csv)"
} >found.txt

if [[ -n $write ]]; then
  {
    echo "# Instructions (kB: memory), measured by tools/costs.sh: NAME FIGURE. They fail at 1.1 times the figure. Who raises one states the reason in the commit."
    { cat found.txt; grep -v '^#' "$figures" 2>/dev/null || true; } | awk '!seen[$1]++'
  } >new.txt
  cp new.txt "$figures"
fi
awk '
  FNR == NR { if (!/^#/) figure[$1] = $2; next }
  !($1 in figure) { printf "%-32s %14.0f  no figure: run tools/costs.sh PRESET --write\n", $1, $2; failed = 1; next }
  {
    ratio = $2 / figure[$1]
    printf "%-32s %14.0f  %.3f times the figure%s\n", $1, $2, ratio, (ratio > 1.1 ? ": TOO MANY" : ratio < 0.9 ? ": fewer; store it with --write" : "")
    if (ratio > 1.1) failed = 1
  }
  END { exit failed }' "$figures" found.txt || {
  echo "costs: expected at most 1.1 times the figures of tests/costs/costs.txt; make it faster, or raise the figure and state the reason in the commit" >&2
  exit 1
}
