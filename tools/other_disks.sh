#!/usr/bin/env bash
# Tests file handling on disks that cannot exchange two files in one step: exFAT, NTFS, and a folder with fixed permissions and owners. It mounts an image of each
# and injects faults there (tests/cli/fault_injection_test.cpp): other_disks.sh [PRESET].
set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-ci}
work=$(mktemp -d)
mounted=() device=''
finish() {
  for place in "${mounted[@]}"; do umount "$place" 2>/dev/null || fusermount -u "$place" 2>/dev/null || fusermount3 -u "$place"; done
  [[ -z $device ]] || losetup -d "$device"
  rm -rf "$work"
}
trap finish EXIT

exfat() {
  truncate -s 64M "$work/exfat.img" && mkfs.exfat "$work/exfat.img" && device=$(losetup -f --show "$work/exfat.img") && mount.exfat-fuse "$device" "$1"
}
ntfs() { truncate -s 64M "$work/ntfs.img" && mkntfs -F -q "$work/ntfs.img" && ntfs-3g "$work/ntfs.img" "$1"; }
bound() { mkdir "$work/under" && bindfs --chmod-deny --chown-deny --chgrp-deny "$work/under" "$1"; }

failed=0
for disk in exfat ntfs bound; do
  mkdir "$work/$disk"
  if ! "$disk" "$work/$disk" >"$work/$disk.log" 2>&1; then
    echo "other_disks: not tested: this machine cannot mount $disk: $(tail -n 1 "$work/$disk.log")"
    continue
  fi
  mounted+=("$work/$disk")
  echo "$disk:"
  # These disks have no named pipes, modes or mounts inside.
  TMPDIR=$work/$disk "build/$preset/tests/cli/paracal-cli-tests" --gtest_brief=1 \
    --gtest_filter='*Injection*:PrinterCommand.*:-*StandardOutputsThatFail*:*FullDisks*:*EveryByte*:*MayIncludeOthers*' || failed=1
done
exit "$failed"
