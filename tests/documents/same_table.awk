# Whether two tables say the same, numbers to 1e-6: awk -f same_table.awk ONE OTHER
BEGIN { FS = "[ ,]" }
function number(text) { return text ~ /^-?[0-9.]+(e[-+]?[0-9]+)?$/ }
function differ(one, other) {
  if (!number(one) || !number(other)) return one != other
  return (one - other) ^ 2 > 1e-12 * (1 + one ^ 2)
}
NR == FNR { lines[FNR] = $0; count = FNR; next }
{
  fields = split(lines[FNR], expected)
  other = fields != NF
  for (k = 1; k <= NF && !other; ++k) other = differ(expected[k], $k)
  if (other) { print FILENAME ":" FNR ": expected " lines[FNR] ", got " $0; failed = 1; exit }
}
END {
  if (!failed && FNR != count) { print FILENAME ": expected " count " lines, got " FNR; failed = 1 }
  exit failed
}
